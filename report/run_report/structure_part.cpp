// Histories, drifts, energy and spectra of the structure.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/plotting/page.hpp"
#include "report/plotting/svg_canvas.hpp"
#include "report/run_report/report_figures.hpp"
#include "report/run_report/tuning.hpp"

namespace hybridtest::run_report {
namespace {

using plot::Line;
using plot::Panel;
using plot::Signal;

/// Curves of that name, those with the largest peaks first.
std::vector<const SignalCurve*> largest(const std::vector<SignalCurve>& curves, std::string_view name) {
  std::vector<const SignalCurve*> found;
  for (const SignalCurve& curve : curves) {
    if (curve.name.name == name) found.push_back(&curve);
  }
  std::ranges::stable_sort(found, std::greater{}, [](const SignalCurve* curve) { return std::abs(curve->peak); });
  return found;
}

std::string not_shown(std::size_t all, std::string_view what) {
  if (all <= kDofsShown) return "";
  return fmt::format("<p class=\"fine\">The {} {} with the largest peaks; {} more are in the recording.</p>\n",
                     kDofsShown, what, all - kDofsShown);
}

/// Each degree of freedom in its panel, over the same of the others; all in one panel without others.
std::vector<Panel> displacement_panels(const ReportFacts& facts, std::vector<const SignalCurve*> curves) {
  curves.resize(std::min(curves.size(), kDofsShown));
  const std::string label = "displacement [mm]";
  std::vector<Panel> panels;
  std::vector<Line> together;
  for (const SignalCurve* curve : curves) {
    if (facts.others.empty()) {
      together.push_back(line_of(*curve, curve->name.subject));
      continue;
    }
    std::vector<Line> lines;
    for (const Compared& other : facts.others) {
      if (const SignalCurve* same = find_curve(other.structure, curve->name)) {
        lines.push_back(line_of(*same, other.label));
        lines.back().is_background = facts.others.size() == 1;
        lines.back().is_dashed = !lines.back().is_background;
      }
    }
    lines.push_back(line_of(*curve, "this run"));
    panels.push_back(time_panel(facts, "displacement of " + curve->name.subject, label, std::move(lines)));
  }
  if (!together.empty()) {
    panels.push_back(time_panel(facts, "displacement relative to the ground", label, std::move(together)));
  }
  return panels;
}

Panel named_curves(const ReportFacts& facts, std::string title, std::string label,
                   const std::vector<std::pair<std::string_view, std::string>>& names) {
  std::vector<Line> lines;
  for (const auto& [name, words] : names) {
    if (const SignalCurve* curve = find_curve(facts.run.structure, name)) lines.push_back(line_of(*curve, words));
  }
  return time_panel(facts, std::move(title), std::move(label), std::move(lines));
}

}  // namespace

std::string structure_part(const ReportFacts& facts) {
  const std::vector<SignalCurve>& curves = facts.run.structure;
  const auto displacements = largest(curves, "displacement");
  auto drifts = largest(curves, "drift");
  std::vector<Line> ground;
  for (const SignalCurve& curve : curves) {
    if (curve.name.name != "ground_acceleration" || ground.size() >= kDofsShown) continue;
    ground.push_back(line_of(curve, "ground motion" + (curve.name.subject.empty() ? "" : " " + curve.name.subject),
                             Signal::ground_motion));
  }
  std::vector<Panel> panels{time_panel(facts, "ground acceleration", "[m/s²]", std::move(ground))};
  for (Panel& panel : displacement_panels(facts, displacements)) panels.push_back(std::move(panel));
  std::string html = figure_of(std::move(panels)) + not_shown(displacements.size(), "degrees of freedom");

  drifts.resize(std::min(drifts.size(), kDofsShown));
  std::vector<Line> drift_lines;
  for (const SignalCurve* curve : drifts) drift_lines.push_back(line_of(*curve, curve->name.subject));
  html += figure_of({time_panel(facts, "drift of each substructure", "[mm]", std::move(drift_lines)),
                     named_curves(facts, "base shear", "[kN]", {{"base_shear", "base shear"}})});
  const std::string energy =
      figure_of({named_curves(facts, "energy relative to the ground", "[J]",
                              {{"input_energy", "input"},
                               {"kinetic_energy", "kinetic"},
                               {"damping_energy", "dissipated by damping"},
                               {"restoring_energy", "stored and dissipated by restoring forces"}}),
                 named_curves(facts, "error of the energy balance", "[J]", {{"energy_balance_error", "error"}})});
  if (!energy.empty()) {
    html += energy;
    const SignalCurve* error = find_curve(curves, "energy_balance_error");
    const SignalCurve* input = find_curve(curves, "input_energy");
    if (error != nullptr && input != nullptr && input->peak != 0.0) {
      html += fmt::format(
          "<p class=\"fine\">The balance misses {} J at most, {} % of the largest input: what the integration in time "
          "and "
          "the coupling add or take away.</p>\n",
          fmt::format("{:.2g}", std::abs(error->peak)),
          fmt::format("{:.2g}", 100.0 * std::abs(error->peak / input->peak)));
    }
  } else if (!displacements.empty()) {
    html += fmt::format(
        "<p class=\"fine\">No energy balance: it needs the scenario, its mass and damping, and the record of every "
        "degree "
        "of freedom.{}</p>\n",
        facts.run.why_no_scenario.empty() ? "" : " The scenario: " + plot::escaped(facts.run.why_no_scenario));
  }
  return section("structure", "The structure", html);
}

std::string spectra_part(const ReportFacts& facts) {
  Panel acceleration{.title = "pseudo-acceleration",
                     .x = {.label = "period [s]", .is_logarithmic = true},
                     .y = {.label = "[g]"},
                     .lines = {}};
  Panel displacement{
      .title = "displacement relative to the ground", .x = acceleration.x, .y = {.label = "[mm]"}, .lines = {}};
  for (std::size_t i = 0; i < facts.summary.ground_motions.size(); ++i) {
    const std::string name =
        facts.summary.ground_motions.size() > 1 ? fmt::format("ground motion {}", i + 1) : "ground motion";
    Line in_g{.name = name, .signal = i == 0 ? Signal::ground_motion : Signal::other};
    Line in_mm = in_g;
    for (const SpectrumPoint& point : facts.summary.ground_motions[i].spectrum) {
      if (point.mode > 0) {
        if (i > 0) continue;
        const std::string text = fmt::format("mode {} of the structure, {} s", point.mode, number_text(point.period_s));
        acceleration.marks.push_back({point.period_s, text, false});
        displacement.marks.push_back({point.period_s, text, false});
        continue;
      }
      in_g.x.push_back(point.period_s);
      in_g.y.push_back(point.pseudo_acceleration_m_per_s2 / kStandardGravity_m_per_s2);
      in_mm.x.push_back(point.period_s);
      in_mm.y.push_back(1e3 * point.displacement_m);
    }
    acceleration.lines.push_back(std::move(in_g));
    displacement.lines.push_back(std::move(in_mm));
  }
  std::string html = figure_of({std::move(acceleration), std::move(displacement)}, 2, kHalfFigure, 280.0);
  if (!html.empty()) {
    html +=
        "<p class=\"fine\">Response of an oscillator with 5 % damping to what was applied; dotted: the periods of the "
        "structure.</p>\n";
  }
  return section("spectra", "Response spectra", html);
}

}  // namespace hybridtest::run_report
