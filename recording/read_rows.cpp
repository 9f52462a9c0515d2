#include "recording/read_rows.hpp"

#include <algorithm>

namespace hybridtest {
namespace {

/// An hour at 1 kHz is read in pieces of a few seconds.
constexpr std::size_t kRowsInMemory = 8192;

}  // namespace

RowCursor::RowCursor(const RunFileReader& file, std::string_view table, std::size_t first)
    : file_{file}, table_{table}, first_{first} {
  const auto layout = std::ranges::find(file.tables(), table, &TableLayout::name);
  if (layout == file.tables().end()) return;
  width_ = layout->columns.size();
  count_ = file.row_count(table);
}

std::span<const double> RowCursor::next() {
  while (at_ + width_ > block_.size() || block_.empty()) {
    if (first_ >= count_) return {};
    block_ = file_.rows(table_, first_, kRowsInMemory);
    first_ += kRowsInMemory;
    at_ = 0;
  }
  const std::span row = std::span{block_}.subspan(at_, width_);
  at_ += width_;
  return row;
}

void read_rows(const RunFileReader& file, std::string_view table,
               const std::function<bool(std::span<const double> row)>& visit, std::size_t first) {
  RowCursor rows{file, table, first};
  for (auto row = rows.next(); !row.empty(); row = rows.next()) {
    if (!visit(row)) return;
  }
}

}  // namespace hybridtest
