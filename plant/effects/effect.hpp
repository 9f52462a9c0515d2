#pragma once

#include <cstddef>

namespace hybridtest {

/// Motion of one degree of freedom.
struct Motion {
  double displacement_m = 0.0;
  double velocity_m_per_s = 0.0;
  double acceleration_m_per_s2 = 0.0;
};

/// What an effect sees of its stage at one sample, whatever other effects do to it.
/// The motion stands first: behind the time, copying it waited for two stores.
struct StageSample {
  Motion motion;         // into the stage: command (transfer system) or actuator motion (the others)
  double time_s = 0.0;   // since the beginning of the record or since arming
  double force_n = 0.0;  // force of the specimen at the sample before; what loads the actuator
  // What was recorded beside the motion (current, temperature), in the order of SiteModel::inputs; null: nothing.
  const double* inputs = nullptr;
};

/// An effect of the real world on one stage of a simulated site: command -> actuator (transfer
/// system), actuator motion -> force (specimen), true -> read value (sensors).
///
/// The stages of a site are a base (a transfer system, a law, a perfect sensor) with a list of effects.
/// In the order of the list each may change the motion that goes into the base, then, in the
/// same order, what comes out. A wrong number of the base stands next to it, wherever it is in the list: the
/// others act beside the base as it really is. Stepped once per sample; allocates nothing after construction.
/// Deterministic: a random one takes its seed as a parameter.
class Effect {
 public:
  virtual ~Effect() = default;

  /// Changes what the base is given.
  virtual void before(const StageSample& /*sample*/, Motion& /*motion*/) noexcept {}
  /// Changes what comes out: displacement [m] of a transfer system or displacement sensor, force
  /// [N], positive when it resists a positive displacement, of a specimen or force sensor.
  /// The motion is the one that the base was given, but for wrong numbers of it.
  virtual void after(const StageSample& /*sample*/, const Motion& /*motion*/, double& /*output*/) noexcept {}
  /// Whether it is a wrong number of the base, with the two functions below.
  [[nodiscard]] virtual bool is_of_base() const noexcept { return false; }
  /// After every before(), for the base alone.
  virtual void before_base(Motion& /*motion*/) noexcept {}
  /// Before every after(): the output of the base alone.
  virtual void after_base(double& /*output*/) noexcept {}
  /// Told once, before the first sample, which of StageSample::inputs it follows. Without that, or without inputs, an
  /// effect that follows one takes its nominal value.
  virtual void follow_input(std::size_t /*position*/) noexcept {}
  /// Told once, before the first sample: the initial stiffness of the law that is the base.
  virtual void follow_stiffness(double /*initial_n_per_m*/) noexcept {}
  /// As new.
  virtual void reset() noexcept = 0;
};

}  // namespace hybridtest
