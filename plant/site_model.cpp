#include "plant/site_model.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "core/config_error.hpp"
#include "core/text/scalar.hpp"

namespace hybridtest {

namespace {

const EffectType* setting_mismatch() { return find_effect(EffectInterface::compensator, "setting_mismatch"); }

}  // namespace

const EffectSetting* place_of(const SiteModel& model, const EffectType& type) noexcept {
  if (!type.traits.takes_place) return nullptr;
  const auto last = std::ranges::find(model.effects.rbegin(), model.effects.rend(), &type, &EffectSetting::type);
  return last == model.effects.rend() ? nullptr : &*last;
}

void add_effect(SiteModel& model, const EffectSetting& effect) {
  const EffectSetting* const place = place_of(model, *effect.type);
  if (place == nullptr) {
    model.effects.push_back(effect);
  } else {
    model.effects[static_cast<std::size_t>(place - model.effects.data())] = effect;
  }
}

StageEffects effects_at(const SiteModel& model, EffectInterface interface, double sample_period_s) {
  const EffectType* const in_setting = model.compensator_delay.most_s > 0.0 ? setting_mismatch() : nullptr;
  std::vector<std::unique_ptr<Effect>> made;
  for (const EffectSetting& effect : model.effects) {
    if (effect.type->interface == interface && effect.type->make != nullptr && effect.type != in_setting) {
      made.push_back(effect.type->make(effect.values, sample_period_s));
      const auto input = std::ranges::find(model.inputs, effect.type->input);
      if (input != model.inputs.end()) {
        made.back()->follow_input(static_cast<std::size_t>(input - model.inputs.begin()));
      }
      if (effect.type->traits.follows_stiffness) {
        if (const std::unique_ptr<Law> law = law_of(model))
          made.back()->follow_stiffness(law->initial_stiffness_n_per_m());
      }
    }
  }
  return StageEffects{std::move(made)};
}

std::unique_ptr<Law> law_of(const SiteModel& model) {
  const auto replaced = std::ranges::find_if(model.effects.rbegin(), model.effects.rend(), replaces_law);
  std::unique_ptr<Law> law;
  if (replaced != model.effects.rend()) {
    law = replaced->type->replacement->make(replaced->values);
  } else if (model.make_law) {
    law = model.make_law();
  }
  if (law != nullptr) law->ignore_reversals_within(model.reversal_noise_m);
  return law;
}

namespace {

/// Real bandwidth over that of the model.
double bandwidth_ratio(const SiteModel& model) {
  const EffectType* const error = find_effect(EffectInterface::transfer_system, ModelNumber::bandwidth);
  double ratio = 1.0;
  for (const EffectSetting& effect : model.effects) {
    if (effect.type == error) ratio *= 1.0 + effect.values[0];
  }
  if (ratio != 1.0 && !model.has_bandwidth) {
    throw ConfigError{
        "the effect bandwidth_error changes a transfer system without a bandwidth; expected one of the type "
        "first_order or second_order"};
  }
  return ratio;
}

}  // namespace

std::unique_ptr<TransferSystem> transfer_system_of(const SiteModel& model, double sample_period_s) {
  const double change_s = delay_change_s(model);
  const double ratio = bandwidth_ratio(model);
  // A linear system that is so much faster is the same one, sampled so much more slowly; but for its delay, which is
  // as before, and so that much longer in its time.
  const double longer_s = (ratio - 1.0) * (model.removable_delay_s + change_s);
  return model.make_transfer_system(sample_period_s * ratio, change_s + longer_s);
}

double delay_change_s(const SiteModel& model) {
  const EffectType* const delay = find_effect(EffectInterface::transfer_system, "delay");
  double change_s = 0.0;
  for (const EffectSetting& effect : model.effects) {
    if (effect.type == delay) change_s += std::min(0.0, effect.values[0]);
  }
  if (change_s < -model.removable_delay_s) {
    throw ConfigError{"the effect delay takes " + written_number(-change_s) + " s off a transfer system that has " +
                      written_number(model.removable_delay_s) + " s of delay; expected no more than it has"};
  }
  return change_s;
}

double setting_change_s(const SiteModel& model) {
  const DelaySetting& setting = model.compensator_delay;
  if (setting.most_s <= 0.0) return 0.0;
  double change_s = 0.0;
  for (const EffectSetting& effect : model.effects) {
    if (effect.type == setting_mismatch()) change_s += effect.values[0];
  }
  if (setting.set_s + change_s < 0.0 || setting.set_s + change_s > setting.most_s) {
    throw ConfigError{"the effect setting_mismatch sets the compensator's delay to " +
                      written_number(setting.set_s + change_s) + " s; expected from 0 to " +
                      written_number(setting.most_s) + " s"};
  }
  return change_s;
}

}  // namespace hybridtest
