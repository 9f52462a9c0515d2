#pragma once

#include <string>
#include <vector>

namespace hybridtest::plot {

/// A table of shares as shaded cells; each cell shows its share.
struct HeatFigure {
  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<std::string> x_edges;  // one more than columns, from the left
  std::vector<std::string> y_edges;  // one more than rows, from below
  std::vector<double> shares;        // row by row from below, 0 to 1; negative: an empty cell
  double width = 560.0;              // [px]
  double height = 330.0;
};

[[nodiscard]] std::string to_svg(const HeatFigure& figure);

}  // namespace hybridtest::plot
