#include "experimental_site/interlocks.hpp"

#include <cmath>
#include <limits>

namespace hybridtest {
namespace {

[[nodiscard]] double largest(const InterfaceVector& values) noexcept {
  return values.size() == 0 ? 0.0 : values.cwiseAbs().maxCoeff();
}

[[nodiscard]] bool is_finite(const InterlockInput& input) noexcept {
  return input.target_displacement_m.allFinite() && input.command_displacement_m.allFinite() &&
         input.measured_displacement_m.allFinite() && input.force_n.allFinite();
}

}  // namespace

InterlockVerdict judge(const SiteLimits& limits, const InterlockInput& input) noexcept {
  constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
  if (!is_finite(input)) return {SafetyAction::hold, FaultFlags::not_finite, kNotANumber, 0.0};
  if (input.rig_fault) return {SafetyAction::hold, FaultFlags::rig_fault, 0.0, 0.0};

  const auto ramp_if_above = [](double observed, double limit, FaultFlags fault) -> InterlockVerdict {
    if (observed <= limit) return {};
    return {SafetyAction::ramp_to_zero, fault, observed, limit};
  };
  const double displacement = std::fmax(largest(input.target_displacement_m), largest(input.measured_displacement_m));
  if (auto v = ramp_if_above(displacement, limits.displacement_m, FaultFlags::displacement_limit); any(v.fault))
    return v;
  if (auto v = ramp_if_above(largest(input.force_n), limits.force_n, FaultFlags::force_limit); any(v.fault)) return v;
  if (auto v =
          ramp_if_above(largest(input.target_velocity_m_per_s), limits.velocity_m_per_s, FaultFlags::velocity_limit);
      any(v.fault)) {
    return v;
  }
  if (limits.tracking_error_m) {
    const double error = (input.target_displacement_m - input.measured_displacement_m).cwiseAbs().maxCoeff();
    if (auto v = ramp_if_above(error, *limits.tracking_error_m, FaultFlags::tracking_error); any(v.fault)) return v;
  }
  if (limits.energy_error_ratio) {
    if (auto v =
            ramp_if_above(std::fabs(input.energy_error_ratio), *limits.energy_error_ratio, FaultFlags::energy_error);
        any(v.fault)) {
      return v;
    }
  }
  if (input.expects_commands && input.command_age_s > limits.command_age_s) {
    return {SafetyAction::hold, FaultFlags::command_age, input.command_age_s, limits.command_age_s};
  }
  return {};
}

}  // namespace hybridtest
