#pragma once

#include <string>
#include <vector>

#include "report/plotting/axis.hpp"

namespace hybridtest::plot {

/// One row of a dot figure: a label and a value for each of the figure's marks.
struct DotRow {
  std::string label;
  std::vector<double> values;  // one per mark; not finite: no dot
  std::string note;            // at the right end
  bool is_emphasised = false;
};

/// Values of many items side by side, one row for each.
struct DotFigure {
  std::string title;
  Axis axis;
  std::vector<std::string> marks;  // names in the legend, at most six
  std::vector<DotRow> rows;
  double width = 900.0;  // [px]
};

[[nodiscard]] std::string to_svg(const DotFigure& figure);

}  // namespace hybridtest::plot
