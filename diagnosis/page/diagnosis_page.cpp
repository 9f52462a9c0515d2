#include "diagnosis/page/diagnosis_page.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>

#include "diagnosis/page/page_parts.hpp"
#include "diagnosis/page/wording.hpp"
#include "report/plotting/page.hpp"
#include "report/plotting/svg_canvas.hpp"

namespace hybridtest::report {

namespace {

using plot::escaped;

/// In the order of the signal flow.
constexpr std::array<std::string_view, 7> kChain{"numerical_substructure", "network",  "compensator", "transfer_system",
                                                 "displacement_sensor",    "specimen", "force_sensor"};

std::string judged_link(const InterfaceGap& gap, bool is_main) {
  const std::string_view state = !gap.is_at_fault ? "clean" : is_main ? "fault main" : "fault";
  return fmt::format(
      "<li class=\"{}\"><b>{}</b><small>{}</small><strong>{}</strong><small>of the gap, {}</small>"
      "<span class=\"bar\"><i style=\"width:{:.1f}%\"></i></span><em>{}</em></li>\n",
      state, escaped(plain(gap.interface)), sees(gap.interface), percent(gap.share), between_percent(gap.share_ci95),
      100.0 * std::clamp(gap.share, 0.0, 1.0),
      is_main            ? "✗ main fault"
      : gap.is_at_fault  ? "above its noise floor"
      : gap.is_corrected ? "✓ numbers slightly off"
                         : "✓ within its noise floor");
}

std::string unjudged_link(std::string_view interface, const std::string& why) {
  return fmt::format(
      "<li class=\"unjudged\"><b>{}</b><small>{}</small><strong>?</strong><em>not judged</em><small>{}</small></li>\n",
      plain(interface), sees(interface), escaped(why));
}

}  // namespace

std::string chain_part(const DiagnosisReport& report) {
  std::string html = "<ol class=\"chain\">\n";
  for (const std::string_view interface : kChain) {
    const auto gap = std::ranges::find(report.where, interface, &InterfaceGap::interface);
    if (gap == report.where.end()) {
      html += unjudged_link(interface, "no recorded channel shows it");
    } else if (!gap->is_judged) {
      html += unjudged_link(interface, gap->why_not);
    } else {
      html += judged_link(*gap, &*gap == main_fault(report));
    }
  }
  return html + "</ol>\n";
}

namespace {

using plot::escaped;

constexpr std::size_t kRowsMax = 12;

std::string parameter_text(const ReportedParameter& parameter) {
  std::string text =
      fmt::format("<span class=\"par\">{} <b>{}</b>", escaped(plain_parameter(parameter.name, parameter.unit)),
                  escaped(quantity(parameter.value, parameter.unit)));
  if (parameter.ci95) text += fmt::format(" <small>({})</small>", escaped(between(*parameter.ci95, parameter.unit)));
  if (is_corrected(parameter)) {
    text += fmt::format(" <small>instead of {}</small>", escaped(quantity(*parameter.in_model, parameter.unit)));
  }
  if (parameter.is_at_least) {
    text += " <small>or more: these recordings do not show how much</small>";
  } else if (parameter.is_at_bound) {
    text += " <small class=\"warn\">at the limit of its search range</small>";
  }
  return text + "</span>";
}

/// With the law that stands in place of the specimen's.
std::string name_of(const RankedCause& cause) {
  const std::string& detail = cause.law.empty() ? cause.input : cause.law;
  return plain(cause.effect) + (detail.empty() ? "" : ": " + (cause.law.empty() ? detail : plain(detail)));
}

/// No number of these recordings makes sure.
std::string probability_text(double probability) {
  constexpr double kMostShown = 0.999;
  return probability > kMostShown ? "over " + percent(kMostShown) : percent(probability);
}

std::string row(const RankedCause& cause) {
  std::string parameters;
  for (const ReportedParameter& parameter : cause.parameters) parameters += parameter_text(parameter);
  const std::string_view standing = cause.is_cause ? "cause" : cause.is_indistinguishable ? "not distinguishable" : "";
  return fmt::format(
      "<tr class=\"{}\"><td><b>{}</b><small>{}</small><small class=\"eq\">{}</small></td>"
      "<td class=\"prob\">{}<span class=\"bar\"><i "
      "style=\"width:{:.1f}%\"></i></span></td><td>{}</td><td>{}</td></tr>\n",
      cause.is_cause ? "cause" : "", escaped(name_of(cause)), escaped("at the " + plain(cause.interface)),
      escaped(cause.equation), probability_text(cause.probability), 100.0 * std::clamp(cause.probability, 0.0, 1.0),
      parameters, standing);
}

/// The causes and the effects that cannot be distinguished from them; empty when there is no such effect.
std::string alike_text(const DiagnosisReport& report) {
  const bool is_open =
      report.verdict == Verdict::set || std::ranges::any_of(report.ranking, &RankedCause::is_indistinguishable);
  if (!is_open || indistinguishable(report).size() < 2) return "";
  return fmt::format("<p>These recordings cannot distinguish {}.</p>\n", escaped(alternatives_in_words(report)));
}

}  // namespace

std::string causes_part(const DiagnosisReport& report) {
  std::string html;
  if (!report.ranking.empty()) {
    html +=
        "<h2>Effects that explain the gap</h2>\n<div class=\"scroll\" tabindex=\"0\"><table "
        "class=\"causes\"><tr><th>effect</th><th>probability</th><th>parameters (95 "
        "%)</th>"
        "<th></th></tr>\n";
    for (std::size_t i = 0; i < std::min(kRowsMax, report.ranking.size()); ++i) html += row(report.ranking[i]);
    html += "</table></div>\n";
    if (report.ranking.size() > kRowsMax) {
      html += fmt::format("<p class=\"fine\">diagnosis.json lists {} more.</p>\n", report.ranking.size() - kRowsMax);
    }
  }
  html += alike_text(report);
  if (!report.corrections.empty()) html += fmt::format("<p>{}</p>\n", escaped(corrections_sentence(report)));
  if (!report.next_experiment.empty()) {
    html += fmt::format("<p class=\"next\"><b>Next experiment:</b> {}</p>\n", escaped(report.next_experiment));
  }
  return html;
}

namespace {

using plot::escaped;

std::string interface_rows(const DiagnosisReport& report) {
  std::string rows;
  for (const InterfaceGap& gap : report.where) {
    if (!gap.is_judged) continue;
    rows += fmt::format("<tr><th>{}</th><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                        escaped(plain(gap.interface)), percent(gap.nrmse), percent(gap.floor_nrmse),
                        gap.repeatability ? percent(gap.repeatability->nrmse) + " (" + gap.repeatability->source + ")"
                                          : "no repetition",
                        percent(gap.share), between_percent(gap.share_ci95));
  }
  return rows;
}

std::string recording_rows(const DiagnosisReport& report) {
  std::string rows;
  for (const ReportedRecording& recording : report.recordings) {
    rows += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td><code>{}</code></td></tr>\n",
                        escaped(recording.file), recording.role == RecordingRole::fit ? "fit" : "held out",
                        recording.is_quasi_static ? "quasi-static" : quantity(recording.duration_s, "s"),
                        recording.is_quasi_static ? "no time" : quantity(recording.sample_period_s, "s"),
                        escaped(recording.sha256));
  }
  return rows;
}

}  // namespace

