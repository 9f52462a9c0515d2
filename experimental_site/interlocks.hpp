#pragma once

#include <cstdint>
#include <optional>

#include "core/faults.hpp"
#include "core/interface_vector.hpp"

namespace hybridtest {

/// What a site does about a fault, in order of severity.
enum class SafetyAction : std::uint8_t { none, hold, ramp_to_zero };

/// Limits of one site, the same for each of its interface degrees of freedom. Site time.
struct SiteLimits {
  double displacement_m = 0.0;
  double velocity_m_per_s = 0.0;
  double force_n = 0.0;
  std::optional<double> tracking_error_m;    // |target - measured|
  std::optional<double> energy_error_ratio;  // see EnergyErrorMonitor
  double command_age_s = 0.0;                // since the last new target
};

/// What the interlocks look at, once per control sample.
struct InterlockInput {
  const InterfaceVector& target_displacement_m;  // wanted, before it is clipped
  const InterfaceVector& target_velocity_m_per_s;
  const InterfaceVector& command_displacement_m;  // as the compensator wants it
  const InterfaceVector& measured_displacement_m;
  const InterfaceVector& force_n;
  double energy_error_ratio = 0.0;
  double command_age_s = 0.0;
  bool expects_commands = false;  // the test runs and is not paused
  bool rig_fault = false;
};

/// The gravest of what is wrong. Faults that bring the rig to rest outrank those that hold it.
struct InterlockVerdict {
  SafetyAction action = SafetyAction::none;
  FaultFlags fault = FaultFlags::none;  // one flag
  double observed = 0.0;                // in the fault's unit; not finite for `not_finite`
  double limit = 0.0;
};

/// Judges one control sample: a pure function, no state, no clock.
///
/// Values that are not finite and a rig that reports a fault hold (a controlled return would
/// act on them); limits passed ramp to zero; an overdue command holds.
[[nodiscard]] InterlockVerdict judge(const SiteLimits& limits, const InterlockInput& input) noexcept;

}  // namespace hybridtest
