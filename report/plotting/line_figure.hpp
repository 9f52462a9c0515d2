#pragma once

#include <string>
#include <vector>

#include "report/plotting/axis.hpp"
#include "report/plotting/colours.hpp"

namespace hybridtest::plot {

/// One curve. Points that are not finite leave a gap.
struct Line {
  std::string name;  // in the legend; the same name has the same colour in every panel
  std::vector<double> x{};
  std::vector<double> y{};
  bool is_background = false;  // thick and behind the others, grey if it is no signal: the reference
  bool is_emphasised = false;  // thicker
  Signal signal = Signal::other;
  bool is_dashed = false;  // of two curves of the same signal, the second
};

/// What happened at a value of the horizontal axis.
struct Mark {
  double x = 0.0;
  std::string text;
  bool is_fault = false;
};

struct Panel {
  std::string title;
  Axis x;
  Axis y;
  std::vector<Line> lines;
  std::vector<Mark> marks{};
};

/// Panels in columns with one legend.
struct LineFigure {
  std::vector<Panel> panels;
  int columns = 1;
  double panel_width = 620.0;  // [px] with its labels
  double panel_height = 260.0;
};

/// Curves with many points are thinned to two points in half a pixel, so that a zoom shows more; no peak is lost.
[[nodiscard]] std::string to_svg(const LineFigure& figure);

}  // namespace hybridtest::plot
