#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace hybridtest {

/// The tracking error of an actuator over a whole test, without the return to zero after it.
struct TrackingError {
  std::string dof;
  double rms_m = 0.0;                        // of measured − target
  double peak_m = 0.0;                       // largest magnitude of measured − target
  std::optional<double> rms_relative;        // [-] of the target's root mean square; none at rest
  std::optional<double> amplitude;           // [-] frequency evaluation index
  std::optional<double> equivalent_delay_s;  // [s] positive when the actuator is behind
  std::optional<double> equivalent_frequency_hz;
  std::size_t samples = 0;  // pairs compared; those that are not finite are left out
};

/// @param time_s, target_m, measured_m   of equal size, in the order recorded. The delay comes from
///        the longest stretch with even spacing (see evaluate_tracking_frequency()), the errors from
///        all pairs of finite values.
/// @return nothing without any such pair.
[[nodiscard]] std::optional<TrackingError> evaluate_tracking(std::string dof, std::span<const double> time_s,
                                                             std::span<const double> target_m,
                                                             std::span<const double> measured_m);

}  // namespace hybridtest
