#include "scenario/catalogue/effects_text.hpp"

#include <cmath>

#include "core/text/scalar.hpp"
#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"
#include "scenario/catalogue/parameter_table.hpp"

namespace hybridtest {
namespace {

std::string text(std::string_view words) { return std::string{words}; }

/// `0 to 10`, without ends that only sense bounds.
std::string values_of(const EffectParameter& parameter) {
  const bool has_low = parameter.low > -kUnbounded;
  const bool has_high = parameter.high < kUnbounded;
  if (!has_low && !has_high) return "any";
  if (!has_high) return "from " + written_number(parameter.low);
  if (!has_low) return "up to " + written_number(parameter.high);
  return written_number(parameter.low) + " to " + written_number(parameter.high);
}

std::string default_of(const EffectParameter& parameter) {
  return std::isnan(parameter.fallback) ? "—" : written_number(parameter.fallback);
}

}  // namespace

std::string effects_text() {
  std::string out;
  for (const EffectType& type : effect_library()) {
    out += text(name_of(type.interface)) + " " + text(type.name) + "\n";
    out += "    " + text(type.equation) + "   [" + text(type.source) + "]\n";
    for (const EffectParameter& parameter : type.parameters) {
      out += "    " + text(parameter.name) + ": " + text(parameter.what) + "; " + values_of(parameter) +
             (parameter.unit.empty() ? "" : " " + text(parameter.unit));
      if (!std::isnan(parameter.fallback)) out += ", default " + default_of(parameter);
      out += "\n";
    }
  }
  return out;
}

std::string effects_markdown() {
  std::string out;
  std::string_view interface;
  for (const EffectType& type : effect_library()) {
    if (name_of(type.interface) != interface) {
      interface = name_of(type.interface);
      out += "\n| `" + text(interface) + "` | equation, source | key | unit | what | values | default |\n";
      out += "| --- | --- | --- | --- | --- | --- | --- |\n";
    }
    std::string first = "`" + text(type.name) + "` | " + cell(type.equation) + "; " + cell(type.source);
    for (const EffectParameter& parameter : type.parameters) {
      out += "| " + first + " | `" + text(parameter.name) + "` | " + text(parameter.unit) + " | " +
             cell(parameter.what) + " | " + values_of(parameter) + " | " + default_of(parameter) + " |\n";
      first = " | ";
    }
  }
  return out;
}

}  // namespace hybridtest
