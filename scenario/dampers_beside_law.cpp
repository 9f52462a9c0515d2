#include "scenario/dampers_beside_law.hpp"

#include <optional>

#include "core/text/indented.hpp"
#include "plant/effects/effect_type.hpp"
#include "scenario/catalogue/effects.hpp"

namespace hybridtest {
namespace {

using config::Section;

/// The law's text without its fluid dampers, which are added to the list; empty where nothing is left.
std::string without_dampers(Section law, std::vector<EffectSetting>& dampers) {
  const std::string type = law.text("type");
  const double exponent = type == "viscous" ? law.number("exponent", kAnyNumber, 1.0) : 1.0;
  if (exponent != 1.0) {
    const EffectType* const damper = find_effect(EffectInterface::specimen, "nonlinear_viscous_damping");
    dampers.push_back({damper, {law.number("damping_n_s_per_m"), exponent, 0.0}});
    return {};
  }
  if (type != "parallel") return law.effective();
  std::string rest;
  for (const Section& part : law.sections("laws", true)) {
    rest += indented(without_dampers(part, dampers), "  - ", "    ");
  }
  return rest.empty() ? rest : "type: parallel\nlaws:\n" + rest;
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
    if (dampers.size() > 1) return {};
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
