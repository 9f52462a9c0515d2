#include "plant/site_stages.hpp"

#include <algorithm>
#include <utility>

#include "core/assert.hpp"

namespace hybridtest {
namespace {

using At = EffectInterface;

StageEffects inverse_of_sensor(const SiteModel& model, double sample_period_s) {
  std::vector<std::unique_ptr<Effect>> inverse;
  for (const EffectSetting& effect : model.effects) {
    if (effect.type->interface == At::displacement_sensor && effect.type->make_inverse != nullptr) {
      inverse.push_back(effect.type->make_inverse(effect.values, sample_period_s));
    }
  }
  std::ranges::reverse(inverse);
  return StageEffects{std::move(inverse)};
}

/// What a sensor sees: the value itself, and how it came about.
StageSample seen_by_sensor(const StageSample& sample, const Motion& motion, double force_n) noexcept {
  return {.motion = motion, .time_s = sample.time_s, .force_n = force_n};
}

}  // namespace

NetworkStage::NetworkStage(const SiteModel& model, double sample_period_s)
    : NetworkStage{effects_at(model, At::network, sample_period_s)} {}

CompensatorStage::CompensatorStage(std::unique_ptr<Compensator> compensator, StageEffects effects)
    : compensator_{std::move(compensator)}, effects_{std::move(effects)} {}

CompensatorStage::CompensatorStage(const SiteModel& model, double sample_period_s)
    : CompensatorStage{
          model.make_compensator ? model.make_compensator(sample_period_s, setting_change_s(model)) : nullptr,
          effects_at(model, At::compensator, sample_period_s)} {}

double CompensatorStage::step(const StageSample& sample, double measured_displacement_m) noexcept {
  return effects_.step(sample, [&](const Motion& target) {
    if (compensator_ == nullptr) return target.displacement_m;
    return compensator_->command({.target_m = target.displacement_m,
                                  .target_velocity_m_per_s = target.velocity_m_per_s,
                                  .target_acceleration_m_per_s2 = target.acceleration_m_per_s2,
                                  .measured_displacement_m = measured_displacement_m,
                                  .measured_force_n = sample.force_n});
  });
}

void CompensatorStage::reset() noexcept {
  if (compensator_ != nullptr) compensator_->reset();
  effects_.reset();
}

TransferStage::TransferStage(std::unique_ptr<TransferSystem> transfer_system, StageEffects transfer_effects,
                             StageEffects sensor_effects)
    : transfer_system_{std::move(transfer_system)},
      transfer_effects_{std::move(transfer_effects)},
      sensor_effects_{std::move(sensor_effects)} {
  HYBRIDTEST_ASSERT(transfer_system_ != nullptr);
}

TransferStage::TransferStage(const SiteModel& model, double sample_period_s)
    : TransferStage{transfer_system_of(model, sample_period_s), effects_at(model, At::transfer_system, sample_period_s),
                    effects_at(model, At::displacement_sensor, sample_period_s)} {}

double TransferStage::step(const StageSample& sample) noexcept {
  displacement_m_ = transfer_effects_.step(sample, [&](const Motion& command) {
    return transfer_system_->step_loaded(command.displacement_m, sample.force_n);
  });
  return read(sample);
}

double TransferStage::read(const StageSample& sample) noexcept {
  if (sensor_effects_.empty()) return displacement_m_;
  const Motion seen{.displacement_m = displacement_m_};
  return sensor_effects_.step(seen_by_sensor(sample, seen, sample.force_n),
                              [](const Motion& motion) { return motion.displacement_m; });
}

void TransferStage::reset() noexcept {
  transfer_system_->reset();
  transfer_effects_.reset();
  sensor_effects_.reset();
  displacement_m_ = 0.0;
}

SpecimenStage::SpecimenStage(std::unique_ptr<Law> law, StageEffects specimen_effects, StageEffects sensor_effects)
    : law_{std::move(law)},
      specimen_effects_{std::move(specimen_effects)},
      sensor_effects_{std::move(sensor_effects)} {}

SpecimenStage::SpecimenStage(const SiteModel& model, double sample_period_s)
    : SpecimenStage{law_of(model), effects_at(model, At::specimen, sample_period_s),
                    effects_at(model, At::force_sensor, sample_period_s)} {}

double SpecimenStage::step(const StageSample& sample) noexcept {
  force_n_ = specimen_effects_.step(sample, [this](const Motion& motion) {
    if (law_ == nullptr) return 0.0;
    const double force_n = law_->trial(motion.displacement_m, motion.velocity_m_per_s);
    law_->commit();
    return force_n;
  });
  if (sensor_effects_.empty()) return force_n_;
  return sensor_effects_.step(seen_by_sensor(sample, sample.motion, force_n_),
                              [this](const Motion&) { return force_n_; });
}

void SpecimenStage::reset() noexcept {
  if (law_ != nullptr) law_->reset();
  specimen_effects_.reset();
  sensor_effects_.reset();
  force_n_ = 0.0;
}

SensorInverse::SensorInverse(const SiteModel& model, double sample_period_s)
    : inverse_{inverse_of_sensor(model, sample_period_s)} {}

}  // namespace hybridtest
