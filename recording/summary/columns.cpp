#include "recording/summary/columns.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstddef>

namespace hybridtest {
namespace {

bool is_number(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// `_2`
bool is_numbered(std::string_view text) { return text.starts_with('_') && is_number(text.substr(1)); }

std::string dof_name(const RunFileHeader& header, std::string_view suffix) {
  if (!suffix.empty() && !is_number(suffix.substr(1))) return std::string{suffix.substr(1)};
  std::size_t position = 1;
  if (!suffix.empty()) (void)std::from_chars(suffix.data() + 1, suffix.data() + suffix.size(), position);
  if (position >= 1 && position <= header.interface_dofs.size()) return header.interface_dofs[position - 1];
  return "dof_" + std::to_string(position);
}

std::optional<double> value_in_row(const RunFileReader& file, std::string_view table, std::string_view column,
                                   std::size_t row) {
  const auto position = column_position(file, table, column);
  if (!position || row >= file.row_count(table)) return {};
  return file.rows(table, row, 1)[*position];
}

}  // namespace

std::optional<std::size_t> column_position(const RunFileReader& file, std::string_view table, std::string_view column) {
  const auto layout = std::ranges::find(file.tables(), table, &TableLayout::name);
  return layout == file.tables().end() ? std::nullopt : layout->position(column);
}

std::optional<double> value_in_first_row(const RunFileReader& file, std::string_view table, std::string_view column) {
  return value_in_row(file, table, column, 0);
}

std::optional<double> value_in_last_row(const RunFileReader& file, std::string_view table, std::string_view column) {
  const std::size_t rows = file.row_count(table);
  return rows == 0 ? std::nullopt : value_in_row(file, table, column, rows - 1);
}

std::vector<DofColumn> dof_columns(const RunFileReader& file, std::string_view table, std::string_view quantity,
                                   std::string_view unit) {
  std::vector<DofColumn> found;
  const std::string ending = "_" + std::string{unit};
  for (const TableLayout& layout : file.tables()) {
    if (layout.name != table) continue;
    for (const Column& column : layout.columns) {
      const std::string_view name = column.name;
      if (!name.starts_with(quantity)) continue;
      const std::string_view rest = name.substr(quantity.size());
      std::string_view suffix;
      if (rest.starts_with(ending) && is_numbered(rest.substr(ending.size()))) {
        suffix = rest.substr(ending.size());
      } else if (rest.ends_with(ending)) {
        suffix = rest.substr(0, rest.size() - ending.size());
      } else {
        continue;
      }
      if (!suffix.empty() && (suffix.front() != '_' || suffix.size() < 2)) continue;
      found.push_back({dof_name(file.header(), suffix), std::string{rest}, column.name});
    }
  }
  return found;
}

}  // namespace hybridtest
