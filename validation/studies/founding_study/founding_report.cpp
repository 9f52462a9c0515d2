#include "validation/studies/founding_study/founding_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <string_view>

#include "report/plotting/line_figure.hpp"
#include "report/plotting/page.hpp"

namespace hybridtest::founding {
namespace {

constexpr std::string_view kOurs = "force_correction";

std::vector<double> scaled(std::span<const double> values, double factor) {
  std::vector<double> result(values.begin(), values.end());
  for (double& value : result) value *= factor;
  return result;
}

std::string method_figure(const MethodRun& run, const MethodRun& exact) {
  plot::LineFigure figure{.panels = {}, .columns = 1, .panel_width = 1200.0, .panel_height = 210.0};
  for (std::size_t floor = kFloors; floor-- > 0;) {
    double peak_mm = 0.0;
    for (const double value : exact.displacement_m[floor]) peak_mm = std::max(peak_mm, 1e3 * std::abs(value));
    plot::Panel panel{
        .title = fmt::format("floor {}", floor + 1),
        .x = {.label = "time [s]", .is_logarithmic = false, .low = 0.0, .high = exact.time_s.back()},
        .y = {.label = "displacement [mm]", .is_logarithmic = false, .low = -1.5 * peak_mm, .high = 1.5 * peak_mm},
        .lines = {}};
    panel.lines.push_back({"exact", exact.time_s, scaled(exact.displacement_m[floor], 1e3), true});
    panel.lines.push_back({run.name, run.time_s, scaled(run.displacement_m[floor], 1e3)});
    figure.panels.push_back(std::move(panel));
  }
  return to_svg(figure);
}

/// Largest errors are kept over this time, so that a curve shows the size of an oscillating error.
constexpr double kEnvelope_s = 1.0;

/// Largest |error| of the last second, over the exact peak of the floor [%].
plot::Line error_line(const MethodRun& run, const MethodRun& exact, std::size_t floor) {
  const auto& wanted = exact.displacement_m[floor];
  double peak_m = 0.0;
  for (const double value : wanted) peak_m = std::max(peak_m, std::abs(value));
  plot::Line line{.name = run.name, .x = run.time_s, .y = {}, .is_emphasised = run.name == kOurs};
  std::deque<std::size_t> largest;  // of the samples within the time, the largest first, each later than the one before
  const auto error_m = [&](std::size_t i) { return std::abs(run.displacement_m[floor][i] - wanted[i]); };
  line.x.resize(std::min(run.time_s.size(), wanted.size()));
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    while (!largest.empty() && error_m(largest.back()) <= error_m(i)) largest.pop_back();
    largest.push_back(i);
    while (run.time_s[i] - run.time_s[largest.front()] > kEnvelope_s) largest.pop_front();
    line.y.push_back(100.0 * error_m(largest.front()) / peak_m);
  }
  return line;
}

/// The errors of all methods on one logarithmic scale.
std::string error_figure(std::span<const MethodRun> runs) {
  plot::LineFigure figure{.panels = {}, .columns = 1, .panel_width = 1200.0, .panel_height = 300.0};
  for (std::size_t floor = kFloors; floor-- > 0;) {
    plot::Panel panel{
        .title = fmt::format("floor {}: largest error within {:g} s, over the exact peak", floor + 1, kEnvelope_s),
        .x = {.label = "time [s]", .is_logarithmic = false, .low = 0.0, .high = runs[0].time_s.back()},
        .y = {.label = "error [%]", .is_logarithmic = true, .low = 0.01, .high = 200.0},
        .lines = {}};
    for (const std::size_t i : best_first(runs)) panel.lines.push_back(error_line(runs[i], runs[0], floor));
    figure.panels.push_back(std::move(panel));
  }
  return to_svg(figure);
}

std::string ranking_table(std::span<const MethodRun> runs) {
  std::vector<std::vector<std::string>> rows;
  for (const std::size_t i : best_first(runs)) {
    const Distance d = distance_of(runs[i], runs[0]);
    rows.push_back({fmt::format("{}. {}", rows.size() + 1, d.name), fmt::format("{:.2f}", worst_rms_percent(d)),
                    fmt::format("{:.2f}", d.rms_percent[0]), fmt::format("{:.2f}", d.rms_percent[1]),
                    fmt::format("{:.2f}", std::ranges::max(d.peak_percent)), std::to_string(d.jumps),
                    d.is_complete ? "completed" : fmt::format("ended after {:.2f} s", d.lasted_s), kMethods[i].figure});
  }
  return plot::number_table({"method", "rms error [%]", "floor 1 [%]", "floor 2 [%]", "largest error [%]",
                             "jumps of force", "test", "in the study"},
                            rows);
}

const MethodRun& run_named(std::span<const MethodRun> runs, std::string_view name) {
  return *std::ranges::find(runs, name, &MethodRun::name);
}

/// The forces of actuator 1 near the largest jump of the quadratic correction.
std::string jump_figure(std::span<const MethodRun> runs) {
  const MethodRun& quadratic = run_named(runs, "force_correction_quadratic");
  const auto& force_n = quadratic.force_n[0];
  std::size_t at = 0;
  double largest_n = 0.0;
  for (std::size_t i = 1; i < force_n.size(); ++i) {
    const double change_n = std::abs(force_n[i] - force_n[i - 1]);
    if (change_n <= largest_n) continue;
    largest_n = change_n;
    at = i;
  }
  constexpr double kAboutS = 0.5;
  const double centre_s = quadratic.period_time_s[at];
  plot::Panel panel{
      .title = "force of actuator 1 near the largest jump",
      .x = {.label = "time [s]", .is_logarithmic = false, .low = centre_s - kAboutS, .high = centre_s + kAboutS},
      .y = {.label = "force [kN]", .is_logarithmic = false, .low = -22.2, .high = 22.2},
      .lines = {}};
  for (const char* name : {"exact", "force_correction_quadratic", "force_correction"}) {
    const MethodRun& run = run_named(runs, name);
    plot::Line line{.name = name, .x = {}, .y = {}, .is_background = run.name == "exact"};
    for (std::size_t i = 0; i < run.period_time_s.size(); ++i) {
      if (std::abs(run.period_time_s[i] - centre_s) > kAboutS) continue;
      line.x.push_back(run.period_time_s[i]);
      line.y.push_back(1e-3 * run.force_n[0][i]);
    }
    panel.lines.push_back(std::move(line));
  }
  return to_svg(
      plot::LineFigure{.panels = {std::move(panel)}, .columns = 1, .panel_width = 1200.0, .panel_height = 280.0});
}

}  // namespace

