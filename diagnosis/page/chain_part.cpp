#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "diagnosis/page/page_parts.hpp"
#include "diagnosis/page/wording.hpp"
#include "report/plotting/svg_canvas.hpp"

namespace hybridtest::report {
namespace {

using plot::escaped;

/// In the order in which a signal passes them.
constexpr std::array<std::string_view, 7> kChain{"numerical_substructure", "network",  "compensator", "transfer_system",
                                                 "displacement_sensor",    "specimen", "force_sensor"};

std::string judged_link(const InterfaceGap& gap, bool is_main) {
  const std::string_view state = !gap.is_at_fault ? "clean" : is_main ? "fault main" : "fault";
  return fmt::format(
      "<li class=\"{}\"><b>{}</b><small>{}</small><strong>{}</strong><small>of the gap, {}</small>"
      "<span class=\"bar\"><i style=\"width:{:.1f}%\"></i></span><em>{}</em></li>\n",
      state, escaped(plain(gap.interface)), sees(gap.interface), percent(gap.share), between_percent(gap.share_ci95),
      100.0 * std::clamp(gap.share, 0.0, 1.0),
      is_main           ? "✗ the gap is here"
      : gap.is_at_fault ? "above its floor"
                        : "✓ within its floor");
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
      html += unjudged_link(interface, "nothing in the recordings tells");
    } else if (!gap->is_judged) {
      html += unjudged_link(interface, gap->why_not);
    } else {
      html += judged_link(*gap, &*gap == main_fault(report));
    }
  }
  return html + "</ol>\n";
}

}  // namespace hybridtest::report
