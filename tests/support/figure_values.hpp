#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "report/plotting/thinning.hpp"

namespace hybridtest {

/// The numbers of the first attribute `name="…"` behind `from`.
inline std::vector<double> attribute_numbers(const std::string& svg, std::size_t from, const std::string& name) {
  const std::size_t at = svg.find(" " + name + "=\"", from);
  if (at == std::string::npos) return {};
  const std::size_t begin = at + name.size() + 3;
  std::istringstream text{svg.substr(begin, svg.find('"', begin) - begin)};
  std::vector<double> numbers;
  for (double number = 0.0; text >> number;) numbers.push_back(number);
  return numbers;
}

/// The values of a curve of a figure, read back by what its panel says of its axes, as figures.js does. Linear axes.
/// @param from   where to begin in the page.
/// @return empty when there is no such panel or curve.
inline plot::Points shown_curve(const std::string& page, const std::string& panel, const std::string& curve,
                                std::size_t from = 0) {
  const std::size_t begin = page.find("data-title=\"" + panel + "\"", from);
  const std::size_t end = begin == std::string::npos ? begin : page.find("</svg>", begin);
  const std::size_t path = page.find("data-name=\"" + curve + "\"", begin);
  if (begin == std::string::npos || path == std::string::npos || path > end) return {};
  const std::vector<double> x_axis = attribute_numbers(page, begin, "data-x");
  const std::vector<double> y_axis = attribute_numbers(page, begin, "data-y");
  const std::vector<double> box = attribute_numbers(page, begin, "viewBox");
  const std::size_t points = page.find(" d=\"", path) + 4;
  std::istringstream text{page.substr(points, page.find('"', points) - points)};
  plot::Points values;
  double x = 0.0;
  double y = 0.0;
  for (char letter = ' '; text >> letter;) {
    if (letter == 'M') {
      x = y = 0.0;
    } else if (letter != 'l') {
      text.putback(letter);
    }
    double right = 0.0;
    double down = 0.0;
    if (!(text >> right >> down)) break;
    x += right;
    y += down;
    values.x.push_back(x_axis[0] + x / box[2] * (x_axis[1] - x_axis[0]));
    values.y.push_back(y_axis[1] - y / box[3] * (y_axis[1] - y_axis[0]));
  }
  return values;
}

}  // namespace hybridtest
