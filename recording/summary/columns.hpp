#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "recording/run_file_reader.hpp"

namespace hybridtest {

/// A column of a quantity that occurs once per degree of freedom.
struct DofColumn {
  std::string dof;  // its name; `dof_1` … if the file has no name
  std::string
      rest;  // of the column's name behind the quantity, the same for its other quantities: "_m", "_m_2", "_floor_1_m"
  std::string name;  // the column's name
};

/// Columns `<quantity>_<unit>`, `<quantity>_<suffix>_<unit>` and, as sites with several degrees of freedom record,
/// `<quantity>_<unit>_<number>` of a table, in order. A suffix that is a number, or missing, is the position of a
/// degree of freedom in the header's `interface_dofs`.
[[nodiscard]] std::vector<DofColumn> dof_columns(const RunFileReader& file, std::string_view table,
                                                 std::string_view quantity, std::string_view unit);

/// Of a column in the rows of its table; nothing when there is no such column.
[[nodiscard]] std::optional<std::size_t> column_position(const RunFileReader& file, std::string_view table,
                                                         std::string_view column);

/// Nothing when there is no such column or no row.
[[nodiscard]] std::optional<double> value_in_first_row(const RunFileReader& file, std::string_view table,
                                                       std::string_view column);
[[nodiscard]] std::optional<double> value_in_last_row(const RunFileReader& file, std::string_view table,
                                                      std::string_view column);

}  // namespace hybridtest
