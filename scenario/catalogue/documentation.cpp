#include "scenario/catalogue/documentation.hpp"

#include <cmath>
#include <utility>

#include "compensation/transfer_system_model.hpp"
#include "core/config_error.hpp"
#include "core/text/scalar.hpp"
#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"
#include "scenario/catalogue/compensators.hpp"
#include "scenario/catalogue/delay_estimators.hpp"
#include "scenario/catalogue/force_compensators.hpp"
#include "scenario/catalogue/formula.hpp"
#include "scenario/catalogue/integrators.hpp"
#include "scenario/catalogue/laws.hpp"
#include "scenario/catalogue/parameter_table.hpp"
#include "scenario/catalogue/transfer_systems.hpp"

namespace hybridtest {
namespace {

std::string text(std::string_view words) { return std::string{words}; }

constexpr std::string_view kInputKey =
    "u, the recorded input that it follows: current_a for the column input_current_a";

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
    if (type.traits.takes_input) out += "    input: " + text(kInputKey) + "\n";
    for (const EffectParameter& parameter : type.parameters) {
      out += "    " + text(parameter.name) + ": " + text(parameter.what) + "; " + values_of(parameter) +
             (parameter.unit.empty() ? "" : " " + text(parameter.unit));
      if (!std::isnan(parameter.fallback)) out += ", default " + default_of(parameter);
      out += "\n";
    }
  }
  out += "specimen formula\n    a force that you write yourself   [docs/scenario.md, Formulas]\n    its variables:";
  for (const FormulaVariable& variable : formula_variables()) {
    out += "\n    " + text(variable.name) + ": " + text(variable.what);
  }
  return out + "\n";
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
    if (type.traits.takes_input) out += "| " + first + " | `input` |  | " + text(kInputKey) + " | name | — |\n";
  }
  return out;
}

std::vector<GeneratedPart> generated_parts() {
  ParameterTable plant;
  TransferSystemModel{}.serialize(plant);
  return {{"integrators", table_of(integrators())},
          {"laws", table_of(laws())},
          {"transfer systems", table_of(transfer_systems())},
          {"effects", effects_markdown()},
          {"compensators", table_of(compensators())},
          {"plant", table_head("") + plant.lines("`plant`")},
          {"force compensators", table_of(force_compensators())},
          {"estimators", table_of(delay_estimators())}};
}

std::string with_generated_part(std::string page, const GeneratedPart& part) {
  const std::string begin = "<!-- generated: " + part.name + " -->\n";
  const std::string end = "<!-- end of " + part.name + " -->";
  const std::size_t first = page.find(begin);
  const std::size_t last = first == std::string::npos ? first : page.find(end, first);
  if (last == std::string::npos) throw ConfigError{"the page has no place for the generated part " + part.name};
  const std::size_t from = first + begin.size();
  return page.replace(from, last - from, "\n" + part.text.substr(part.text.starts_with('\n') ? 1 : 0) + "\n");
}

std::string with_generated_parts(std::string page) {
  for (const GeneratedPart& part : generated_parts()) page = with_generated_part(std::move(page), part);
  return page;
}

}  // namespace hybridtest
