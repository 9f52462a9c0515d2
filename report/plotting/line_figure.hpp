#pragma once

#include <string>
#include <vector>

#include "report/plotting/axis.hpp"

namespace hybridtest::plot {

/// One curve. Points that are not finite leave a gap.
struct Line {
  std::string name;  // in the legend; the same name has the same colour in every panel
  std::vector<double> x{};
  std::vector<double> y{};
  bool is_background = false;  // grey, behind the others: the reference
  bool is_emphasised = false;  // thicker
};

struct Panel {
  std::string title;
  Axis x;
  Axis y;
  std::vector<Line> lines;
};

/// Panels in columns with one legend.
struct LineFigure {
  std::vector<Panel> panels;
  int columns = 1;
  double panel_width = 620.0;  // [px] with its labels
  double panel_height = 260.0;
};

/// Curves with many points are thinned to the width of the panel; extreme values are kept.
[[nodiscard]] std::string to_svg(const LineFigure& figure);

}  // namespace hybridtest::plot
