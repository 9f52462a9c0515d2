#include "diagnosis/page/diagnosis_page.hpp"

#include <fmt/format.h>

#include "diagnosis/page/page_parts.hpp"
#include "diagnosis/page/wording.hpp"
#include "report/plotting/svg_canvas.hpp"

namespace hybridtest::report {
namespace {

/// Figures are drawn on white; where the reader's system is dark they are turned over as a whole.
constexpr std::string_view kStyle = R"css(
:root { --ground: #fff; --ink: #222; --soft: #666; --line: #d0d0d0; --panel: #f6f6f6; --bad: #b3261e; --badsoft: #fdecea;
  --good: #1b7f4b; --blue: #0072b2; --orange: #d55e00; --grey: #b5b5b5; }
@media (prefers-color-scheme: dark) { :root { --ground: #191919; --ink: #e4e4e4; --soft: #a5a5a5; --line: #444;
  --panel: #242424; --bad: #ff8a80; --badsoft: #40201e; --good: #6fd39b; --blue: #56b4e9; --orange: #ff9e57; --grey: #777; }
  svg { filter: invert(0.9) hue-rotate(180deg); } }
body { font: 15px/1.45 'DejaVu Sans', Verdana, sans-serif; color: var(--ink); background: var(--ground);
  max-width: 1180px; margin: 24px auto; padding: 0 18px; }
h1 { font-size: 17px; font-weight: normal; color: var(--soft); margin: 0; }
h2 { font-size: 17px; margin: 34px 0 8px; }
svg { width: 100%; height: auto; display: block; margin: 6px 0; }
small, .fine { color: var(--soft); font-size: 13px; }
.verdict { font-size: 22px; line-height: 1.35; margin: 8px 0 20px; padding: 14px 18px; background: var(--panel);
  border-left: 6px solid var(--bad); }
.verdict.none { border-color: var(--good); } .verdict.not_excited, .verdict.unknown { border-color: var(--orange); }
.pair { display: grid; grid-template-columns: repeat(auto-fit, minmax(420px, 1fr)); gap: 0 20px; max-width: 1180px; }
.pair svg:only-child { max-width: 640px; }
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
.other { background: repeating-linear-gradient(45deg, var(--orange) 0 3px, transparent 3px 7px); }
.key span { margin-right: 20px; white-space: nowrap; } .key i { display: inline-block; width: 13px; height: 13px;
  margin-right: 6px; vertical-align: -1px; }
table { border-collapse: collapse; margin: 8px 0; } td, th { text-align: left; padding: 5px 14px 5px 0; vertical-align: top;
  font-size: 14px; border-bottom: 1px solid var(--line); font-weight: normal; }
tr:first-child > th { color: var(--soft); font-size: 13px; }
td small { display: block; } td .par { display: block; } td .par small { display: inline; }
.eq { font-family: 'DejaVu Sans Mono', monospace; font-size: 12px; }
.causes { width: 100%; } .cause td { background: var(--panel); } .causes td:first-child { padding-left: 8px; }
.prob { min-width: 100px; } .shrink { width: 100%; } .wide { width: 45%; }
.warn, .note { color: var(--bad); } .note { font-size: 14px; }
.next { padding: 10px 14px; border: 1.5px solid var(--blue); border-radius: 6px; }
.scroll { overflow-x: auto; } code { font-size: 11.5px; overflow-wrap: anywhere; }
@media print { .verdict, .chain li, svg { break-inside: avoid; } }
)css";

std::string head(const DiagnosisReport& report) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<title>Diagnosis: "
      "{}</title>\n<style>{}</style>\n</head>\n<body>\n",
      plot::escaped(report.site), kStyle);
}

}  // namespace

std::string diagnosis_page(const DiagnosisReport& report) {
  return head(report) +
         fmt::format("<h1>Where model and test of {} disagree, and why</h1>\n<p class=\"verdict {}\">{}</p>\n",
                     plot::escaped(report.site), name_of(report.verdict), plot::escaped(verdict_sentence(report))) +
         chain_part(report) + shrink_part(report) + causes_part(report) + curves_part(report) + location_part(report) +
         sensors_part(report) + facts_part(report) + "</body>\n</html>\n";
}

}  // namespace hybridtest::report
