#pragma once

#include <array>
#include <cstdint>

#include "core/interface_vector.hpp"
#include "core/messages.hpp"

namespace hybridtest {

/// Wanted motion of the actuators at one control sample.
struct TrajectoryPoint {
  SiteVector displacement_m;         // [m]
  SiteVector velocity_m_per_s;       // [m/s] in site time
  SiteVector acceleration_m_per_s2;  // [m/s2] in site time
  double path_time_s = 0.0;          // [s] site time along the path
  bool is_held = false;              // waits for it, almost at rest
};

/// A target passed in the last sampling interval, for the measurement that belongs to it.
struct ReachedTarget {
  Step step = kNoStep;
  double model_time_s = 0.0;
  SiteVector displacement_m;
  /// Share of the last sampling interval at which the target was passed, in (0, 1]; 1 when the
  /// sample falls on it.
  double fraction = 1.0;
  MeasurementFlags flags = MeasurementFlags::none;
};

enum class TrajectoryType : std::uint8_t { predictor_corrector, ramp_and_hold };

struct TrajectorySettings {
  TrajectoryType type = TrajectoryType::predictor_corrector;
  /// Of the predictor: 1 constant velocity, 2 constant acceleration, 3 constant jerk, which is
  /// taken from the accelerations of the last two targets. Exact for motions of that order.
  int order = 2;
  /// Ramp and hold: share of the step at its end in which the target is held, 0 to below 1.
  double hold_share = 0.2;
  /// In real time: steps end at their time, whether their target has come or not.
  bool keeps_time = false;
  /// Likewise: after this number of steps without a target the path comes to rest.
  int missed_most = 3;
};

/// Event-driven predictor-corrector between coupling steps (Mosqueda, Stojadinovic and Mahin,
/// 2005): interpolates to the next target once it is known, extrapolates while it is not,
/// slows down when it is late and waits short of the step's end as the last resort.
///
/// The path is a function of path time. While the target is unknown it is predicted by a polynomial.
/// Once the target is known it is a cubic from the present position and velocity to those of the
/// target. The corrector is a cubic for every order of the predictor: the lowest order that joins two
/// positions and two velocities. Path time runs with site time; from
/// `kSlowDownAt` of a step without its target it slows down and tends to the end of the step. When a
/// late target comes, path time is set back to that point, so that the target is reached over the
/// same share of a step, and speeds up again at a bounded rate. Position and velocity are therefore
/// continuous for any arrival times.
///
/// Ramp and hold, for quasi-static tests: from rest to rest along a raised cosine, held for the
/// last share of the step, measured at its end; without prediction and without late targets.
///
/// In real time (`keeps_time`) path time starts when the first target after the initial one comes, and never slows
/// down. A step whose target has not come ends where the motion of the newest known target leads, and counts as missed.
/// A target that comes within the last share of its step, or after it, corrects where the next step ends. After
/// `missed_most` steps without a target, the velocity halves in each further one.
///
/// Site time is model time times the time scale. Real-time safe.
class Trajectory {
 public:
  static constexpr double kSlowDownAt = 0.6;    // share of the step
  static constexpr double kRateRecovery = 2.0;  // path rate regained per step length

  /// @param dofs        interface degrees of freedom.
  /// @param step_s      coupling step in site time [s].
  /// @param time_scale  site time over model time.
  Trajectory(int dofs, double step_s, double time_scale, const TrajectorySettings& settings = {}) noexcept;

  /// At rest at `displacement_m`, before step 0.
  void reset(const SiteVector& displacement_m) noexcept;

  /// The next target; steps in order, one at a time. The first one starts path time and must
  /// be the present position of the path. In real time steps may be left out, be over, or come early: up to
  /// kCommandPoints wait.
  void set_target(const TargetPoint& target) noexcept;

  /// Moves on by `interval_s` of site time.
  /// @param reached   filled when the result is true.
  /// @return whether the target was passed; the interval is short enough for one at most.
  [[nodiscard]] bool advance(double interval_s, ReachedTarget& reached) noexcept;

  /// Stops at once, for an interlock; the next advance() continues from rest.
  void halt() noexcept;

  [[nodiscard]] const TrajectoryPoint& point() const noexcept { return point_; }
  /// A target is known and not yet reached.
  [[nodiscard]] bool has_target() const noexcept { return has_target_; }
  /// Step 0 has been given; path time runs.
  [[nodiscard]] bool is_running() const noexcept { return is_running_; }

 private:
  void choose_rate(double interval_s) noexcept;
  void leave_target() noexcept;
  void begin_segment() noexcept;
  void learn_target(const TargetPoint& target) noexcept;
  void adopt(const TargetPoint& target) noexcept;
  void miss_target(ReachedTarget& reached) noexcept;
  void begin_step_in_time() noexcept;
  void aim() noexcept;
  void evaluate() noexcept;
  void correct(double since_s) noexcept;
  void predict(double since_s) noexcept;
  void ramp(double since_s) noexcept;

  TrajectorySettings settings_;
  double step_s_;
  double time_scale_;
  bool is_running_ = false;
  bool has_target_ = false;
  bool is_first_target_ = false;
  TargetPoint target_;
  // In real time:
  bool stands_ = false;       // at the initial target
  bool aims_ = false;         // the end of the step is not its target, but where older targets lead
  TargetPoint known_;         // the newest that has come for this step or one before
  Step last_step_ = kNoStep;  // that has ended
  bool has_missed_ = false;   // the step before
  std::array<TargetPoint, kCommandPoints> early_{};  // for later steps, in order
  std::size_t early_count_ = 0;
  double path_time_s_ = 0.0;
  double rate_ = 0.0;
  double interval_begin_s_ = 0.0;  // path time of the last target reached
  SiteVector slope_m_per_s_;       // of the path in path time
  // Start of the current piece of path; its end is the target, if there is one.
  double segment_begin_s_ = 0.0;
  SiteVector begin_displacement_m_;
  SiteVector begin_velocity_m_per_s_;
  SiteVector begin_acceleration_m_per_s2_;
  SiteVector begin_jerk_m_per_s3_;
  bool has_left_target_ = false;
  SiteVector end_velocity_m_per_s_;
  SiteVector end_acceleration_m_per_s2_;
  MeasurementFlags flags_ = MeasurementFlags::none;
  TrajectoryPoint point_;
};

}  // namespace hybridtest
