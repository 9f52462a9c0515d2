#include "recording/read_rows.hpp"

#include <algorithm>
#include <vector>

namespace hybridtest {

void read_rows(const RunFileReader& file, std::string_view table,
               const std::function<bool(std::span<const double> row)>& visit, std::size_t first) {
  const auto layout = std::ranges::find(file.tables(), table, &TableLayout::name);
  if (layout == file.tables().end()) return;
  const std::size_t width = layout->columns.size();
  const std::size_t count = file.row_count(table);
  for (; first < count; first += kRowsInMemory) {
    const std::vector<double> block = file.rows(table, first, kRowsInMemory);
    for (std::size_t at = 0; at + width <= block.size(); at += width) {
      if (!visit(std::span{block}.subspan(at, width))) return;
    }
  }
}

}  // namespace hybridtest
