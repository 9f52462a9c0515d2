#include "scenario/catalogue/numerical_effects.hpp"

#include <string_view>

#include "scenario/catalogue/effects.hpp"

namespace hybridtest {

NumericalErrors read_numerical_errors(config::Section& scenario) {
  NumericalErrors errors;
  for (const ListedEffect& effect : read_effects(scenario, {EffectInterface::numerical_substructure}, 0)) {
    const std::string_view name = effect.setting.type->name;
    const double factor = 1.0 + effect.setting.values[0];
    if (name == "mass_error") errors.mass *= factor;
    if (name == "stiffness_error") errors.stiffness *= factor;
    if (name == "damping_error") errors.damping *= factor;
    if (name == "step_mismatch") errors.step *= factor;
  }
  return errors;
}

}  // namespace hybridtest
