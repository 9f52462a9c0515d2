#include "recording/summary/test_rows.hpp"

#include "recording/read_rows.hpp"
#include "recording/summary/columns.hpp"

namespace hybridtest {
namespace {

constexpr std::string_view kTable = "control";
constexpr std::string_view kModelTime = "model_time_s";

/// Model times are sums of control periods: a row this share of a period before the end is at the end.
constexpr double kSameTime = 0.25;

}  // namespace

TestRows::TestRows(const RunFileReader& file) : file_{file} {
  const auto end_s = value_in_last_row(file, "steps", kModelTime);
  const auto position = column_position(file, kTable, kModelTime);
  if (!end_s || !position || file.row_count(kTable) == 0) return;
  std::size_t row_number = 0;
  std::optional<double> begin_s;
  bool moves = false;
  read_rows(file, kTable, [&](std::span<const double> row) {
    if (!begin_s) begin_s = row[*position];
    moves = row[*position] > *begin_s;
    row_number += moves ? 0 : 1;
    return !moves;
  });
  if (!moves) return;
  time_ = position;
  first_ = row_number - 1;
  end_s_ = *end_s;
}

void TestRows::read(const std::function<void(std::span<const double> row)>& visit) const {
  std::optional<double> before_s;
  read_rows(
      file_, kTable,
      [&](std::span<const double> row) {
        visit(row);
        if (!time_) return true;
        const double time_s = row[*time_];
        const bool is_last = before_s && time_s >= end_s_ - kSameTime * (time_s - *before_s);
        before_s = time_s;
        return !is_last;
      },
      first_);
}

}  // namespace hybridtest
