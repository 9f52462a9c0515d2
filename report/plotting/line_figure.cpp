#include "report/plotting/line_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "report/plotting/svg_canvas.hpp"
#include "report/plotting/thinning.hpp"

namespace hybridtest::plot {
namespace {

constexpr double kLeft = 72.0;
constexpr double kRight = 14.0;
constexpr double kTop = 26.0;
constexpr double kBottom = 40.0;
constexpr double kLegendRow = 18.0;
constexpr double kLegendLetter = 7.3;  // [px] width

/// After the last colour, the same colours with dashed lines.
constexpr std::array<std::string_view, 3> kDashes{"", "7 3", "2 2.5"};
constexpr std::string_view kBackgroundColour = "#b5b5b5";
constexpr double kBackgroundWidth = 3.0;
constexpr double kLineWidth = 1.6;
constexpr std::string_view kSecondDashes = "6 3";
constexpr double kColumnsPerPixel = 2.0;

struct LegendEntry {
  std::string name;
  Stroke stroke;
};

std::vector<LegendEntry> legend_of(const LineFigure& figure) {
  std::vector<LegendEntry> legend;
  std::size_t coloured = 0;
  for (const Panel& panel : figure.panels) {
    for (const Line& line : panel.lines) {
      if (std::ranges::find(legend, line.name, &LegendEntry::name) != legend.end()) continue;
      Stroke stroke{colour_of(line.signal),
                    line.is_background   ? kBackgroundWidth
                    : line.is_emphasised ? 3.0
                                         : kLineWidth,
                    line.is_dashed || line.signal == Signal::limit ? kSecondDashes : ""};
      if (stroke.colour.empty() && line.is_background) {
        stroke.colour = kBackgroundColour;
      } else if (stroke.colour.empty()) {
        stroke.colour = kOtherColours[coloured % kOtherColours.size()];
        if (!line.is_dashed) stroke.dashes = kDashes[(coloured / kOtherColours.size()) % kDashes.size()];
        ++coloured;
      }
      legend.push_back({line.name, stroke});
    }
  }
  return legend;
}

struct Extent {
  double least = std::numeric_limits<double>::infinity();
  double most = -std::numeric_limits<double>::infinity();
  void include(double value, bool is_logarithmic) noexcept {
    if (!std::isfinite(value) || (is_logarithmic && value <= 0.0)) return;
    least = std::min(least, value);
    most = std::max(most, value);
  }
};

class PanelPainter {
 public:
  PanelPainter(SvgCanvas& canvas, const Panel& panel, const Box& outer)
      : canvas_{canvas},
        panel_{panel},
        box_{outer.left + kLeft, outer.top + kTop, outer.width - kLeft - kRight, outer.height - kTop - kBottom},
        x_{scale_of(panel.x, &Line::x)},
        y_{scale_of(panel.y, &Line::y)} {}

  void paint(const std::vector<LegendEntry>& legend) {
    canvas_.begin_panel(attributes());
    paint_axes();
    canvas_.begin_window(box_);
    const auto in_order = [&](bool is_background) {
      for (const Line& line : panel_.lines) {
        if (line.is_background == is_background) {
          paint(line, std::ranges::find(legend, line.name, &LegendEntry::name)->stroke);
        }
      }
    };
    in_order(true);
    in_order(false);
    for (const Mark& mark : panel_.marks) {
      const double x = place(mark.x, 0.0).x;
      if (x >= box_.left && x <= box_.right()) canvas_.mark(x, box_, mark.text, mark.is_fault ? "#b3261e" : "#555");
    }
    canvas_.end_window();
    canvas_.frame(box_);
    canvas_.end_panel();
  }

 private:
  [[nodiscard]] Scale scale_of(const Axis& axis, std::vector<double> Line::*values) const {
    Extent extent;
    for (const Line& line : panel_.lines) {
      for (const double value : line.*values) extent.include(value, axis.is_logarithmic);
    }
    return {axis, extent.least, extent.most};
  }

  [[nodiscard]] Place place(double x, double y) const noexcept {
    return {box_.left + x_.share(x) * box_.width, box_.bottom() - y_.share(y) * box_.height};
  }

  /// What figures.js must know to zoom and to name values.
  [[nodiscard]] std::string attributes() const {
    return fmt::format(
        R"(data-title="{}" data-x="{:.10g} {:.10g}"{} data-x-label="{}" data-y="{:.10g} {:.10g}"{} data-y-label="{}")",
        escaped(panel_.title), x_.low(), x_.high(), panel_.x.is_logarithmic ? " data-x-log" : "",
        escaped(panel_.x.label), y_.low(), y_.high(), panel_.y.is_logarithmic ? " data-y-log" : "",
        escaped(panel_.y.label));
  }