std::string facts_part(const DiagnosisReport& report) {
  const std::string interfaces = interface_rows(report);
  std::string html = interfaces.empty() && report.notes.empty() ? "" : "<h2>Results by interface</h2>\n";
  if (!interfaces.empty()) {
    html +=
        "<div class=\"scroll\" tabindex=\"0\"><table><tr><th>interface</th><th>gap, NRMSE</th><th>noise "
        "floor</th><th>difference "
        "between "
        "repetitions</th><th>share of the gap</th><th>95 %</th></tr>\n" +
        interfaces + "</table></div>\n";
  }
  for (const std::string& note : report.notes) html += "<p class=\"note\">" + escaped(note) + "</p>\n";
  const std::string of = report.model_part.empty() ? "" : report.model_part + ", in the scenario ";
  html += "<h2>Model and recordings</h2>\n<p>Model: " + escaped(of + report.model_file) +
          "</p>\n<div class=\"scroll\" tabindex=\"0\"><table>";
  html += "<tr><th>recording</th><th>used for</th><th>length</th><th>sample period</th><th>SHA-256</th></tr>\n";
  return html + recording_rows(report) + "</table></div>\n";
}

namespace {

using plot::escaped;

/// A larger share of samples at the extreme values is not chance: the sensor is clipped.
constexpr double kClipped = 0.001;

std::string rest_text(const SensorFacts& facts) {
  if (!facts.at_rest) return "no rest recorded";
  const RestFacts& rest = *facts.at_rest;
  return fmt::format("{} at start, {} at end; noise {}", quantity(rest.first, facts.unit),
                     quantity(rest.last, facts.unit), quantity(rest.rms, facts.unit));
}

std::string row(const SensorFacts& facts) {
  const bool is_clipped = facts.clipped_share > kClipped;
  return fmt::format("<tr><td>{}<small>{}</small></td><td>{}</td><td>{}</td><td{}>{}</td><td>{}</td><td>{}</td></tr>\n",
                     escaped(facts.column), escaped(facts.recording),
                     facts.quantum > 0.0 ? quantity(facts.quantum, facts.unit) : "never changes",
                     percent(facts.repeated_share), is_clipped ? " class=\"warn\"" : "", percent(facts.clipped_share),
                     rest_text(facts), facts.lag_s ? quantity(*facts.lag_s, "s") : "");
}

}  // namespace

