#include "report/plotting/heat_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/plotting/svg_canvas.hpp"

namespace hybridtest::plot {
namespace {

constexpr double kHeatLeft = 74.0;
constexpr double kHeatRight = 14.0;
constexpr double kHeatTop = 28.0;
constexpr double kHeatBottom = 44.0;

/// White to orange, by the share of the largest cell.
std::string shade(double intensity) {
  const auto between = [&](double white, double full) { return std::lround(white + intensity * (full - white)); };
  return fmt::format("#{:02x}{:02x}{:02x}", between(255.0, 224.0), between(255.0, 112.0), between(255.0, 32.0));
}

}  // namespace

std::string to_svg(const HeatFigure& figure) {
  const Box box{kHeatLeft, kHeatTop, figure.width - kHeatLeft - kHeatRight, figure.height - kHeatTop - kHeatBottom};
  const std::size_t columns = figure.x_edges.size() - 1;
  const std::size_t rows = figure.y_edges.size() - 1;
  const double cell_width = box.width / static_cast<double>(columns);
  const double cell_height = box.height / static_cast<double>(rows);
  const double most = figure.shares.empty() ? 0.0 : *std::ranges::max_element(figure.shares);
  SvgCanvas canvas{figure.width, figure.height, figure.title};
  canvas.text({box.left, box.top - 10.0}, figure.title, Anchor::start, 13.0, true);
  for (std::size_t i = 0; i < figure.shares.size(); ++i) {
    const std::size_t row = i / columns;
    const Box cell{box.left + static_cast<double>(i % columns) * cell_width,
                   box.bottom() - static_cast<double>(row + 1) * cell_height, cell_width, cell_height};
    const double share = figure.shares[i];
    canvas.bar(cell, share < 0.0 ? "#f3f3f3" : shade(most > 0.0 ? share / most : 0.0));
    if (share >= 0.005) {
      canvas.text({cell.left + cell.width / 2.0, cell.top + cell.height / 2.0 + 4.0},
                  fmt::format("{:.0f} %", 100.0 * share), Anchor::middle, 11.0);
    }
  }
  canvas.frame(box);
  for (std::size_t i = 0; i < figure.x_edges.size(); ++i) {
    canvas.text({box.left + static_cast<double>(i) * cell_width, box.bottom() + 15.0}, figure.x_edges[i],
                Anchor::middle, 11.0);
  }
  for (std::size_t i = 0; i < figure.y_edges.size(); ++i) {
    canvas.text({box.left - 5.0, box.bottom() - static_cast<double>(i) * cell_height + 4.0}, figure.y_edges[i],
                Anchor::end, 11.0);
  }
  canvas.text({box.left + box.width / 2.0, box.bottom() + 34.0}, figure.x_label, Anchor::middle);
  canvas.vertical_text({box.left - 56.0, box.top + box.height / 2.0}, figure.y_label);
  return canvas.svg();
}

}  // namespace hybridtest::plot
