#include "report/run_report/report_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/text/short_number.hpp"
#include "report/plotting/page.hpp"
#include "report/plotting/svg_canvas.hpp"
#include "report/run_report/tuning.hpp"

namespace hybridtest::run_report {

ShownUnit shown_unit(std::string_view si_unit) noexcept {
  if (si_unit == "m") return {"mm", 1e3};
  if (si_unit == "m/s") return {"mm/s", 1e3};
  if (si_unit == "N") return {"kN", 1e-3};
  if (si_unit == "m/s2") return {"m/s²", 1.0};
  return {si_unit, 1.0};
}

plot::Line line_of(const SignalCurve& curve, std::string name, plot::Signal signal) {
  plot::Line line{.name = std::move(name), .x = curve.points.x, .y = curve.points.y, .signal = signal};
  const double factor = shown_unit(curve.name.unit).factor;
  for (double& value : line.y) value *= factor;
  return line;
}

bool is_drawable(const plot::Points& points) noexcept { return points.x.size() >= 2; }

plot::Panel time_panel(const ReportFacts& facts, std::string title, std::string y_label,
                       std::vector<plot::Line> lines) {
  plot::Panel panel{.title = std::move(title),
                    .x = {.label = "model time [s]", .low = 0.0, .high = std::max(facts.run.end_s, 1e-9)},
                    .y = {.label = std::move(y_label)},
                    .lines = std::move(lines)};
  for (const RecordedEvent& recorded : facts.run.events) {
    if (recorded.event.severity == Severity::information || panel.marks.size() >= kMarksShown) continue;
    panel.marks.push_back({recorded.event.model_time_s, recorded.text, recorded.event.severity == Severity::fault});
  }
  return panel;
}

std::string figure_of(std::vector<plot::Panel> panels, int columns, double width, double height) {
  std::erase_if(panels, [](const plot::Panel& panel) {
    return std::ranges::none_of(panel.lines, [](const plot::Line& line) { return line.x.size() >= 2; });
  });
  if (panels.empty()) return "";
  const int used = std::min(columns, static_cast<int>(panels.size()));
  // One panel alone takes the whole width: a narrower figure would be enlarged, with its letters.
  return plot::scrolling(to_svg(plot::LineFigure{
      .panels = std::move(panels), .columns = used, .panel_width = width * columns / used, .panel_height = height}));
}

std::string section(std::string_view anchor, std::string_view heading, const std::string& html) {
  if (html.empty()) return "";
  return fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}</section>\n", anchor, plot::escaped(heading), html);
}

std::string number_text(double value, int decimals) {
  return std::isfinite(value) ? short_number(value, decimals) : "–";
}

}  // namespace hybridtest::run_report
