#include "scenario/catalogue/effects.hpp"

#include <cmath>

#include "core/text/indented.hpp"
#include "core/text/scalar.hpp"
#include "plant/effects/recorded_input.hpp"
#include "scenario/catalogue/formula.hpp"

namespace hybridtest {
namespace {

using config::Section;

std::optional<double> fallback_of(const EffectParameter& parameter) {
  if (std::isnan(parameter.fallback)) return std::nullopt;
  return parameter.fallback;
}

/// In the place of an effect's name: a force that the entry writes out.
constexpr std::string_view kFormula = "formula";

std::vector<std::string> effect_names(EffectInterface interface) {
  std::vector<std::string> names;
  for (const EffectType& type : effect_library()) {
    if (type.interface == interface) names.emplace_back(type.name);
  }
  if (interface == EffectInterface::specimen) names.emplace_back(kFormula);
  return names;
}

EffectSetting read_formula_with_numbers(Section& section) {
  EffectSetting setting;
  setting.type = &read_formula(section, [&](Section& numbers, const std::string& name) {
    setting.values.push_back(numbers.number(name, {.low = -kUnbounded, .high = kUnbounded}));
    return FormulaNumber{.name = name};
  });
  // What could not be read has none.
  setting.values.resize(setting.type->formula->numbers.size());
  if (section.has("input")) {
    const double nominal = section.number(kNominalInput.name, {.low = kNominalInput.low, .high = kNominalInput.high});
    if (!setting.type->input.empty()) setting.values.push_back(nominal);
  }
  return setting;
}

/// The type that follows the input that the section names.
const EffectType* following_input(const EffectType& type, Section& section) {
  const std::string input = section.text("input");
  if (is_input_name(input)) return &with_input(type, input);
  section.error("input", "'" + input +
                             "' is no name of a recorded input; expected lower-case letters, digits and '_', a letter "
                             "first, such as current_a for the column input_current_a");
  return &type;
}

EffectSetting read_numbers(const EffectType& type, Section& section) {
  EffectSetting setting{.type = type.traits.takes_input ? following_input(type, section) : &type, .values = {}};
  for (const EffectParameter& parameter : type.parameters) {
    setting.values.push_back(
        section.number(parameter.name, {.low = parameter.low, .high = parameter.high}, fallback_of(parameter)));
  }
  return setting;
}

ListedEffect read_effect(Section section, const std::vector<EffectInterface>& interfaces, int dofs) {
  std::vector<std::string> interface_names;
  for (const EffectInterface interface : interfaces) interface_names.emplace_back(name_of(interface));
  const EffectInterface interface = interfaces[section.choice("interface", interface_names)];
  const std::vector<std::string> names = effect_names(interface);
  ListedEffect effect;
  const std::string& name = names[section.choice("effect", names)];
  if (name == kFormula) {
    effect.setting = read_formula_with_numbers(section);
  } else {
    effect.setting = read_numbers(*find_effect(interface, name), section);
  }
  if (dofs > 0 && section.has_optional("dof")) effect.dof = static_cast<int>(section.integer("dof", 1, dofs)) - 1;
  section.finish();
  return effect;
}

}  // namespace

std::vector<ListedEffect> read_effects(Section& section, const std::vector<EffectInterface>& interfaces, int dofs) {
  std::vector<ListedEffect> effects;
  if (!section.has_optional("effects")) return effects;
  for (const Section& entry : section.sections("effects", true)) {
    effects.push_back(read_effect(entry, interfaces, dofs));
  }
  return effects;
}

const std::vector<EffectInterface>& site_interfaces() {
  using enum EffectInterface;
  static const std::vector<EffectInterface> interfaces{network,  compensator, transfer_system, displacement_sensor,
                                                       specimen, force_sensor};
  return interfaces;
}

std::string written_effect(const ListedEffect& effect) {
  const EffectType& type = *effect.setting.type;
  std::string text = "  - interface: " + std::string{name_of(type.interface)} + "\n";
  text += "    effect: " + std::string{type.formula != nullptr ? kFormula : type.name} + "\n";
  if (type.formula != nullptr) {
    text += indented(written_formula(*type.formula, effect.setting.values), "    ", "    ");
  } else {
    if (!type.input.empty()) text += "    input: " + std::string{type.input} + "\n";
    for (std::size_t i = 0; i < type.parameters.size(); ++i) {
      text += "    " + std::string{type.parameters[i].name} + ": " + written_number(effect.setting.values[i]) + "\n";
    }
  }
  if (effect.dof) text += "    dof: " + std::to_string(*effect.dof + 1) + "\n";
  return text;
}

}  // namespace hybridtest
