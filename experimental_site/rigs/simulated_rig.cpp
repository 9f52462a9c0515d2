#include "experimental_site/rigs/simulated_rig.hpp"

#include <stdexcept>
#include <string>
#include <utility>

#include "core/assert.hpp"
#include "core/config/error.hpp"
#include "mechanics/checked_parameter.hpp"

namespace hybridtest {

static_assert(std::atomic<std::uint8_t>::is_always_lock_free, "exchange() must not lock");

SimulatedRig::SimulatedRig(std::vector<std::unique_ptr<TransferSystem>> transfer_systems,
                           std::unique_ptr<Specimen> specimen, const SensorNoise& noise, Duration control_period)
    : transfer_systems_{std::move(transfer_systems)},
      specimen_{std::move(specimen)},
      control_period_s_{checked("control_period_s", to_seconds(control_period), config::kPositive)} {
  HYBRIDTEST_ASSERT(specimen_ != nullptr);
  for (const auto& transfer_system : transfer_systems_) HYBRIDTEST_ASSERT(transfer_system != nullptr);
  const int dofs = specimen_->dofs();
  if (transfer_systems_.size() != static_cast<std::size_t>(dofs)) {
    throw ConfigError{std::to_string(transfer_systems_.size()) +
                      " transfer systems; expected one for each of the specimen's " + std::to_string(dofs) +
                      " degrees of freedom"};
  }
  const double displacement_noise_m = checked("displacement_noise_m", noise.displacement_noise_m, config::kNotNegative);
  const double force_noise_n = checked("force_noise_n", noise.force_noise_n, config::kNotNegative);
  std::uint64_t stream = noise.first_stream;
  for (int i = 0; i < dofs; ++i, stream += 2) {
    sensors_.push_back({.displacement = NoisySensor{displacement_noise_m, Random{noise.seed, stream}},
                        .force = NoisySensor{force_noise_n, Random{noise.seed, stream + 1}}});
  }
  displacement_m_ = previous_displacement_m_ = velocity_m_per_s_ = force_n_ = InterfaceVector::Zero(dofs);
}

void SimulatedRig::connect() {
  for (const auto& transfer_system : transfer_systems_) transfer_system->reset();
  specimen_->reset();
  for (Sensors& sensors : sensors_) {
    sensors.displacement.reset();
    sensors.force.reset();
  }
  displacement_m_.setZero();
  phase_ = Phase::connected;
}

void SimulatedRig::arm() {
  // One step, so that a stop_motion() from another thread is not overrun.
  Phase expected = Phase::connected;
  if (phase_.compare_exchange_strong(expected, Phase::armed) || expected == Phase::armed) return;
  throw std::runtime_error{
      "the simulated rig cannot be armed: it is not connected, or was stopped since; "
      "connect it anew"};
}

RigStatus SimulatedRig::exchange(const ActuatorCommand& command, RigFeedback& feedback) noexcept {
  const Phase phase = phase_;
  if (phase == Phase::disconnected || !is_usable(command.displacement_m)) return RigStatus::fault;
  if (feedback.displacement_m.size() != specimen_->dofs() || feedback.force_n.size() != specimen_->dofs())
    return RigStatus::fault;

  previous_displacement_m_ = displacement_m_;
  if (phase == Phase::armed) move(command.displacement_m);
  velocity_m_per_s_ = (displacement_m_ - previous_displacement_m_) / control_period_s_;
  specimen_->impose(displacement_m_, velocity_m_per_s_, force_n_);
  if (!displacement_m_.allFinite() || !force_n_.allFinite()) return RigStatus::fault;

  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    const auto actuator = static_cast<Eigen::Index>(i);
    feedback.displacement_m[actuator] = sensors_[i].displacement.read(displacement_m_[actuator]);
    feedback.force_n[actuator] = sensors_[i].force.read(force_n_[actuator]);
  }
  return RigStatus::healthy;
}

void SimulatedRig::stop_motion() noexcept { phase_ = Phase::stopped; }

bool SimulatedRig::is_usable(const InterfaceVector& command_m) const noexcept {
  return command_m.size() == specimen_->dofs() && command_m.allFinite();
}

void SimulatedRig::move(const InterfaceVector& command_m) noexcept {
  for (std::size_t i = 0; i < transfer_systems_.size(); ++i) {
    const auto actuator = static_cast<Eigen::Index>(i);
    displacement_m_[actuator] = transfer_systems_[i]->step(command_m[actuator]);
  }
}

}  // namespace hybridtest