  void paint_axes() {
    canvas_.begin_axes();
    for (const Tick& tick : x_.ticks()) {
      const double x = box_.left + x_.share(tick.value) * box_.width;
      canvas_.line({x, box_.top}, {x, box_.bottom()}, {"#e4e4e4", 1.0, ""});
      canvas_.text({x, box_.bottom() + 15.0}, tick.label, Anchor::middle, 11.0);
    }
    for (const Tick& tick : y_.ticks()) {
      const double y = box_.bottom() - y_.share(tick.value) * box_.height;
      canvas_.line({box_.left, y}, {box_.right(), y}, {"#e4e4e4", 1.0, ""});
      canvas_.text({box_.left - 5.0, y + 4.0}, tick.label, Anchor::end, 11.0);
    }
    canvas_.end_axes();
    canvas_.text({box_.left, box_.top - 8.0}, panel_.title, Anchor::start, 13.0, true);
    canvas_.text({box_.left + box_.width / 2.0, box_.bottom() + 32.0}, panel_.x.label, Anchor::middle);
    canvas_.vertical_text({box_.left - 57.0, box_.top + box_.height / 2.0}, panel_.y.label);
  }

  void paint(const Line& line, const Stroke& stroke) {
    HistoryThinner thinner{box_.left, box_.right(), static_cast<std::size_t>(kColumnsPerPixel * box_.width)};
    const std::size_t points = std::min(line.x.size(), line.y.size());
    for (std::size_t i = 0; i < points; ++i) {
      const Place next = place(line.x[i], line.y[i]);
      thinner.add(next.x, next.y);
    }
    const Points thinned = thinner.take();
    std::vector<Place> places;
    for (std::size_t i = 0; i < thinned.x.size(); ++i) places.push_back({thinned.x[i], thinned.y[i]});
    canvas_.curve(places, stroke, box_, line.name);
  }

  SvgCanvas& canvas_;
  const Panel& panel_;
  Box box_;
  Scale x_;
  Scale y_;
};

/// Legend entries in rows below the panels.
struct LegendLayout {
  double entry_width = 0.0;
  std::size_t per_row = 1;
  double height = 0.0;
};

LegendLayout layout_of(const std::vector<LegendEntry>& legend, double width) {
  std::size_t longest = 0;
  for (const LegendEntry& entry : legend) longest = std::max(longest, entry.name.size());
  LegendLayout layout;
  layout.entry_width = 48.0 + kLegendLetter * static_cast<double>(longest);
  layout.per_row = std::max<std::size_t>(1, static_cast<std::size_t>((width - kLeft) / layout.entry_width));
  const std::size_t rows = (legend.size() + layout.per_row - 1) / layout.per_row;
  layout.height = 10.0 + kLegendRow * static_cast<double>(rows);
  return layout;
}

std::string title_of(const LineFigure& figure) {
  std::string title;
  for (const Panel& panel : figure.panels) title += (title.empty() ? "" : "; ") + panel.title;
  return title;
}

}  // namespace

std::string to_svg(const LineFigure& figure) {
  const std::vector<LegendEntry> legend = legend_of(figure);
  const auto columns = static_cast<std::size_t>(figure.columns);
  const std::size_t rows = (figure.panels.size() + columns - 1) / columns;
  const double width = figure.panel_width * static_cast<double>(columns);
  const double panels_height = figure.panel_height * static_cast<double>(rows);
  const LegendLayout layout = layout_of(legend, width);
  SvgCanvas canvas{width, panels_height + layout.height, title_of(figure)};
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const std::size_t row = i / columns;
    const Box outer{static_cast<double>(i % columns) * figure.panel_width,
                    static_cast<double>(row) * figure.panel_height, figure.panel_width, figure.panel_height};
    PanelPainter{canvas, figure.panels[i], outer}.paint(legend);
  }
  for (std::size_t i = 0; i < legend.size(); ++i) {
    const double x = kLeft + static_cast<double>(i % layout.per_row) * layout.entry_width;
    const std::size_t row = i / layout.per_row;
    const double y = panels_height + 12.0 + static_cast<double>(row) * kLegendRow;
    canvas.line({x, y - 4.0}, {x + 30.0, y - 4.0}, legend[i].stroke);
    canvas.text({x + 36.0, y}, legend[i].name, Anchor::start);
  }
  return canvas.svg();
}

}  // namespace hybridtest::plot
