#pragma once

#include <span>
#include <string>
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
};

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
