#include <fmt/format.h>

#include "diagnosis/page/page_parts.hpp"
#include "diagnosis/page/wording.hpp"
#include "report/plotting/svg_canvas.hpp"

namespace hybridtest::report {
namespace {

using plot::escaped;

/// More of a recording at the very extremes is no chance.
constexpr double kClipped = 0.001;

std::string rest_text(const SensorFacts& facts) {
  if (!facts.at_rest) return "no rest";
  const RestFacts& rest = *facts.at_rest;
  return fmt::format("{} first, {} last; noise {}", quantity(rest.first, facts.unit), quantity(rest.last, facts.unit),
                     quantity(rest.rms, facts.unit));
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
      "<h2>What the sensors tell of themselves</h2>\n<div class=\"scroll\"><table><tr><th>channel</th><th>smallest "
      "step</th><th>unchanged samples</th><th>at an end of its range</th><th>at rest</th><th>behind the "
      "displacement</th></tr>\n";
  for (const SensorFacts& facts : report.sensors) html += row(facts);
  return html +
         "</table></div>\n<p class=\"fine\">At an end: samples that sit, three or more in a row, at the very extremes. "
         "Behind the displacement: the lag at which the changes of force and displacement go together best; a "
         "specimen that resists with velocity or mass leads or lags by itself.</p>\n";
}

}  // namespace hybridtest::report
