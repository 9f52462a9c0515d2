#include <fmt/format.h>

#include "diagnosis/page/page_parts.hpp"
#include "diagnosis/page/wording.hpp"
#include "report/plotting/svg_canvas.hpp"

namespace hybridtest::report {
namespace {

using plot::escaped;

std::string interface_rows(const DiagnosisReport& report) {
  std::string rows;
  for (const InterfaceGap& gap : report.where) {
    if (!gap.is_judged) continue;
    rows += fmt::format("<tr><th>{}</th><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                        escaped(plain(gap.interface)), percent(gap.nrmse), percent(gap.floor_nrmse),
                        gap.repeatability ? percent(gap.repeatability->nrmse) + " (" + gap.repeatability->source + ")"
                                          : "nothing repeats",
                        percent(gap.share), between_percent(gap.share_ci95));
  }
  return rows;
}

std::string recording_rows(const DiagnosisReport& report) {
  std::string rows;
  for (const ReportedRecording& recording : report.recordings) {
    rows += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td><code>{}</code></td></tr>\n",
                        escaped(recording.file), recording.role == RecordingRole::fit ? "fit" : "held out",
                        quantity(recording.duration_s, "s"), quantity(recording.sample_period_s, "s"),
                        escaped(recording.sha256));
  }
  return rows;
}

}  // namespace

std::string facts_part(const DiagnosisReport& report) {
  const std::string interfaces = interface_rows(report);
  std::string html = interfaces.empty() && report.notes.empty() ? "" : "<h2>In figures</h2>\n";
  if (!interfaces.empty()) {
    html +=
        "<table><tr><th>interface</th><th>error</th><th>floor of noise</th><th>what differs when it is "
        "repeated</th><th>share of the gap</th><th>95 %</th></tr>\n" +
        interfaces + "</table>\n";
  }
  for (const std::string& note : report.notes) html += "<p class=\"note\">" + escaped(note) + "</p>\n";
  html += "<h2>What went in</h2>\n<p>Model: " + escaped(report.model_file) + "</p>\n<div class=\"scroll\"><table>";
  html += "<tr><th>recording</th><th>used for</th><th>length</th><th>sample</th><th>SHA-256</th></tr>\n";
  return html + recording_rows(report) + "</table></div>\n";
}

}  // namespace hybridtest::report
