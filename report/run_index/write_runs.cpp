#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "report/plotting/page.hpp"
#include "report/plotting/svg_canvas.hpp"
#include "report/run_index/run_index.hpp"

namespace hybridtest {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr std::string_view kStyle =
    "td.bad { color: var(--bad); font-weight: bold; }\n"
    "td.number { text-align: right; white-space: nowrap; }\n"
    "td.when { white-space: nowrap; }\n";

OrderedJson number(double value) { return std::isfinite(value) ? OrderedJson(value) : OrderedJson(nullptr); }

/// `2026-11-22 10:15:00`
std::string when(const RunEntry& run) {
  if (run.start_time_utc.empty()) return "(time unknown)";
  std::string text = run.start_time_utc.substr(0, 19);
  std::ranges::replace(text, 'T', ' ');
  return text;
}

std::string outcome(const RunEntry& run) {
  if (!run.fault.empty()) return "cannot be read: " + run.fault;
  return run.has_summary ? run.verdict : run.verdict + " (no summary.json: it still runs, or was killed)";
}

std::string peak_text(const Peak& peak) { return fmt::format("{} {:.2f} mm", peak.dof, peak.value * 1e3); }

std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : "; ") + text;
  return all;
}

OrderedJson json(const RunEntry& run) {
  OrderedJson peaks = OrderedJson::array();
  for (const Peak& peak : run.peak_displacement_m) {
    peaks.push_back(
        {{"dof", peak.dof}, {"displacement_m", number(peak.value)}, {"model_time_s", number(peak.model_time_s)}});
  }
  OrderedJson pages = OrderedJson::array();
  for (const auto& page : run.diagnosis_pages) pages.push_back(page.string());
  const bool is_known = run.fault.empty();
  return {{"directory", run.directory.string()},
          {"fault", is_known ? OrderedJson(nullptr) : OrderedJson(run.fault)},
          {"start_time_utc", run.start_time_utc},
          {"scenario", is_known ? OrderedJson(run.test_name) : OrderedJson(nullptr)},
          {"verdict", is_known ? OrderedJson(run.verdict) : OrderedJson(nullptr)},
          {"has_summary", run.has_summary},
          {"exit_code", is_known ? OrderedJson(run.exit_code) : OrderedJson(nullptr)},
          {"data_valid", is_known ? OrderedJson(run.data_valid) : OrderedJson(nullptr)},
          {"peak_displacement", peaks},
          {"diagnoses", run.diagnoses},
          {"report", run.report ? OrderedJson(run.report->string()) : OrderedJson(nullptr)},
          {"diagnosis_pages", pages}};
}

/// A path as a link: every byte that has a meaning in addresses is written as %XX.
std::string link(const std::filesystem::path& target, const std::filesystem::path& from, const std::string& text) {
  std::string address;
  for (const char byte : target.lexically_proximate(from).generic_string()) {
    const auto code = static_cast<unsigned char>(byte);
    const bool is_plain = (code >= 'a' && code <= 'z') || (code >= 'A' && code <= 'Z') ||
                          (code >= '0' && code <= '9') ||
                          std::string_view{"-_.~/"}.find(byte) != std::string_view::npos;
    address += is_plain ? std::string{byte} : fmt::format("%{:02X}", code);
  }
  // "./" keeps a name with a colon from being read as a protocol.
  return fmt::format("<a href=\"./{}\">{}</a>", address, plot::escaped(text));
}

std::string page_row(const RunEntry& run, const std::filesystem::path& folder) {
  const Peak* const peak = run.largest_peak();
  std::string links = run.report ? link(*run.report, folder, "report") : "";
  for (std::size_t i = 0; i < run.diagnosis_pages.size(); ++i) {
    const std::string name = run.diagnosis_pages.size() == 1 ? "diagnosis" : fmt::format("diagnosis {}", i + 1);
    links += (links.empty() ? "" : ", ") + link(run.diagnosis_pages[i], folder, name);
  }
  const auto bad = [](bool is_bad) { return is_bad ? " class=\"bad\"" : ""; };
  return fmt::format(
      "<tr><td class=\"when\">{}</td><td>{}</td><td{}>{}</td><td class=\"number\">{}</td><td{}>{}</td><td>{}</td>"
      "<td>{}</td><td>{}</td></tr>\n",
      plot::escaped(when(run)), plot::escaped(run.test_name), bad(run.failed()), plot::escaped(outcome(run)),
      peak == nullptr ? "" : plot::escaped(peak_text(*peak)), bad(!run.data_valid),
      !run.fault.empty() ? "" : (run.data_valid ? "valid" : "invalid"), plot::escaped(joined(run.diagnoses)), links,
      link(run.directory, folder, run.directory.lexically_proximate(folder).generic_string()));
}

}  // namespace

std::string runs_text(const std::vector<RunEntry>& runs) {
  std::string text;
  for (const RunEntry& run : runs) {
    const std::string name = run.test_name.empty() ? "" : run.test_name + "  ";
    text += fmt::format("{}  {}{}\n    ", when(run), name, outcome(run));
    if (const Peak* const peak = run.largest_peak()) text += fmt::format("peak {}  ", peak_text(*peak));
    if (!run.diagnoses.empty()) text += fmt::format("diagnosis {}  ", joined(run.diagnoses));
    text += run.directory.string() + "\n";
  }
  return text;
}

std::string runs_json(const std::vector<RunEntry>& runs) {
  OrderedJson list = OrderedJson::array();
  for (const RunEntry& run : runs) list.push_back(json(run));
  // Text in a foreign file may not be UTF-8.
  return OrderedJson{{"schema", "hybridtest/runs/1"}, {"runs", list}}.dump(2, ' ', false,
                                                                           OrderedJson::error_handler_t::replace) +
         "\n";
}

std::string runs_page(const std::vector<RunEntry>& runs, const std::filesystem::path& folder) {
  const auto failed = std::ranges::count_if(runs, &RunEntry::failed);
  std::string table =
      "<table>\n<tr><th>start (UTC)</th><th>scenario</th><th>verdict</th><th>largest displacement</th><th>data</th>"
      "<th>diagnosis</th><th>pages</th><th>directory</th></tr>\n";
  for (const RunEntry& run : runs) table += page_row(run, folder);
  return plot::page_head("Runs", kStyle) +
         fmt::format("<main>\n<h1>Runs</h1>\n<p>{} runs, newest first; {} did not complete with valid data.</p>\n",
                     runs.size(), failed) +
         plot::scrolling(table + "</table>\n") + "</main>\n" + plot::page_end();
}

}  // namespace hybridtest
