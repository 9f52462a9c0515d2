#include <fmt/format.h>

#include <algorithm>

#include "diagnosis/page/page_parts.hpp"
#include "diagnosis/page/wording.hpp"
#include "report/plotting/svg_canvas.hpp"

namespace hybridtest::report {
namespace {

using plot::escaped;

constexpr std::size_t kMostRows = 12;

std::string parameter_text(const ReportedParameter& parameter) {
  std::string text =
      fmt::format("<span class=\"par\">{} <b>{}</b>", escaped(plain_parameter(parameter.name, parameter.unit)),
                  escaped(quantity(parameter.value, parameter.unit)));
  if (parameter.ci95) text += fmt::format(" <small>({})</small>", escaped(between(*parameter.ci95, parameter.unit)));
  if (parameter.is_at_bound) text += " <small class=\"warn\">at the bound of the search</small>";
  return text + "</span>";
}

std::string row(const RankedCause& cause) {
  std::string parameters;
  for (const ReportedParameter& parameter : cause.parameters) parameters += parameter_text(parameter);
  const std::string_view standing = cause.is_cause ? "cause" : cause.is_indistinguishable ? "not told apart" : "";
  return fmt::format(
      "<tr class=\"{}\"><td><b>{}</b><small>{}</small><small class=\"eq\">{}</small></td>"
      "<td class=\"prob\">{}<span class=\"bar\"><i "
      "style=\"width:{:.1f}%\"></i></span></td><td>{}</td><td>{}</td></tr>\n",
      cause.is_cause ? "cause" : "", escaped(plain(cause.effect)), escaped("at the " + plain(cause.interface)),
      escaped(cause.equation), percent(cause.probability), 100.0 * std::clamp(cause.probability, 0.0, 1.0), parameters,
      standing);
}

/// The causes with what cannot be told from them; empty when the causes stand alone.
std::string alike_text(const DiagnosisReport& report) {
  std::vector<std::string> alike;
  for (const RankedCause& cause : report.ranking) {
    if (cause.is_cause || cause.is_indistinguishable) alike.push_back(plain(cause.effect));
  }
  const bool is_open =
      report.verdict == Verdict::set || std::ranges::any_of(report.ranking, &RankedCause::is_indistinguishable);
  if (!is_open || alike.size() < 2) return "";
  return fmt::format("<p>These recordings cannot tell apart {}.</p>\n", escaped(joined(alike)));
}

}  // namespace

std::string causes_part(const DiagnosisReport& report) {
  std::string html;
  if (!report.ranking.empty()) {
    html +=
        "<h2>Which effect</h2>\n<table class=\"causes\"><tr><th>effect</th><th>probability</th><th>parameters (95 "
        "%)</th>"
        "<th></th></tr>\n";
    for (std::size_t i = 0; i < std::min(kMostRows, report.ranking.size()); ++i) html += row(report.ranking[i]);
    html += "</table>\n";
    if (report.ranking.size() > kMostRows) {
      html += fmt::format("<p class=\"fine\">{} more are in diagnosis.json.</p>\n", report.ranking.size() - kMostRows);
    }
  }
  html += alike_text(report);
  if (!report.next_experiment.empty()) {
    html += fmt::format("<p class=\"next\"><b>Next experiment:</b> {}</p>\n", escaped(report.next_experiment));
  }
  return html;
}

}  // namespace hybridtest::report
