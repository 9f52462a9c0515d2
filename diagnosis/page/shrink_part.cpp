#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/page/page_parts.hpp"
#include "diagnosis/page/wording.hpp"
#include "report/plotting/svg_canvas.hpp"

namespace hybridtest::report {
namespace {

using plot::escaped;

/// A stack over the whole gap's energy: removed, left and unknown, floor.
std::string energy_bar(const Shrink& shrink) {
  const double before = shrink.nrmse_before * shrink.nrmse_before;
  const double floor = before > 0.0 ? std::min(1.0, shrink.floor_nrmse * shrink.floor_nrmse / before) : 0.0;
  const double removed = std::clamp(shrink.variance_removed, 0.0, 1.0 - floor);
  const double unknown = std::clamp(shrink.unknown_share, 0.0, 1.0 - floor - removed);
  const double other = 1.0 - floor - removed - unknown;
  std::string html = "<div class=\"stack\">";
  std::string legend = "<p class=\"key\">";
  const auto piece = [&](double share, std::string_view name, std::string_view text) {
    if (share < 0.0005) return;
    html += fmt::format("<i class=\"{}\" style=\"width:{:.2f}%\"></i>", name, 100.0 * share);
    legend += fmt::format("<span><i class=\"{}\"></i>{} {}</span>", name, percent(share), text);
  };
  piece(removed, "removed", "removed by the cause");
  piece(unknown, "unknown", "repeatable, unexplained");
  piece(other, "other", "not explained, not known to be repeatable");
  piece(floor, "floor", "floor: no model could remove it");
  return html + "</div>" + legend + "</p>\n";
}

std::string before_after(std::string_view what, double before, double after) {
  const double widest = std::max({before, after, 1e-12});
  return fmt::format(
      "<tr><th>{}</th><td>{}</td><td class=\"wide\"><span class=\"bar before\"><i style=\"width:{:.1f}%\"></i></span>"
      "<span class=\"bar after\"><i style=\"width:{:.1f}%\"></i></span></td><td>{}</td></tr>\n",
      what, percent(before), 100.0 * before / widest, 100.0 * after / widest, percent(after));
}

std::string response_rows(const ResponseShrink& response) {
  std::string rows = before_after("response of the whole test, error", response.nrmse_before, response.nrmse_after) +
                     before_after("response, peak error", response.peak_error_before, response.peak_error_after);
  if (response.energy_error_before && response.energy_error_after) {
    rows += before_after("response, energy error", *response.energy_error_before, *response.energy_error_after);
  }
  return rows;
}

}  // namespace

std::string shrink_part(const DiagnosisReport& report) {
  if (!report.interface_shrink) return "";
  const Shrink& shrink = *report.interface_shrink;
  const bool is_held_out = std::ranges::any_of(
      report.recordings, [](const ReportedRecording& recording) { return recording.role == RecordingRole::held_out; });
  std::string html = "<h2>How far the gap shrinks</h2>\n<p>Energy of the gap ";
  html += is_held_out ? "on recordings that were not used to find the cause: "
                      : "on the recordings of the fit themselves, since none was held out: ";
  html += fmt::format("<b>{}</b> removed", percent(shrink.variance_removed));
  if (shrink.ci95) html += fmt::format(" (95 %: {})", between_percent(*shrink.ci95));
  if (shrink.explainable_fraction)
    html += fmt::format(", {} of what any model could remove", percent(*shrink.explainable_fraction));
  html += ".</p>\n" + energy_bar(shrink);
  html += "<table class=\"shrink\"><tr><th></th><th>before</th><th></th><th>after</th></tr>\n";
  html += before_after("at the interface, error", shrink.nrmse_before, shrink.nrmse_after);
  if (report.response_shrink) html += response_rows(*report.response_shrink);
  html += "</table>\n<p class=\"fine\">Errors are root mean squares over that of the measured signal.";
  if (!report.response_shrink && !report.why_no_response.empty()) {
    html += " Response of the whole test: " + escaped(report.why_no_response) + ".";
  }
  return html + "</p>\n";
}

}  // namespace hybridtest::report
