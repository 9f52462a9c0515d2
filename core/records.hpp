#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hybridtest {

/// One column of a recorded table. Names follow quantity_qualifier_unit, for example
/// `displacement_floor_1_m`; the unit is repeated for readers that show it.
struct Column {
  std::string name;
  std::string unit;
  bool operator==(const Column&) const = default;
};

/// A recorded table: every value a double, one row per step or control period.
struct TableLayout {
  std::string name;
  std::vector<Column> columns;
  bool operator==(const TableLayout&) const = default;

  /// Of the column with this name; nothing without one.
  [[nodiscard]] std::optional<std::size_t> position(std::string_view column) const noexcept {
    const auto found = std::ranges::find(columns, column, &Column::name);
    if (found == columns.end()) return {};
    return static_cast<std::size_t>(found - columns.begin());
  }
};

/// Behind the name of a column that occurs `count` times: `_1`, `_2` ...; nothing where it occurs once.
/// @param number   from 1.
[[nodiscard]] inline std::string column_suffix(int number, int count) {
  return count == 1 ? "" : "_" + std::to_string(number);
}

/// Where a Node appends the rows of one table. Never blocks, never allocates: rows that cannot
/// be kept are counted by the sink and fail the verdict of the run.
class RowSink {
 public:
  virtual ~RowSink() = default;

  /// @param row   one value per column of the sink's layout.
  virtual void append(std::span<const double> row) noexcept = 0;
};

/// For nodes without a recorder.
class NoRecord final : public RowSink {
 public:
  void append(std::span<const double>) noexcept override {}
};

}  // namespace hybridtest
