// Verdict, comparison, events, scenario and files.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <system_error>

#include "report/plotting/page.hpp"
#include "report/plotting/svg_canvas.hpp"
#include "report/run_report/advice.hpp"
#include "report/run_report/report_figures.hpp"
#include "report/run_report/scenario_differences.hpp"
#include "report/run_report/tuning.hpp"

namespace hybridtest::run_report {
namespace {

using plot::escaped;
using Rows = std::vector<std::vector<std::string>>;

std::string percent_text(const std::optional<double>& share) { return share ? number_text(100.0 * *share, 3) : "–"; }

std::string list_of(const std::vector<std::string>& lines) {
  if (lines.empty()) return "";
  std::string html = "<ul>\n";
  for (const std::string& line : lines) html += "<li>" + escaped(line) + "</li>\n";
  return html + "</ul>\n";
}

std::string table_if_any(const std::vector<std::string>& head, const Rows& rows) {
  return rows.empty() ? "" : plot::scrolling(plot::number_table(head, rows));
}

std::string peaks_of(const RunSummary& summary) {
  Rows displacements;
  for (const Peak& peak : summary.peak_displacement_m) {
    displacements.push_back({peak.dof, number_text(1e3 * peak.value), number_text(peak.model_time_s)});
    if (displacements.size() == kDofsShown) break;
  }
  Rows forces;
  Rows tracking;
  for (const SubstructureSummary& substructure : summary.substructures) {
    for (const Peak& peak : substructure.peak_force_n) {
      if (forces.size() == 2 * kDofsShown) break;
      forces.push_back(
          {substructure.id + " " + peak.dof, number_text(1e-3 * peak.value), number_text(peak.model_time_s)});
    }
    for (const TrackingError& error : substructure.tracking) {
      tracking.push_back({substructure.id + " " + error.dof, number_text(1e3 * error.rms_m, 4),
                          percent_text(error.rms_relative), number_text(1e3 * error.peak_m, 4),
                          error.equivalent_delay_s ? number_text(1e3 * *error.equivalent_delay_s) : "–",
                          error.amplitude ? number_text(*error.amplitude, 4) : "–"});
    }
  }
  const std::string peaks = table_if_any({"peak displacement", "mm", "at s"}, displacements) +
                            table_if_any({"peak restoring force", "kN", "at s"}, forces);
  return (peaks.empty() ? "" : "<div class=\"pair\">\n" + peaks + "</div>\n") +
         table_if_any({"tracking error", "RMS mm", "RMS %", "peak mm", "delay ms", "amplitude"}, tracking);
}

std::string steps_text(const RunSummary& summary) {
  std::string text = fmt::format("{}{} steps, {} s of model time", summary.completed_steps,
                                 summary.planned_steps ? fmt::format(" of {}", *summary.planned_steps) : "",
                                 number_text(summary.model_time_s));
  if (summary.wall_time_s) text += " in " + number_text(*summary.wall_time_s, 2) + " s";
  if (summary.steps_per_second) text += ", " + number_text(*summary.steps_per_second, 0) + " steps/s";
  if (!summary.start_time_utc.empty()) text += "; begun " + summary.start_time_utc;
  return text;
}

std::string bytes_text(std::uintmax_t bytes) {
  return bytes < 1'000'000 ? fmt::format("{:.0f} kB", 1e-3 * static_cast<double>(bytes))
                           : fmt::format("{:.1f} MB", 1e-6 * static_cast<double>(bytes));
}

std::string severity_text(Severity severity) {
  switch (severity) {
    case Severity::fault: return "✗ fault";
    case Severity::warning: return "! warning";
    default: return "";
  }
}

plot::Line scaled(const plot::Points& points, std::string name, double factor, plot::Signal signal) {
  plot::Line line{.name = std::move(name), .x = points.x, .y = points.y, .signal = signal};
  for (double& value : line.y) value *= factor;
  return line;
}

/// Measured and modelled output of each interface of a diagnosis.
std::string prediction_figures(const ReportFacts& facts, const Compared& other) {
  std::vector<plot::Panel> panels;
  for (const Prediction& prediction : other.predictions) {
    const ShownUnit unit = shown_unit(prediction.unit);
    std::vector<plot::Line> lines{scaled(prediction.measured, "measured", unit.factor, plot::Signal::measured),
                                  scaled(prediction.modelled, "model as given", unit.factor, plot::Signal::modelled)};
    if (is_drawable(prediction.completed)) {
      lines.push_back(
          scaled(prediction.completed, "model with the causes added", unit.factor, plot::Signal::completed));
    }
    panels.push_back(time_panel(facts, prediction.title, fmt::format("[{}]", unit.unit), std::move(lines)));
    panels.back().x.high.reset();  // the time of the recording, which may be another test
    panels.back().marks.clear();
  }
  return figure_of(std::move(panels));
}

}  // namespace

std::string verdict_part(const ReportFacts& facts) {
  constexpr std::array<std::string_view, 3> kClasses{"good", "fair", "bad"};
  constexpr std::array<std::string_view, 3> kSigns{"✓", "!", "✗"};
  const auto standing = static_cast<std::size_t>(standing_of(facts.summary));
  std::string words = verdict(facts.summary);
  if (!words.empty()) words[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(words[0])));
  std::vector<std::string> advice = advice_for(facts.summary);
  for (const std::string& unread : facts.run.unread) advice.push_back("Not read: " + unread + ".");
  return fmt::format("<p class=\"verdict {}\">{} {}</p>\n<p>{}</p>\n", kClasses[standing], kSigns[standing],
                     escaped(words), escaped(steps_text(facts.summary))) +
         list_of(advice) + peaks_of(facts.summary);
}

