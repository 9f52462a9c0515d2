#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "coordinator/excitation/motion_text.hpp"

/// Columns of numbers in a text, below an optional line of names; shared by the readers of histories.
namespace hybridtest::motion_text {

/// Rows of numbers with the lines they are on.
struct Rows {
  std::size_t columns = 0;
  std::vector<double> values;  // row by row
  std::vector<int> lines;
  std::vector<std::string> names;  // of the columns; empty without a header line
  int names_line = 0;

  [[nodiscard]] double value(std::size_t row, std::size_t column) const { return values[row * columns + column]; }
};

/// @param columns_max   most columns. @param expected   which they are, for messages: "one (acceleration) or two (…)".
/// @throws ConfigError with the line for what is no number, another number of columns than before, or no row.
[[nodiscard]] Rows read_rows(const std::vector<Line>& lines, const std::string& name, std::size_t columns_max,
                             std::string_view expected);

/// @throws ConfigError when the first of the names does not stand for the time.
void check_time_name(const Rows& rows, const std::string& name);
/// @return the spacing of the times in the first column, from first and last so that rounded prints average out.
/// @throws ConfigError for one row, and for times that are not equally spaced within one percent.
[[nodiscard]] double even_spacing(const Rows& rows, const std::string& name);
/// @return the first time; 0 when it is 0 up to rounding. @throws ConfigError for a negative one.
[[nodiscard]] double start_of(const Rows& rows, double dt_s, const std::string& name);

}  // namespace hybridtest::motion_text
