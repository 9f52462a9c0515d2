#include "recording/summary/test_rows.hpp"

#include <algorithm>
#include <iterator>

namespace hybridtest {
namespace {

constexpr std::string_view kTable = "control";
constexpr std::string_view kModelTime = "model_time_s";

/// Model times are sums of control periods: a row this share of a period before the end is at the end.
constexpr double kSameTime = 0.25;

/// Of the first row that is at the last step or beyond it; the size when there is none.
std::size_t last_row(const std::vector<double>& model_time_s, std::size_t first, double end_s) {
  for (std::size_t i = first + 1; i < model_time_s.size(); ++i) {
    if (model_time_s[i] >= end_s - kSameTime * (model_time_s[i] - model_time_s[i - 1])) return i;
  }
  return model_time_s.size();
}

}  // namespace

TestRows::TestRows(const RunFileReader& file) : file_{file}, end_{file.row_count(kTable)} {
  if (end_ == 0 || !file.has_column(kTable, kModelTime) || !file.has_column("steps", kModelTime)) return;
  const std::vector<double> model_time_s = file.column(kTable, kModelTime);
  const std::vector<double> steps_s = file.column("steps", kModelTime);
  if (steps_s.empty()) return;
  const auto moves = std::ranges::find_if(model_time_s, [&](double time_s) { return time_s > model_time_s.front(); });
  if (moves == model_time_s.end()) return;
  first_ = static_cast<std::size_t>(std::distance(model_time_s.begin(), moves)) - 1;
  end_ = std::min(last_row(model_time_s, first_, steps_s.back()) + 1, end_);
}

std::vector<double> TestRows::column(std::string_view name) const {
  if (!file_.has_column(kTable, name)) return {};
  const std::vector<double> all = file_.column(kTable, name);
  const auto at = [&](std::size_t row) { return all.begin() + static_cast<std::ptrdiff_t>(std::min(row, all.size())); };
  return {at(first_), at(end_)};
}

}  // namespace hybridtest
