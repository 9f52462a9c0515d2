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
  bool is_background = false;  // grey and behind: what the others are compared with
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

/// Curves of many points are thinned to what the panel's width can show, extremes kept.
[[nodiscard]] std::string to_svg(const LineFigure& figure);

}  // namespace hybridtest::plot