std::string sensors_part(const DiagnosisReport& report) {
  if (report.sensors.empty()) return "";
  std::string html =
      "<h2>Sensor checks</h2>\n<div class=\"scroll\" tabindex=\"0\"><table><tr><th>channel</th><th>smallest "
      "step</th><th>unchanged samples</th><th>at the end of the range</th><th>at rest</th><th>lag behind "
      "displacement</th></tr>\n";
  for (const SensorFacts& facts : report.sensors) html += row(facts);
  return html +
         "</table></div>\n<p class=\"fine\">At the end of the range: three or more consecutive samples at the extreme "
         "value. "
         "Lag behind displacement: the lag at which the changes of force and displacement correlate best; a specimen "
         "with damping or mass also leads or lags without any sensor error.</p>\n";
}

namespace {

using plot::escaped;

/// What was added to the model.
std::string_view added(const DiagnosisReport& report) {
  if (report.corrections.empty()) return "the causes";
  return names_a_cause(report.verdict) ? "the causes and corrected numbers" : "the corrected numbers";
}

/// A stacked bar of the energy of the gap: removed, left above the noise floor, and below it.
/// @param by   what removed it.
std::string energy_bar(const Shrink& shrink, std::string_view by) {
  const double before = shrink.nrmse_before * shrink.nrmse_before;
  const double floor = before > 0.0 ? std::min(1.0, shrink.floor_nrmse * shrink.floor_nrmse / before) : 0.0;
  const double removed = std::clamp(shrink.variance_removed, 0.0, 1.0 - floor);
  const double unknown = std::clamp(shrink.unknown_share, 0.0, 1.0 - floor - removed);
  std::string html = "<div class=\"stack\">";
  std::string legend = "<p class=\"key\">";
  const auto piece = [&](double share, std::string_view name, std::string_view text) {
    if (share < 0.0005) return;
    html += fmt::format("<i class=\"{}\" style=\"width:{:.2f}%\"></i>", name, 100.0 * share);
    legend += fmt::format("<span><i class=\"{}\"></i>{} {}</span>", name, percent(share), text);
  };
  piece(removed, "removed", fmt::format("removed by {}", by));
  piece(unknown, "unknown", "not explained, above the noise floor");
  piece(floor, "floor", "noise floor: no model can remove it");
  return html + "</div>" + legend + "</p>\n";
}

std::string before_after(std::string_view what, double before, double after,
                         const std::optional<Interval>& after_ci95 = std::nullopt) {
  const double widest = std::max({before, after, 1e-12});
  return fmt::format(
      "<tr><th>{}</th><td>{}</td><td class=\"wide\"><span class=\"bar before\"><i style=\"width:{:.1f}%\"></i></span>"
      "<span class=\"bar after\"><i style=\"width:{:.1f}%\"></i></span></td><td>{}{}</td></tr>\n",
      what, percent(before), 100.0 * before / widest, 100.0 * after / widest, percent(after),
      after_ci95 ? fmt::format(" (95 %: {})", between_percent(*after_ci95)) : "");
}

/// What of the response is removed, what is unknown, and the floor.
std::string response_sentence(const ResponseShrink& response) {
  if (!response.floor_nrmse || !response.unknown_share) return "";
  std::string html =
      fmt::format("<p>Of the response of the whole test, <b>{}</b> removed", percent(response.variance_removed));
  if (response.ci95) html += fmt::format(" (95 % in a repetition of the test: {})", between_percent(*response.ci95));
  if (response.explainable_fraction) {
    html += fmt::format(", {} of what a perfect model could remove", percent(*response.explainable_fraction));
  }
  return html + fmt::format("; {} is not explained and above the noise floor, NRMSE {}.</p>\n",
                            percent(*response.unknown_share), percent(*response.floor_nrmse));
}

std::string predicted_row(const PredictedNumber& number, std::string_view what, std::string_view unit) {
  const bool is_inside = number.recorded >= number.ci95.low && number.recorded <= number.ci95.high;
  return fmt::format("<tr><th>{}</th><td>{}</td><td>{}</td><td>{}</td><td{}>{}</td></tr>\n", escaped(what),
                     quantity(number.recorded, unit), quantity(number.predicted, unit), between(number.ci95, unit),
                     is_inside ? "" : " class=\"warn\"", is_inside ? "" : "the recorded one lies outside");
}

/// Peaks and energy of the whole test, as the completed model predicts them.
/// @param with   what was added to it.
std::string predicted_table(const ResponseShrink& response, std::string_view with) {
  if (response.peaks.empty()) return "";
  std::string html = fmt::format(
      "<div class=\"scroll\" tabindex=\"0\"><table><tr><th>whole test</th><th>recorded</th><th>predicted with "
      "{}</th><th>95 %</th><th></th></tr>\n",
      with);
  for (const PredictedNumber& peak : response.peaks) html += predicted_row(peak, "peak of " + peak.of, "m");
  if (response.energy_taken) {
    html += predicted_row(*response.energy_taken, "energy taken by the substructures", "J");
  }
  return html + "</table></div>\n";
}

std::string response_rows(const ResponseShrink& response) {
  std::string rows = before_after("response of the whole test, NRMSE", response.nrmse_before, response.nrmse_after,
                                  response.nrmse_after_ci95) +
                     before_after("response, peak error", response.peak_error_before, response.peak_error_after,
                                  response.peak_error_after_ci95);
  if (response.energy_error_before && response.energy_error_after) {
    rows += before_after("response, energy error", *response.energy_error_before, *response.energy_error_after,
                         response.energy_error_after_ci95);
  }
  return rows;
}

}  // namespace