std::string table_csv(std::span<const MethodRun> runs) {
  std::string text =
      "method,completed,lasted_s,rms_error_floor_1_percent,rms_error_floor_2_percent,peak_error_floor_1_percent,"
      "peak_error_floor_2_percent,largest_force_change_percent,jumps,energy_error_j,interlock\n";
  for (const MethodRun& run : runs) {
    const Distance d = distance_of(run, runs[0]);
    text += fmt::format("{},{},{:.3f},{:.4f},{:.4f},{:.4f},{:.4f},{:.3f},{},{:.2f},\"{}\"\n", d.name,
                        d.is_complete ? "yes" : "no", d.lasted_s, d.rms_percent[0], d.rms_percent[1], d.peak_percent[0],
                        d.peak_percent[1], d.largest_change_percent, d.jumps, d.energy_error_j, d.interlock);
  }
  return text;
}

std::string summary_markdown(std::span<const MethodRun> runs) {
  std::string findings = "| finding of the study | here | |\n| --- | --- | --- |\n";
  for (const Finding& finding : find(runs)) {
    findings +=
        fmt::format("| {} | {} | {} |\n", finding.what, finding.shown_by, finding.is_shown ? "shown" : "**NOT SHOWN**");
  }
  std::string table =
      "| method | | lasted [s] | rms error, floors 1 and 2 [%] | peak error, floors 1 and 2 [%] | largest change of a "
      "force "
      "in a control period [%] | jumps |\n| --- | --- | --- | --- | --- | --- | --- |\n";
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const Distance d = distance_of(runs[i], runs[0]);
    table += fmt::format("| {} | {} | {:.2f}{} | {:.2f}, {:.2f} | {:.2f}, {:.2f} | {:.2f} | {} |\n", d.name,
                         kMethods[i].figure, d.lasted_s, d.interlock.empty() ? "" : " (" + d.interlock + ")",
                         d.rms_percent[0], d.rms_percent[1], d.peak_percent[0], d.peak_percent[1],
                         d.largest_change_percent, d.jumps);
  }
  return fmt::format(
      "# The founding study: two storeys, two actuators, four methods of delay compensation\n\n"
      "Actuators with a delay of 10 ms, load cells with noise, both storeys are specimens; simulated with the nodes of "
      "a "
      "real test.\n\n"
      "## Findings\n\n{}\n## Methods compared with the exact specimen\n\n{}\n"
      "- Errors are evaluated until the test of a method ended: rms over the exact rms of that time, peaks over the "
      "exact "
      "peak of the whole test, forces over the exact peak force.\n"
      "- A jump is a change of a force by more than {:.0f} % of the exact peak force from one control period to the "
      "next. "
      "The jumps of polynomial_force are load cell noise, which it amplifies 27 times (root mean square), and not "
      "jumps "
      "of the method.\n"
      "- With an elastic specimen and without noise, extrapolation of the force and of the displacement are "
      "equivalent: it "
      "does not matter on which side of the actuator the polynomial is. Extrapolation of the force is worse because "
      "load cells are noisy and targets are not.\n",
      findings, table, 100.0 * kJumpShare);
}

std::string page_html(std::span<const MethodRun> runs) {
  std::vector<plot::PageSection> sections{
      {"Methods, best first",
       "Errors of the displacement until the test ended: root mean square over that of the exact displacement, the "
       "largest over the exact peak. Methods are sorted by the larger rms error of the two floors; tests that ended "
       "early come last.",
       ranking_table(runs)},
      {"Errors over time", "All methods on one scale. A factor of ten has the same height everywhere.",
       error_figure(runs)}};
  for (const std::size_t i : best_first(runs)) {
    const Distance d = distance_of(runs[i], runs[0]);
    sections.push_back(
        {fmt::format("{} ({})", runs[i].name, kMethods[i].figure),
         fmt::format("rms error {:.2f} % (floor 1), {:.2f} % (floor 2). {}", d.rms_percent[0], d.rms_percent[1],
                     d.interlock.empty() ? "" : fmt::format("Ended after {:.2f} s: {}.", d.lasted_s, d.interlock)),
         method_figure(runs[i], runs[0])});
  }
  sections.push_back(
      {"Jumps of the quadratic force correction",
       "Where the parabola does not reach the desired displacement, the published method uses the uncorrected force. "
       "The figure shows the force that the integrator received, in each control period.",
       jump_figure(runs)});
  return plot::html_page("The founding study's figures 9 to 13",
                         "Four published methods of delay compensation, one of ours, and no compensation, against the "
                         "exact specimen; two-storey test with two actuators.",
                         sections);
}

}  // namespace hybridtest::founding
