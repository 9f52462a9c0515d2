#pragma once

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

}  // namespace hybridtest
