#include "scenario/dampers_beside_law.hpp"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "core/text/indented.hpp"
#include "mechanics/laws/friction.hpp"
#include "plant/effects/effect_type.hpp"
#include "scenario/catalogue/effects.hpp"

namespace hybridtest {
namespace {

using config::Section;

/// The same as a law that is a damper, as an effect; nothing for another law.
std::optional<EffectSetting> damper_of(Section law) {
  const auto effect = [](std::string_view name, std::vector<double> values) {
    return EffectSetting{find_effect(EffectInterface::specimen, name), std::move(values)};
  };
  const std::string type = law.text("type");
  if (type == "friction") {
    const double presliding_m =
        law.number("presliding_displacement_m", kAnyNumber, Friction::Parameters{}.presliding_displacement_m);
    return effect("coulomb_friction", {law.number("friction_force_n"), 0.0, presliding_m, 0.0});
  }
  if (type != "viscous") return {};
  const double damping = law.number("damping_n_s_per_m");
  const double exponent = law.number("exponent", kAnyNumber, 1.0);
  if (exponent == 1.0) return effect("viscous_damping", {damping});
  return effect("nonlinear_viscous_damping", {damping, exponent, 0.0});
}

/// The law's text without its dampers, which are added to the list; empty where nothing is left.
std::string without_dampers(Section law, std::vector<EffectSetting>& dampers) {
  if (std::optional<EffectSetting> damper = damper_of(law)) {
    dampers.push_back(*std::move(damper));
    return {};
  }
  if (law.text("type") != "parallel") return law.effective();
  std::string rest;
  for (const Section& part : law.sections("laws", true)) {
    rest += indented(without_dampers(part, dampers), "  - ", "    ");
  }
  return rest.empty() ? rest : "type: parallel\nlaws:\n" + rest;
}

/// Whether two of them could not both have their numbers free.
bool takes_a_place_twice(const std::vector<EffectSetting>& dampers) {
  return std::ranges::any_of(dampers, [&](const EffectSetting& damper) {
    return damper.type->traits.takes_place && std::ranges::count(dampers, damper.type, &EffectSetting::type) > 1;
  });
}

}  // namespace

std::vector<std::string> dampers_beside_law(Section rig) {
  if (!rig.has("specimen")) return {};
  std::string laws;
  std::string effects;
  const std::vector<Section> sections = rig.sections("specimen", true);
  for (std::size_t dof = 0; dof < sections.size(); ++dof) {
    std::vector<EffectSetting> dampers;
    const std::string rest = without_dampers(sections[dof], dampers);
    if (takes_a_place_twice(dampers)) return {};
    laws += indented(rest.empty() ? "type: none\n" : rest, "  - ", "    ");
    for (const EffectSetting& damper : dampers) {
      const bool is_one_of_many = sections.size() > 1;
      effects += written_effect({damper, is_one_of_many ? std::optional{static_cast<int>(dof)} : std::nullopt});
    }
  }
  if (effects.empty()) return {};
  if (rig.has("effects")) {
    const std::string listed = rig.effective("effects");
    effects = listed.substr(listed.find('\n') + 1) + effects;
  }
  const std::string place = rig.path().empty() ? "" : rig.path() + ".";
  return {place + "specimen=\n" + laws, place + "effects=\n" + effects};
}

}  // namespace hybridtest