std::string comparison_part(const ReportFacts& facts) {
  std::string html;
  for (const Compared& other : facts.others) {
    html += fmt::format("<h3>{}</h3>\n<p class=\"fine\">This run against {}.</p>\n", escaped(other.label),
                        escaped(other.what));
    Rows rows;
    for (const Difference& difference : other.differences) {
      const ShownUnit unit = shown_unit(difference.unit);
      rows.push_back({difference.signal, std::string{unit.unit}, number_text(unit.factor * difference.peak, 4),
                      number_text(unit.factor * difference.other_peak, 4), percent_text(difference.rms_relative),
                      percent_text(difference.peak_relative)});
    }
    html += table_if_any({"signal", "unit", "peak here", "peak there", "RMS difference [%]", "largest difference [%]"},
                         rows);
    html += prediction_figures(facts, other);
    if (!other.scenario_differences.empty()) {
      html += "<p>The scenarios differ:</p>\n" + list_of(other.scenario_differences);
    }
  }
  if (!html.empty()) {
    html +=
        "<p class=\"fine\">Differences at the times of this run; RMS over the RMS there, largest over the peak "
        "there.</p>\n";
  }
  return section("comparison", "Compared with", html);
}

std::string events_part(const ReportFacts& facts) {
  Rows rows;
  for (const RecordedEvent& recorded : facts.run.events) {
    if (rows.size() == kEventsShown) break;
    const Event& event = recorded.event;
    rows.push_back({number_text(event.model_time_s), event.step == kNoStep ? "–" : std::to_string(event.step),
                    event.source.text(), severity_text(event.severity), recorded.text});
  }
  if (rows.empty()) return "";
  std::string html = plot::scrolling(plot::html_table({"model time [s]", "step", "from", "severity", "what"}, rows));
  if (facts.run.events.size() > kEventsShown) {
    html += fmt::format("<p class=\"fine\">The first {} of {} events; all are in the recordings.</p>\n", kEventsShown,
                        facts.run.events.size());
  }
  return section("events", "Events", html);
}

std::string scenario_part(const ReportFacts& facts) {
  if (!facts.run.scenario) {
    return section(
        "scenario", "Scenario",
        fmt::format("<p class=\"fine\">The scenario is not shown: {}. Figures that need it are left out.</p>\n",
                    escaped(facts.run.why_no_scenario)));
  }
  const std::string& effective = facts.run.scenario->effective;
  std::string html;
  std::vector<DiffLine> lines =
      line_differences(facts.shipped_scenario.empty() ? effective : facts.shipped_scenario, effective);
  const auto differing =
      std::ranges::count_if(lines, [](const DiffLine& line) { return line.kind != DiffLine::Kind::same; });
  if (facts.shipped_scenario.empty()) {
    html = "<p>No shipped scenario has this name. All values, with defaults filled in:</p>\n";
  } else if (differing == 0) {
    html = "<p>As it ships. All values, with defaults filled in:</p>\n";
  } else {
    html = "<p>It differs from the shipped scenario of this name: <del>shipped</del>, <ins>here</ins>.</p>\n";
    for (const DiffLine& line : scenario_differences(facts.shipped_scenario, effective)) {
      const std::string_view tag = line.kind == DiffLine::Kind::removed ? "del" : "ins";
      html += fmt::format("<p class=\"change\"><{0}>{1}</{0}></p>\n", tag, escaped(line.text));
    }
  }
  html += "<details open>\n<summary>scenario.yaml</summary>\n<pre class=\"scenario\" tabindex=\"0\">";
  for (const DiffLine& line : lines) {
    const std::string text = escaped(line.text);
    html += line.kind == DiffLine::Kind::same      ? text
            : line.kind == DiffLine::Kind::removed ? "<del>" + text + "</del>"
                                                   : "<ins>" + text + "</ins>";
    html += '\n';
  }
  return section("scenario", "Scenario", html + "</pre>\n</details>\n");
}

std::string files_part(const ReportFacts& facts) {
  Rows rows;
  for (const ParticipantFileSummary& file : facts.summary.participants) {
    std::error_code absent;
    const std::uintmax_t bytes =
        file.file.empty() ? 0 : std::filesystem::file_size(facts.run.directory / file.file, absent);
    const std::string state = file.file.empty()      ? "✗ no file"
                              : file.write_failed    ? "✗ writing failed"
                              : !file.closed_cleanly ? "✗ not closed: its process was killed"
                                                     : "✓ closed";
    rows.push_back({file.participant, file.file.empty() ? "–" : file.file, absent ? "–" : bytes_text(bytes), state,
                    std::to_string(file.dropped_rows), std::to_string(file.missing_steps)});
  }
  std::string html = rows.empty()
                         ? ""
                         : plot::scrolling(plot::html_table(
                               {"participant", "file", "size", "state", "dropped rows", "missing steps"}, rows));
  const auto fact = [&](std::string_view name, const std::string& value) {
    if (!value.empty()) html += fmt::format("<p class=\"fine\">{}: <code>{}</code></p>\n", name, escaped(value));
  };
  fact("software", facts.summary.software_version);
  fact("scenario digest (SHA-256)", facts.summary.scenario_digest);
  fact("run directory", facts.run.directory.filename().string());
  return section("files", "Versions and files", html);
}

}  // namespace hybridtest::run_report
