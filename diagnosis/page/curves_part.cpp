#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/signal/frequency_evaluation.hpp"
#include "diagnosis/localisation/tracking_screens.hpp"
#include "diagnosis/page/page_parts.hpp"
#include "diagnosis/page/series_view.hpp"
#include "diagnosis/page/wording.hpp"
#include "report/plotting/svg_canvas.hpp"

namespace hybridtest::report {
namespace {

using plot::Line;
using plot::LineFigure;
using plot::Panel;

constexpr double kWide = 900.0;
const std::string kMeasured = "measured";
const std::string kModel = "model as given";
const std::string kAugmented = "model with the cause added";

Line measured_behind(Line line) {
  line.is_background = true;
  return line;
}

std::vector<Line> outputs(const SeriesView& view, SeriesView::Range range) {
  const InterfaceSeries& series = view.series();
  std::vector<Line> lines{measured_behind(view.over_time(kMeasured, series.measured, range)),
                          view.over_time(kModel, series.model, range)};
  if (view.has_augmented()) lines.push_back(view.over_time(kAugmented, series.augmented, range));
  return lines;
}

std::vector<Line> residuals(const SeriesView& view, SeriesView::Range range) {
  const auto values = [](const GapSignals& signals) {
    return std::vector<double>(signals.residual.begin(), signals.residual.end());
  };
  std::vector<Line> lines{view.over_time(kModel, values(view.before()), range)};
  if (view.has_augmented()) lines.push_back(view.over_time(kAugmented, values(view.after()), range));
  return lines;
}

std::string histories(const SeriesView& view) {
  const SeriesView::Range close_up = view.close_up();
  LineFigure figure{
      .panels = {{"the whole recording", {"time [s]"}, {view.output_label()}, outputs(view, view.whole())},
                 {"measured less modelled", {"time [s]"}, {view.output_label()}, residuals(view, view.whole())},
                 {"where the gap is largest", {"time [s]"}, {view.output_label()}, outputs(view, close_up)},
                 {"measured less modelled", {"time [s]"}, {view.output_label()}, residuals(view, close_up)}},
      .columns = 1,
      .panel_width = kWide,
      .panel_height = 210.0};
  return to_svg(figure);
}

/// Force over displacement of a specimen, measured over commanded of a transfer system.
std::string loops(const SeriesView& view) {
  const InterfaceSeries& series = view.series();
  const SeriesView::Range range = view.close_up();
  const std::string input = view.gives_force() ? "displacement [mm]" : "command [mm]";
  const std::string title = view.gives_force() ? "force over displacement" : "synchronisation subspace";
  const Line measured = measured_behind(view.over_input(kMeasured, series.measured, range));
  std::vector<Panel> panels{
      {title + ", before", {input}, {view.output_label()}, {measured, view.over_input(kModel, series.model, range)}}};
  if (view.has_augmented()) {
    panels.push_back({title + ", after",
                      {input},
                      {view.output_label()},
                      {measured, view.over_input(kAugmented, series.augmented, range)}});
  }
  return to_svg(LineFigure{
      .panels = panels, .columns = static_cast<int>(panels.size()), .panel_width = kHalfWidth, .panel_height = 360.0});
}

std::string tracking(const SeriesView& view) {
  const InterfaceSeries& series = view.series();
  std::vector<double> indicator = tracking_indicator_m2(series.input_m, series.measured);
  Line line{.name = "tracking indicator"};
  for (std::size_t i = 0; i < indicator.size(); ++i) {
    line.x.push_back(static_cast<double>(i) * series.sample_period_s);
    line.y.push_back(kMillimetres * kMillimetres * indicator[i]);
  }
  return to_svg(LineFigure{.panels = {{"tracking indicator (rising: behind)", {"time [s]"}, {"TI [mm²]"}, {line}}},
                           .columns = 1,
                           .panel_width = kWide,
                           .panel_height = 190.0});
}

std::string screens_text(const SeriesView& view) {
  const InterfaceSeries& series = view.series();
  const auto evaluation = evaluate_tracking_frequency(series.input_m, series.measured, series.sample_period_s);
  if (!evaluation) return "";
  return fmt::format(
      "<p>Frequency evaluation index: amplitude {:.3f}, delay {} at {:.2f} Hz. Screens show that an actuator is off, "
      "not why: "
      "a delay of one frequency may be the lag of another.</p>\n",
      evaluation->amplitude, quantity(evaluation->delay_s, "s"), evaluation->frequency_hz);
}

/// What the delay of the transfer system does with the stiffness of the specimen.
std::string consequence_text(const DiagnosisReport& report, const InterfaceSeries& transfer) {
  const auto specimen = std::ranges::find_if(report.series, [&](const InterfaceSeries& series) {
    return series.unit == "N" && series.dof == transfer.dof && series.recording == transfer.recording &&
           series.measured.size() == transfer.measured.size();
  });
  if (specimen == report.series.end()) return "";
  const auto consequence =
      delay_consequence(transfer.input_m, transfer.measured, specimen->measured, transfer.sample_period_s);
  if (!consequence) return "";
  const auto monitor =
      error_monitor(transfer.input_m, transfer.measured, specimen->measured, consequence->stiffness_n_per_m);
  return fmt::format(
      "<p>In a hybrid test that lateness acts as a damper of {} (−k τ, k = {}): where the structure damps less at this "
      "degree of "
      "freedom, the test turns unstable. Hybrid simulation error monitor at the end: {:.2f} of the peak strain "
      "energy.</p>\n",
      quantity(consequence->equivalent_damping_n_s_per_m, "N s/m"), quantity(consequence->stiffness_n_per_m, "N/m"),
      monitor.back());
}

std::string heading(const InterfaceSeries& series) {
  return fmt::format("<h2>Measured against modelled: {}</h2>\n<p class=\"fine\">{}, {}{}</p>\n",
                     plot::escaped(plain(series.interface)), plot::escaped(series.recording),
                     series.is_held_out ? "held out" : "used for the fit",
                     series.dof > 0 ? fmt::format(", degree of freedom {}", series.dof + 1) : "");
}

}  // namespace

std::string curves_part(const DiagnosisReport& report) {
  if (report.series.empty()) return "";
  const SeriesView view{report.series.front()};
  std::string html = heading(view.series()) + histories(view) + loops(view);
  const auto transfer = std::ranges::find_if(report.series, [](const auto& series) { return series.unit == "m"; });
  if (transfer == report.series.end()) return html;
  const SeriesView motion{*transfer};
  html += "<h2>How the actuator follows</h2>\n" + screens_text(motion) + consequence_text(report, *transfer);
  html += tracking(motion);
  if (&*transfer != &view.series()) html += loops(motion);
  return html;
}

}  // namespace hybridtest::report