std::string shrink_part(const DiagnosisReport& report) {
  if (!report.interface_shrink) return "";
  const Shrink& shrink = *report.interface_shrink;
  const bool is_held_out = std::ranges::any_of(
      report.recordings, [](const ReportedRecording& recording) { return recording.role == RecordingRole::held_out; });
  std::string html = fmt::format("<h2>Gap before and after adding {}</h2>\n<p>Energy of the gap ", added(report));
  html +=
      is_held_out ? "on the held-out recordings: " : "on the fitted recordings, because no recording was held out: ";
  html += fmt::format("<b>{}</b> removed", percent(shrink.variance_removed));
  if (shrink.ci95) html += fmt::format(" (95 %: {})", between_percent(*shrink.ci95));
  if (shrink.explainable_fraction)
    html += fmt::format(", {} of what a perfect model could remove", percent(*shrink.explainable_fraction));
  html += ".</p>\n" + energy_bar(shrink, added(report));
  if (report.response_shrink) html += response_sentence(*report.response_shrink);
  html +=
      "<div class=\"scroll\" tabindex=\"0\"><table "
      "class=\"shrink\"><tr><th></th><th>before</th><th></th><th>after</th></tr>\n";
  html += before_after("at the interface, NRMSE", shrink.nrmse_before, shrink.nrmse_after);
  if (report.response_shrink) html += response_rows(*report.response_shrink);
  html += "</table></div>\n";
  if (report.response_shrink) html += predicted_table(*report.response_shrink, added(report));
  html += "<p class=\"fine\">NRMSE: root mean square of the gap divided by that of the measured signal.";
  if (!report.response_shrink && !report.why_no_response.empty()) {
    html += " Response of the whole test not compared: " + escaped(report.why_no_response) + ".";
  }
  return html + "</p>\n";
}

