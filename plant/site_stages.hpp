#pragma once

#include <memory>
#include <utility>

#include "plant/site_model.hpp"

namespace hybridtest {

/// The stages of one degree of freedom of a site, each driven on its own: by the rig with what the
/// stage before made, by the diagnosis with what was measured. They hold no noise.
///
/// Constructed from a SiteModel they throw ConfigError for parameters that its parts refuse. Stepped
/// once per sample; allocate nothing after construction.

/// Displacement sent by the coordinator -> target at the site.
class NetworkStage {
 public:
  explicit NetworkStage(StageEffects effects) : effects_{std::move(effects)} {}
  NetworkStage(const SiteModel& model, double sample_period_s);

  /// @return the target [m].
  [[nodiscard]] double step(const StageSample& sample) noexcept {
    return effects_.step(sample, [](const Motion& motion) { return motion.displacement_m; });
  }
  void reset() noexcept { effects_.reset(); }

 private:
  StageEffects effects_;
};

/// Target at the site -> command to the actuator.
class CompensatorStage {
 public:
  /// @param compensator   null: the command is the target.
  CompensatorStage(std::unique_ptr<Compensator> compensator, StageEffects effects);
  CompensatorStage(const SiteModel& model, double sample_period_s);

  /// @param measured_displacement_m   at the sample before; the force is in the sample.
  /// @return the command [m].
  [[nodiscard]] double step(const StageSample& sample, double measured_displacement_m = 0.0) noexcept;
  void reset() noexcept;

 private:
  std::unique_ptr<Compensator> compensator_;
  StageEffects effects_;
};

/// Command -> displacement of the actuator -> what its transducer reads.
class TransferStage {
 public:
  /// @param transfer_system   not null.
  TransferStage(std::unique_ptr<TransferSystem> transfer_system, StageEffects transfer_effects,
                StageEffects sensor_effects);
  TransferStage(const SiteModel& model, double sample_period_s);

  /// @return the displacement as read [m].
  [[nodiscard]] double step(const StageSample& sample) noexcept;
  /// What is read of an actuator that stands still: in place of a step().
  [[nodiscard]] double read(const StageSample& sample) noexcept;
  /// The true one [m], of the last step.
  [[nodiscard]] double displacement_m() const noexcept { return displacement_m_; }
  void reset() noexcept;

 private:
  std::unique_ptr<TransferSystem> transfer_system_;
  StageEffects transfer_effects_;
  StageEffects sensor_effects_;
  double displacement_m_ = 0.0;
};

/// True motion of the actuator -> force of the specimen -> what the load cell reads.
class SpecimenStage {
 public:
  /// @param law   null: no force.
  SpecimenStage(std::unique_ptr<Law> law, StageEffects specimen_effects, StageEffects sensor_effects);
  SpecimenStage(const SiteModel& model, double sample_period_s);

  /// @return the force as read [N].
  [[nodiscard]] double step(const StageSample& sample) noexcept;
  /// The true one [N], of the last step.
  [[nodiscard]] double force_n() const noexcept { return force_n_; }
  void reset() noexcept;

 private:
  std::unique_ptr<Law> law_;
  StageEffects specimen_effects_;
  StageEffects sensor_effects_;
  double force_n_ = 0.0;
};

/// Motion as the transducer read it -> true motion, as far as the displacement sensor's effects can be
/// undone; what cannot be (quantization) is left as read.
class SensorInverse {
 public:
  SensorInverse(const SiteModel& model, double sample_period_s);

  [[nodiscard]] Motion step(const StageSample& sample) noexcept { return inverse_.before(sample); }
  void reset() noexcept { inverse_.reset(); }

 private:
  StageEffects inverse_;  // the last effect of the sensor first
};

}  // namespace hybridtest
