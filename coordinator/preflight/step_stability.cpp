#include "coordinator/preflight/step_stability.hpp"

#include <cstdio>
#include <limits>
#include <numbers>

#include "core/config_error.hpp"

namespace hybridtest {

StepStability step_stability(const VibrationModes& modes) noexcept {
  const double omega = modes.highest_frequency_rad_per_s();
  return {.highest_frequency_rad_per_s = omega,
          .step_s_max = omega > 0.0 ? 2.0 / omega : std::numeric_limits<double>::infinity()};
}

void require_stable_step(const VibrationModes& modes, double step_s) {
  const StepStability limit = step_stability(modes);
  if (step_s <= limit.step_s_max) return;
  const double omega = limit.highest_frequency_rad_per_s;
  char text[640];
  std::snprintf(text, sizeof text,
                "the step of %.6g s is too long for an explicit integrator: the highest mode of the structure has "
                "%.6g rad/s (%.6g Hz, period %.6g s), so the step must be at most T_n/pi = %.6g s; shorten the step, "
                "take an integrator without a limit, such as cr, kr_alpha or alpha_operator_splitting, or take the "
                "stiff or light part that makes this mode out of the structure",
                step_s, omega, omega / (2.0 * std::numbers::pi), 2.0 * std::numbers::pi / omega, limit.step_s_max);
  throw ConfigError{text};
}

}  // namespace hybridtest