namespace {

/// Beside the style of all pages.
constexpr std::string_view kStyle = R"css(
body { max-width: 1180px; }
h1 { font-size: 17px; font-weight: normal; color: var(--soft); margin: 0; }
.verdict.none { border-color: var(--good); } .verdict.not_excited, .verdict.unknown { border-color: var(--orange); }
.pair > :only-child { max-width: 640px; }
.chain { list-style: none; display: flex; flex-wrap: wrap; gap: 10px 20px; padding: 0; }
.chain li { flex: 1 1 118px; max-width: 210px; position: relative; border: 1.5px solid var(--line); border-radius: 6px;
  padding: 8px 9px; display: flex; flex-direction: column; background: var(--panel); }
.chain li + li::before { content: "→"; position: absolute; left: -18px; top: 38%; color: var(--soft); }
.chain b { font-size: 13.5px; } .chain small { font-size: 12px; line-height: 1.3; overflow-wrap: anywhere; }
.chain strong { font-size: 22px; } .chain em { font-style: normal; font-size: 13px; font-weight: bold; color: var(--soft); }
.chain .fault { border-color: var(--bad); } .chain .fault em { color: var(--bad); }
.chain .main { background: var(--badsoft); border-width: 3px; padding: 6.5px 7.5px; }
.chain .clean em { color: var(--good); } .chain .unjudged { border-style: dashed; background: none; color: var(--soft); }
.bar { display: block; height: 8px; background: var(--line); border-radius: 2px; overflow: hidden; margin: 4px 0; }
.bar i { display: block; height: 100%; background: var(--blue); } .fault .bar i, .before i { background: var(--bad); }
.stack { display: flex; height: 26px; border: 1px solid var(--line); margin: 8px 0; }
.stack i { display: block; height: 100%; }
.removed { background: var(--good); } .unknown { background: var(--orange); } .floor { background: var(--grey); }
.key span { margin-right: 20px; white-space: nowrap; } .key i { display: inline-block; width: 13px; height: 13px;
  margin-right: 6px; vertical-align: -1px; }
td small { display: block; } td .par { display: block; } td .par small { display: inline; }
.eq { font-family: 'DejaVu Sans Mono', monospace; font-size: 12px; }
.causes { width: 100%; } .cause td { background: var(--panel); } .causes td:first-child { padding-left: 8px; }
.prob { min-width: 100px; } .shrink { width: 100%; } .wide { width: 45%; }
.warn { color: var(--bad); } .note { font-size: 14px; padding-left: 10px; border-left: 3px solid var(--line); }
.next { padding: 10px 14px; border: 1.5px solid var(--blue); border-radius: 6px; }
@media print { .chain li { break-inside: avoid; } }
)css";

/// When and by what the page was made.
std::string imprint(const DiagnosisReport& report) {
  std::string text;
  if (!report.made_at_utc.empty()) text += "made at " + report.made_at_utc;
  if (!report.made_by.empty()) text += (text.empty() ? "made" : "") + std::string{" by hybridtest "} + report.made_by;
  return text.empty() ? text : "<p class=\"fine\">" + plot::escaped(text) + "</p>\n";
}

}  // namespace

std::string diagnosis_page(const DiagnosisReport& report) {
  return plot::page_head("Diagnosis: " + report.site, kStyle) +
         fmt::format(
             "<h1>Diagnosis of {}: where the test differs from its model, and why</h1>\n<p class=\"verdict "
             "{}\">{}</p>\n",
             plot::escaped(report.site), name_of(report.verdict), plot::escaped(verdict_sentence(report))) +
         imprint(report) + chain_part(report) + shrink_part(report) + causes_part(report) + curves_part(report) +
         location_part(report) + sensors_part(report) + facts_part(report) + plot::page_end();
}

}  // namespace hybridtest::report
