#include "report/run_report/run_report.hpp"

#include <fmt/format.h>

#include <fstream>
#include <system_error>

#include "recording/error.hpp"
#include "report/plotting/page.hpp"
#include "report/plotting/svg_canvas.hpp"
#include "report/run_report/report_parts.hpp"

namespace hybridtest {
namespace {

using namespace run_report;

/// Beside the style of all pages.
constexpr std::string_view kReportStyle = R"css(
nav { display: flex; flex-wrap: wrap; gap: 4px 16px; font-size: 13px; margin: 4px 0 12px; }
.scenario { font: 12px/1.4 'DejaVu Sans Mono', monospace; background: var(--panel); padding: 10px 14px; overflow-x: auto; }
del { color: var(--bad); } ins { color: var(--good); text-decoration: underline; }
.change { margin: 2px 0; font-size: 14px; }
)css";

/// The sections that the page has, by their anchors.
std::string navigation(const std::string& body) {
  std::string html = "<nav aria-label=\"Sections\">\n";
  const std::string begin = "<section id=\"";
  for (std::size_t at = body.find(begin); at != std::string::npos; at = body.find(begin, at + 1)) {
    const std::size_t id = at + begin.size();
    const std::size_t heading = body.find("<h2>", id) + 4;
    html += fmt::format("<a href=\"#{}\">{}</a>\n", body.substr(id, body.find('"', id) - id),
                        body.substr(heading, body.find("</h2>", heading) - heading));
  }
  return html + "</nav>\n";
}

}  // namespace

std::string report_page(const ReportRequest& request, const RunSummary& summary) {
  const RunRecord run = read_run_record(request.run);
  std::vector<Compared> others = references_of(run);
  for (const std::filesystem::path& other : request.compare) others.push_back(read_compared(other, run));
  const ReportFacts facts{summary, run, others, request.shipped_scenario};
  std::string body = comparison_part(facts) + structure_part(facts);
  for (const SubstructureRecord& substructure : run.substructures) body += substructure_part(facts, substructure);
  body += spectra_part(facts) + timing_part(facts) + events_part(facts) + scenario_part(facts) + files_part(facts);
  const std::string name = summary.test_name.empty() ? "a test" : summary.test_name;
  return plot::page_head("Report of " + name, kReportStyle) + "<main>\n<h1>" + plot::escaped(name) + "</h1>\n" +
         navigation(body) + verdict_part(facts) + body + "</main>\n" + plot::page_end();
}

void write_report(const ReportRequest& request, const RunSummary& summary, const std::filesystem::path& file) {
  const std::string page = report_page(request, summary);
  std::ofstream stream{file, std::ios::binary};
  stream << page;
  stream.close();
  if (stream) return;
  std::error_code ignored;
  // Half a page would look like a whole one.
  if (std::filesystem::is_regular_file(file, ignored)) std::filesystem::remove(file, ignored);
  throw RecordingError{file.string() + ": cannot be written; check the folder and the disk"};
}

}  // namespace hybridtest
