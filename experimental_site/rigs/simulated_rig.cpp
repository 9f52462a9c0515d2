#include "experimental_site/rigs/simulated_rig.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/assert.hpp"
#include "core/config_error.hpp"
#include "core/parameters/checked_parameter.hpp"

namespace hybridtest {

static_assert(std::atomic<std::uint8_t>::is_always_lock_free, "exchange() must not lock");

namespace {

/// @param stream   of the white noise beside it.
NoisySensor::Coloured coloured_noise(double noise, double correlation_time_s, double period_s, std::uint64_t seed,
                                     std::uint64_t stream) {
  NoisySensor::Coloured coloured{.noise = noise, .random = Random{seed, stream + SensorNoise::kToColouredStreams}};
  if (noise > 0.0)
    coloured.correlation = std::exp(-period_s / checked("correlation_time_s", correlation_time_s, kPositive));
  return coloured;
}

}  // namespace

SimulatedRig::Effects SimulatedRig::effects_of(const SiteModel& model, double control_period_s) {
  const auto at = [&](EffectInterface interface) { return effects_at(model, interface, control_period_s); };
  return {.network = at(EffectInterface::network),
          .compensator = at(EffectInterface::compensator),
          .transfer_system = at(EffectInterface::transfer_system),
          .displacement_sensor = at(EffectInterface::displacement_sensor),
          .specimen = at(EffectInterface::specimen),
          .force_sensor = at(EffectInterface::force_sensor)};
}

SimulatedRig::SimulatedRig(std::vector<std::unique_ptr<TransferSystem>> transfer_systems,
                           std::unique_ptr<Specimen> specimen, const SensorNoise& noise, Duration control_period,
                           std::vector<Effects> effects)
    : specimen_{std::move(specimen)},
      control_period_s_{checked("control_period_s", to_seconds(control_period), kPositive)} {
  HYBRIDTEST_ASSERT(specimen_ != nullptr);
  const int dofs = specimen_->dofs();
  if (std::cmp_not_equal(transfer_systems.size(), dofs)) {
    throw ConfigError{std::to_string(transfer_systems.size()) +
                      " transfer systems; expected one for each of the specimen's " + std::to_string(dofs) +
                      " degrees of freedom"};
  }
  HYBRIDTEST_ASSERT(effects.empty() || effects.size() == transfer_systems.size());
  effects.resize(transfer_systems.size());
  const double displacement_noise_m = checked("displacement_noise_m", noise.displacement_noise_m, kNotNegative);
  const double force_noise_n = checked("force_noise_n", noise.force_noise_n, kNotNegative);
  expect_in_range("displacement_coloured_noise_m", noise.displacement_coloured_noise_m, kNotNegative);
  expect_in_range("force_coloured_noise_n", noise.force_coloured_noise_n, kNotNegative);
  const auto coloured = [&](double level, double correlation_time_s, std::uint64_t of_stream) {
    return coloured_noise(level, correlation_time_s, control_period_s_, noise.seed, of_stream);
  };
  std::uint64_t stream = noise.first_stream;
  for (std::size_t i = 0; i < transfer_systems.size(); ++i, stream += 2) {
    Effects& of = effects[i];
    actuators_.push_back(
        {.network = NetworkStage{std::move(of.network)},
         .compensator = CompensatorStage{nullptr, std::move(of.compensator)},
         .transfer = TransferStage{std::move(transfer_systems[i]), std::move(of.transfer_system),
                                   std::move(of.displacement_sensor)},
         .specimen_effects = std::move(of.specimen),
         .force_sensor_effects = std::move(of.force_sensor),
         .displacement_sensor =
             NoisySensor{displacement_noise_m, Random{noise.seed, stream},
                         coloured(noise.displacement_coloured_noise_m, noise.displacement_correlation_time_s, stream)},
         .force_sensor =
             NoisySensor{force_noise_n, Random{noise.seed, stream + 1},
                         coloured(noise.force_coloured_noise_n, noise.force_correlation_time_s, stream + 1)},
         .differences = BackwardDifferences{control_period_s_}});
  }
  displacement_m_ = velocity_m_per_s_ = force_n_ = SiteVector::Zero(dofs);
}

void SimulatedRig::connect() {
  specimen_->reset();
  for (Actuator& actuator : actuators_) {
    actuator.network.reset();
    actuator.compensator.reset();
    actuator.transfer.reset();
    actuator.specimen_effects.reset();
    actuator.force_sensor_effects.reset();
    actuator.displacement_sensor.reset();
    actuator.force_sensor.reset();
    actuator.differences.reset();
    actuator.motion = {};
  }
  force_n_.setZero();
  phase_ = Phase::connected;
}

void SimulatedRig::arm() {
  // One atomic step, so that it does not undo a stop_motion() from another thread.
  Phase expected = Phase::connected;
  if (phase_.compare_exchange_strong(expected, Phase::armed) || expected == Phase::armed) return;
  throw std::runtime_error{
      "the simulated rig cannot be armed: it is not connected, or it was stopped after that; "
      "connect it again"};
}

RigStatus SimulatedRig::exchange(const ActuatorCommand& command, RigFeedback& feedback) noexcept {
  const Phase phase = phase_;
  fault_ = phase == Phase::disconnected ? RigFault::not_connected : RigFault::invalid_command;
  if (phase == Phase::disconnected || !is_usable(command.displacement_m)) return RigStatus::fault;
  if (feedback.displacement_m.size() != specimen_->dofs() || feedback.force_n.size() != specimen_->dofs())
    return RigStatus::fault;

  for (std::size_t i = 0; i < actuators_.size(); ++i) {
    const auto dof = static_cast<Eigen::Index>(i);
    const StageSample sample{
        .motion = {.displacement_m = command.displacement_m[dof]}, .time_s = command.time_s, .force_n = force_n_[dof]};
    move(actuators_[i], sample, phase == Phase::armed);
  }
  load_specimen(command.time_s);
  fault_ = RigFault::simulation_not_finite;
  if (!displacement_m_.allFinite() || !force_n_.allFinite()) return RigStatus::fault;

  for (std::size_t i = 0; i < actuators_.size(); ++i) {
    const auto dof = static_cast<Eigen::Index>(i);
    feedback.displacement_m[dof] = actuators_[i].displacement_sensor.read(actuators_[i].read_m);
    feedback.force_n[dof] = actuators_[i].force_sensor.read(read_force(actuators_[i], command.time_s, force_n_[dof]));
  }
  return RigStatus::healthy;
}

void SimulatedRig::stop_motion() noexcept { phase_ = Phase::stopped; }

bool SimulatedRig::is_usable(const SiteVector& command_m) const noexcept {
  return command_m.size() == specimen_->dofs() && command_m.allFinite();
}

void SimulatedRig::move(Actuator& actuator, const StageSample& command, bool is_armed) noexcept {
  StageSample sample = command;
  if (is_armed) {
    sample.motion.displacement_m = actuator.network.step(sample);
    sample.motion.displacement_m = actuator.compensator.step(sample);
    actuator.read_m = actuator.transfer.step(sample);
  } else {
    actuator.read_m = actuator.transfer.read(sample);
  }
  actuator.motion = actuator.differences.moved_to(actuator.transfer.displacement_m());
}

/// The specimen couples its degrees of freedom, the effects on it do not.
void SimulatedRig::load_specimen(double time_s) noexcept {
  for (std::size_t i = 0; i < actuators_.size(); ++i) {
    const auto dof = static_cast<Eigen::Index>(i);
    const StageSample sample{.motion = actuators_[i].motion, .time_s = time_s, .force_n = force_n_[dof]};
    actuators_[i].given = actuators_[i].specimen_effects.before(sample);
    const Motion to_law = actuators_[i].specimen_effects.for_base(actuators_[i].given);
    displacement_m_[dof] = to_law.displacement_m;
    velocity_m_per_s_[dof] = to_law.velocity_m_per_s;
  }
  SiteVector before_n = force_n_;
  specimen_->impose(displacement_m_, velocity_m_per_s_, force_n_);
  for (std::size_t i = 0; i < actuators_.size(); ++i) {
    const auto dof = static_cast<Eigen::Index>(i);
    const StageSample sample{.motion = actuators_[i].motion, .time_s = time_s, .force_n = before_n[dof]};
    force_n_[dof] = actuators_[i].specimen_effects.after(sample, actuators_[i].given, force_n_[dof]);
  }
}

double SimulatedRig::read_force(Actuator& actuator, double time_s, double force_n) noexcept {
  const StageSample sample{.motion = actuator.motion, .time_s = time_s, .force_n = force_n};
  return actuator.force_sensor_effects.step(sample, [force_n](const Motion&) { return force_n; });
}

}  // namespace hybridtest
