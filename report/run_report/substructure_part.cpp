// Histories, loops, tracking and interlocks of a substructure; timing of all.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "report/plotting/page.hpp"
#include "report/plotting/svg_canvas.hpp"
#include "report/run_report/report_figures.hpp"
#include "report/run_report/tuning.hpp"

namespace hybridtest::run_report {
namespace {

using plot::Line;
using plot::Panel;
using plot::Signal;

Line scaled_line(const plot::Points& points, std::string name, Signal signal, double x_factor, double y_factor) {
  Line line{.name = std::move(name), .x = points.x, .y = points.y, .signal = signal};
  for (double& value : line.x) value *= x_factor;
  for (double& value : line.y) value *= y_factor;
  return line;
}

const SubstructureRecord* same_substructure(const Compared& other, const std::string& id) {
  const auto found = std::ranges::find(other.substructures, id, &SubstructureRecord::id);
  return found == other.substructures.end() ? nullptr : &*found;
}

/// `measured` of this run, and of the others by their labels.
std::vector<Line> with_others(const ReportFacts& facts, const SubstructureRecord& site, const SignalCurve* curve,
                              const std::string& name, Signal signal) {
  std::vector<Line> lines;
  if (curve == nullptr) return lines;
  for (const Compared& other : facts.others) {
    const SubstructureRecord* same = same_substructure(other, site.id);
    const SignalCurve* there = same == nullptr ? nullptr : find_curve(same->signals, curve->name);
    if (there == nullptr) continue;
    lines.push_back(line_of(*there, name + ", " + other.label));
    lines.back().is_dashed = true;
  }
  lines.push_back(line_of(*curve, name, signal));
  return lines;
}

/// Over which all but the outliers of a delay are seen.
void fit_axis(plot::Panel& panel) {
  std::vector<double> values;
  for (const Line& line : panel.lines) {
    std::ranges::copy_if(line.y, std::back_inserter(values), [](double value) { return std::isfinite(value); });
  }
  if (values.empty()) return;
  std::ranges::sort(values);
  const auto last = static_cast<double>(values.size() - 1);
  const double low = std::min(0.0, values[static_cast<std::size_t>(kOutlierShare * last)]);
  const double high = std::max(0.0, values[static_cast<std::size_t>((1.0 - kOutlierShare) * last)]);
  if (!(high > low)) return;
  const double margin = 0.25 * (high - low);
  panel.y.low = low - margin;
  panel.y.high = high + margin;
}

std::string site_histories(const ReportFacts& facts, const SubstructureRecord& site, const std::string& dof) {
  const auto curve = [&](const char* name, const char* unit) {
    return find_curve(site.signals, SignalName{name, dof, unit});
  };
  std::vector<Line> motion;
  if (const SignalCurve* target = curve("target_displacement", "m")) {
    motion.push_back(line_of(*target, "target", Signal::target));
  }
  if (const SignalCurve* command = curve("command_displacement", "m")) {
    motion.push_back(line_of(*command, "command", Signal::target));
    motion.back().is_dashed = true;
  }
  for (Line& line : with_others(facts, site, curve("measured_displacement", "m"), "measured", Signal::measured)) {
    motion.push_back(std::move(line));
  }
  std::vector<Line> error;
  if (const SignalCurve* tracking = curve("tracking_error", "m")) error = {line_of(*tracking, "target less measured")};
  std::vector<Line> delay;
  if (const SignalCurve* estimated = curve("estimated_delay", "s")) {
    delay = {line_of(*estimated, "estimated delay")};
    for (double& value : delay.front().y) value *= 1e3;
  }
  Panel delays = time_panel(facts, "equivalent delay of the last two seconds", "[ms]", std::move(delay));
  fit_axis(delays);
  return figure_of(
      {time_panel(facts, "displacement", "[mm]", std::move(motion)),
       time_panel(facts, "force", "[kN]", with_others(facts, site, curve("force", "N"), "measured", Signal::measured)),
       time_panel(facts, "tracking error", "[mm]", std::move(error)), std::move(delays)});
}

std::string site_loops(const ReportFacts& facts, const SubstructureRecord& site, const SiteDof& dof) {
  Panel loop{.title = "force over displacement",
             .x = {.label = "measured displacement [mm]"},
             .y = {.label = "measured force [kN]"},
             .lines = {}};
  Panel subspace{
      .title = "synchronisation subspace", .x = {.label = "target [mm]"}, .y = {.label = "measured [mm]"}, .lines = {}};
  for (const Compared& other : facts.others) {
    const SubstructureRecord* same = same_substructure(other, site.id);
    if (same == nullptr) continue;
    const auto there = std::ranges::find(same->dofs, dof.name, &SiteDof::name);
    if (there == same->dofs.end()) continue;
    loop.lines.push_back(scaled_line(there->loop, "measured, " + other.label, Signal::other, 1e3, 1e-3));
    loop.lines.back().is_dashed = true;
    subspace.lines.push_back(scaled_line(there->subspace, "measured, " + other.label, Signal::other, 1e3, 1e3));
    subspace.lines.back().is_dashed = true;
  }
  loop.lines.push_back(scaled_line(dof.loop, "measured", Signal::measured, 1e3, 1e-3));
  subspace.lines.push_back(scaled_line(dof.subspace, "measured", Signal::measured, 1e3, 1e3));
  if (is_drawable(dof.subspace)) {
    const auto finite = [](double value) { return std::isfinite(value); };
    double least = 0.0;
    double most = 0.0;
    for (const double x : dof.subspace.x) {
      if (!finite(x)) continue;
      least = std::min(least, 1e3 * x);
      most = std::max(most, 1e3 * x);
    }
    subspace.lines.insert(
        subspace.lines.begin(),
        {.name = "perfect tracking", .x = {least, most}, .y = {least, most}, .signal = Signal::target});
  }
  return figure_of({std::move(loop), std::move(subspace)}, 2, kHalfFigure, 360.0);
}

std::string site_transfer(const SiteDof& dof) {
  Panel delay{.title = "equivalent delay",
              .x = {.label = "frequency [Hz]", .is_logarithmic = true},
              .y = {.label = "[ms]"},
              .lines = {}};
  Panel amplitude{.title = "amplitude, measured over target", .x = delay.x, .y = {.label = "[-]"}, .lines = {}};
  Line delays{.name = "measured", .signal = Signal::measured};
  Line amplitudes = delays;
  for (const TransferPoint& point : dof.transfer) {
    delays.x.push_back(point.frequency_hz);
    delays.y.push_back(1e3 * point.delay_s);
    amplitudes.x.push_back(point.frequency_hz);
    amplitudes.y.push_back(point.amplitude);
  }
  delay.lines.push_back(std::move(delays));
  amplitude.lines.push_back(std::move(amplitudes));
  const std::string figure = figure_of({std::move(delay), std::move(amplitude)}, 2, kHalfFigure, 250.0);
  if (figure.empty()) {
    return "<p class=\"fine\">No delay over frequency: the test is too short for it, or the measured motion does not "
           "go with "
           "the target's.</p>\n";
  }
  return figure +
         fmt::format(
             "<p class=\"fine\">From the mean spectra of overlapping segments; frequencies at which less than {:.0f} "
             "% of the measured motion goes with the target's are left out.</p>\n",
             100.0 * kCoherenceMin);
}

std::string plain_words(std::string name) {
  std::ranges::replace(name, '_', ' ');
  return name;
}

/// Shares of the limits over time, and the margins.
std::string site_interlocks(const ReportFacts& facts, const SubstructureRecord& site) {
  if (site.interlocks.empty()) return "";
  std::vector<Line> lines;
  std::vector<std::vector<std::string>> rows;
  for (const SignalCurve& curve : site.interlocks) {
    const double limit = curve.name.limit;
    if (!(limit > 0.0)) continue;
    Line line{.name = plain_words(curve.name.name), .x = curve.points.x, .y = curve.points.y};
    for (double& value : line.y) value = 100.0 * std::abs(value) / limit;
    lines.push_back(std::move(line));
    const ShownUnit unit = shown_unit(curve.name.unit);
    const double share = std::abs(curve.peak) / limit;
    rows.push_back({plain_words(curve.name.name), number_text(unit.factor * std::abs(curve.peak)),
                    number_text(unit.factor * limit), std::string{unit.unit.empty() ? "–" : unit.unit},
                    number_text(100.0 * share, 1), number_text(std::round(1000.0 * (1.0 - share)) / 10.0 + 0.0, 1),
                    number_text(curve.peak_time_s),
                    share >= 1.0          ? "✗ reached"
                    : share >= kNearLimit ? "! near"
                                          : "✓"});
  }
  if (lines.empty()) return "";
  lines.push_back({.name = "limit", .x = {0.0, facts.run.end_s}, .y = {100.0, 100.0}, .signal = Signal::limit});
  Panel panel = time_panel(facts, "share of each limit", "[%]", std::move(lines));
  panel.y.low = 0.0;
  return "<h3>Interlocks</h3>\n" + figure_of({std::move(panel)}) +
         plot::scrolling(plot::number_table(
             {"interlock", "largest", "limit", "unit", "share [%]", "margin [%]", "at [s]", "state"}, rows));
}

std::string numerical_histories(const ReportFacts& facts, const SubstructureRecord& substructure) {
  std::vector<Line> displacements;
  std::vector<Line> forces;
  for (const SignalCurve& curve : substructure.signals) {
    std::vector<Line>* lines = curve.name.name == "displacement" ? &displacements
                               : curve.name.name == "force"      ? &forces
                                                                 : nullptr;
    if (lines == nullptr || lines->size() >= kDofsShown) continue;
    lines->push_back(line_of(curve, curve.name.subject));
  }
  return figure_of({time_panel(facts, "displacement", "[mm]", std::move(displacements)),
                    time_panel(facts, "restoring force", "[kN]", std::move(forces))});
}

}  // namespace

std::string substructure_part(const ReportFacts& facts, const SubstructureRecord& substructure) {
  std::string html;
  if (!substructure.has_file) {
    html = fmt::format(
        "<p class=\"fine\">No recording of {} in this run directory: it ran on another host, or ended before it "
        "recorded. "
        "Copy its .h5 file here and write the report again.</p>\n",
        plot::escaped(substructure.id));
  } else if (substructure.dofs.empty()) {
    html = numerical_histories(facts, substructure);
  }
  for (const SiteDof& dof : substructure.dofs) {
    if (substructure.dofs.size() > 1) html += "<h3>" + plot::escaped(dof.name) + "</h3>\n";
    const std::string figures = site_histories(facts, substructure, dof.name) + site_loops(facts, substructure, dof);
    html += figures.empty() ? "" : figures + site_transfer(dof);
  }
  if (const SignalCurve* energy = find_curve(substructure.signals, std::string_view{"energy_error"})) {
    html += figure_of(
        {time_panel(facts, "energy that the tracking error added", "[J]", {line_of(*energy, "energy error")})});
  }
  html += site_interlocks(facts, substructure);
  if (html.empty()) html = "<p class=\"fine\">Its recording holds no rows of the test.</p>\n";
  return section("substructure_" + plot::escaped(substructure.id),
                 (substructure.is_site ? "Site " : "Numerical substructure ") + substructure.id, html);
}

namespace {

Line histogram_line(const TimeHistogram& histogram, std::string name) {
  TimeHistogram::Outline outline = histogram.outline();
  return {.name = std::move(name), .x = std::move(outline.time_us), .y = std::move(outline.percent)};
}

std::string milliseconds(const std::optional<Percentiles>& percentiles, double Percentiles::*value) {
  return percentiles ? number_text(1e-3 * (*percentiles).*value) : "–";
}

}  // namespace

namespace {

/// What a test in real time went on without, and what that may have done to it.
std::string bridge_figure(const ReportFacts& facts) {
  std::vector<Line> counts;
  std::vector<Line> energies;
  for (const SubstructureRecord& substructure : facts.run.substructures) {
    if (is_drawable(substructure.bridges)) {
      counts.push_back({.name = substructure.id, .x = substructure.bridges.x, .y = substructure.bridges.y});
    }
    if (is_drawable(substructure.bridged_energy_j)) {
      energies.push_back(
          {.name = substructure.id, .x = substructure.bridged_energy_j.x, .y = substructure.bridged_energy_j.y});
    }
  }
  return figure_of(
      {time_panel(facts, "bridged steps so far", "[-]", std::move(counts)),
       time_panel(facts, "energy that bridges added to the structure so far", "[J]", std::move(energies))});
}

/// The last part of the test stands for all.
std::string clock_table(const ReportFacts& facts) {
  std::vector<std::vector<std::string>> rows;
  for (const SubstructureSummary& substructure : facts.summary.substructures) {
    if (substructure.clock.empty()) continue;
    const ClockRelation& clock = substructure.clock.back();
    rows.push_back({substructure.id, number_text(clock.offset_s, 6), number_text(1e6 * clock.offset_uncertainty_s, 1),
                    number_text(1e6 * clock.drift, 1), number_text(1e6 * clock.drift_uncertainty, 1),
                    number_text(1e3 * clock.latency_there_s), number_text(1e3 * clock.latency_back_s)});
  }
  if (rows.empty()) return "";
  return plot::scrolling(plot::number_table({"clock less the coordinator's", "offset [s]", "± [µs]", "drift [ppm]",
                                             "± [ppm]", "latency of commands [ms]", "of answers [ms]"},
                                            rows));
}

}  // namespace

std::string timing_part(const ReportFacts& facts) {
  Panel latency{.title = "round trip of the exchanges",
                .x = {.label = "[µs]", .is_logarithmic = true},
                .y = {.label = "share [%]", .low = 0.0},
                .lines = {}};
  Panel lateness{.title = "lateness of control periods", .x = latency.x, .y = latency.y, .lines = {}};
  for (const SubstructureRecord& substructure : facts.run.substructures) {
    if (substructure.round_trip.count() > 0.0) {
      latency.lines.push_back(histogram_line(substructure.round_trip, substructure.id));
    }
    if (substructure.lateness.count() > 0.0) {
      lateness.lines.push_back(histogram_line(substructure.lateness, substructure.id));
    }
  }
  std::string html = figure_of({std::move(latency), std::move(lateness)}, 2, kHalfFigure, 250.0);
  std::vector<std::vector<std::string>> rows;
  for (const SubstructureSummary& substructure : facts.summary.substructures) {
    if (!substructure.exchange) continue;
    const ExchangeSummary& exchange = *substructure.exchange;
    std::vector<std::string> row{substructure.id, milliseconds(exchange.round_trip_us, &Percentiles::p50),
                                 milliseconds(exchange.round_trip_us, &Percentiles::p99),
                                 milliseconds(exchange.round_trip_us, &Percentiles::max)};
    for (const std::uint64_t count :
         {exchange.answered, exchange.resent, exchange.bridged, exchange.lost, exchange.late, exchange.held}) {
      row.push_back(std::to_string(count));
    }
    rows.push_back(std::move(row));
  }
  if (!rows.empty()) {
    html += plot::scrolling(plot::number_table({"substructure", "p50 [ms]", "p99 [ms]", "largest [ms]", "answered",
                                                "resent", "bridged", "lost", "late", "held"},
                                               rows));
  }
  html += bridge_figure(facts) + clock_table(facts);
  rows.clear();
  for (const SubstructureSummary& substructure : facts.summary.substructures) {
    if (!substructure.loop_timing) continue;
    const LoopTimingSummary& loop = *substructure.loop_timing;
    rows.push_back({substructure.id, number_text(loop.start_lateness_us.p50, 0),
                    number_text(loop.start_lateness_us.p99, 0), number_text(loop.start_lateness_us.max, 0),
                    number_text(loop.busy_us.p99, 0), std::to_string(loop.overruns),
                    loop.fifo_priority > 0 ? fmt::format("FIFO {}", loop.fifo_priority) : "ordinary"});
  }
  if (!rows.empty()) {
    html += plot::scrolling(plot::number_table(
        {"control loop", "late p50 [µs]", "p99 [µs]", "largest [µs]", "busy p99 [µs]", "overruns", "priority"}, rows));
  }
  return section("timing", "Latency and lateness", html);
}

}  // namespace hybridtest::run_report
