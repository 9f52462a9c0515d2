#include "experimental_site/rigs/site_model.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "core/config/error.hpp"
#include "core/config/scalar.hpp"

namespace hybridtest {

StageEffects effects_at(const SiteModel& model, EffectInterface interface, double sample_period_s) {
  std::vector<std::unique_ptr<Effect>> made;
  for (const EffectSetting& effect : model.effects) {
    if (effect.type->interface == interface && effect.type->make != nullptr) {
      made.push_back(effect.type->make(effect.values, sample_period_s));
    }
  }
  return StageEffects{std::move(made)};
}

double delay_change_s(const SiteModel& model) {
  const EffectType* const delay = find_effect(EffectInterface::transfer_system, "delay");
  double change_s = 0.0;
  for (const EffectSetting& effect : model.effects) {
    if (effect.type == delay) change_s += std::min(0.0, effect.values[0]);
  }
  if (change_s < -model.removable_delay_s) {
    throw ConfigError{"the effect delay takes " + config::written_number(-change_s) +
                      " s off a transfer system that has " + config::written_number(model.removable_delay_s) +
                      " s of delay; expected no more than it has"};
  }
  return change_s;
}

}  // namespace hybridtest
