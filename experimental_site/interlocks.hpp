#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/faults.hpp"
#include "core/interface_vector.hpp"

namespace hybridtest {

/// Action of a site on a fault, in order of severity.
///   warn           reports the fault; the test continues.
///   hold           keeps the last command; the rig keeps its pressure and its control.
///   ramp_to_zero   a controlled return, then stop_motion().
///   release        stop_motion() at once.
enum class SafetyAction : std::uint8_t { none, warn, hold, ramp_to_zero, release };

/// Condition on which an interlock clears. Those that ramp or release never clear.
enum class ClearCondition : std::uint8_t { when_cleared, operator_reset, never };

enum class InterlockKind : std::uint8_t {
  not_finite,
  rig_status,
  displacement,
  force,
  velocity,
  tracking_error,
  displacement_step,
  force_step,
  stuck_sensor,
  energy_error,
  tracking_indicator,
  command_age,
  emergency_stop,
};
inline constexpr std::size_t kInterlockCount = 13;

/// As in the `interlocks` section of a scenario.
[[nodiscard]] std::string_view name(InterlockKind kind) noexcept;
[[nodiscard]] FaultFlags fault_of(InterlockKind kind) noexcept;

/// Limits of one site, the same for each of its interface degrees of freedom, in site time.
/// A limit without a value is not checked.
struct SiteLimits {
  double displacement_m = 0.0;
  double velocity_m_per_s = 0.0;
  double force_n = 0.0;
  std::optional<double> tracking_error_m{};     // |target - measured|
  std::optional<double> energy_error_ratio{};   // see EnergyErrorMonitor
  double command_age_s = 0.0;                   // since the last new target
  std::optional<double> displacement_step_m{};  // measured, from one control period to the next
  std::optional<double> force_step_n{};         // likewise
  std::optional<int> stuck_samples{};           // identical readings in a row, after the command has moved
  double stuck_while_moving_m = 1e-4;           // by more than this; above the resolution of the sensors
  bool stuck_judges_force = true;               // else displacement readings alone
  std::optional<double> tracking_indicator{};   // |lag_sine|, see TrackingIndicator
};

/// What an interlock does when its limit is exceeded.
struct InterlockRule {
  SafetyAction action = SafetyAction::ramp_to_zero;
  ClearCondition clears = ClearCondition::never;
};
using InterlockRules = std::array<InterlockRule, kInterlockCount>;  // by InterlockKind

/// An exceeded limit ramps to zero. A fault that makes the measurement unreliable holds, because a
/// controlled return would use that measurement; an overdue command holds too. The operator's
/// emergency stop releases. None of them clears.
[[nodiscard]] InterlockRules default_interlock_rules() noexcept;

/// State of the site, as the interlocks need it. Before it is armed nothing is checked.
enum class SitePhase : std::uint8_t {
  standing,  // armed, commands at zero
  running,   // follows targets
  resting,   // holds or returns: targets are not followed
};

/// Input of the interlocks, once per control sample.
struct InterlockInput {
  SitePhase phase = SitePhase::running;
  const SiteVector& target_displacement_m;  // before it is limited
  const SiteVector& target_velocity_m_per_s;
  const SiteVector& command_displacement_m;  // of the compensator, before it is limited; at rest as sent
  const SiteVector& measured_displacement_m;
  const SiteVector& force_n;
  double energy_error_ratio = 0.0;
  double tracking_lag_sine = 0.0;
  double command_age_s = 0.0;
  bool expects_commands = false;  // the test runs and is not paused
  bool rig_fault = false;
  bool emergency_stop = false;
  bool is_new_sample = false;  // measured since the last call; else the same sample is checked again
  double period_s = 0.0;       // control period
};

/// State of an interlock between two control samples.
struct InterlockState {
  struct Latch {
    bool is_tripped = false;
    double clear_for_s = 0.0;  // time since its condition was last present
  };
  std::array<Latch, kInterlockCount> latches{};
  bool has_tripped = false;  // one of them

  bool has_sample = false;
  SiteVector measured_displacement_m;  // of the sample before
  SiteVector measured_force_n;
  /// Of a sensor that has the same reading again.
  struct Stuck {
    double command_then_m = 0.0;   // when it changed last
    double command_moved_m = 0.0;  // furthest that the command was from there since
    int samples = 0;               // since that was further than the limits' `stuck_while_moving_m`
  };
  std::array<Stuck, kMaxSiteDofs> displacement_stuck{};
  std::array<Stuck, kMaxSiteDofs> force_stuck{};
};

/// An interlock that tripped with this sample.
struct InterlockTrip {
  InterlockKind kind;
  SafetyAction action;
  bool is_final;    // never clears: the test cannot go on
  double observed;  // in the fault's unit; NaN for `not_finite`
  double limit;
};

struct InterlockVerdict {
  SafetyAction action = SafetyAction::none;          // the most severe one in force
  bool is_final = false;                             // one that never clears is in force with that action
  std::array<InterlockTrip, kInterlockCount> trips;  // new ones, most severe first; the rest is not set
  int trip_count = 0;
  bool has_cleared = false;  // one cleared with this sample
};

/// An interlock that clears by itself does so when its condition has been absent for this time.
inline constexpr double kClearAfter_s = 0.1;

/// Checks one control sample: a pure function of its arguments, without a clock.
///
/// @param state   from the last call; the new one is left in it. A fresh one at arming.
[[nodiscard]] InterlockVerdict judge(const SiteLimits& limits, const InterlockRules& rules, const InterlockInput& input,
                                     InterlockState& state) noexcept;

/// What an interlock compares with its limit.
struct InterlockLevel {
  double observed = 0.0;  // in the unit of the limit
  double limit = 0.0;
};

/// How near an interlock is to its limit, with the input that judge() has; nothing for one without a limit, and while
/// there is nothing to judge. Counters (`stuck_sensor`) and those that are there or not have no level.
/// @param measured_displacement_m_before, force_n_before   one sample earlier; empty without one.
[[nodiscard]] std::optional<InterlockLevel> level_of(InterlockKind kind, const SiteLimits& limits,
                                                     const InterlockInput& input,
                                                     const SiteVector& measured_displacement_m_before,
                                                     const SiteVector& force_n_before) noexcept;

/// The operator's reset: clears the interlocks that wait for it. One whose condition is still present
/// at the next sample trips again. @return whether one was waiting.
bool reset_by_operator(const InterlockRules& rules, InterlockState& state) noexcept;

}  // namespace hybridtest
