#pragma once

#include <vector>

namespace hybridtest::design_motion {

/// A damped oscillator under ground acceleration, u'' + 2 ratio omega u' + omega^2 u = -a, solved
/// exactly for accelerations that are linear between their samples (Nigam and Jennings, 1969).
class Oscillator {
 public:
  /// @param period_s   positive. @param damping_ratio   in [0, 1). @param dt_s   positive.
  Oscillator(double period_s, double damping_ratio, double dt_s) noexcept;

  /// Over one step, the acceleration going from `begin` to `end` [m/s2].
  void advance(double begin, double end) noexcept;

  [[nodiscard]] double displacement_m() const noexcept { return displacement_m_; }
  [[nodiscard]] double velocity_m_per_s() const noexcept { return velocity_m_per_s_; }
  [[nodiscard]] double frequency_rad_per_s() const noexcept { return omega_; }

 private:
  double omega_;
  double ratio_;
  double dt_s_;
  // Free vibration over one step.
  double displacement_of_displacement_;
  double displacement_of_velocity_;
  double velocity_of_displacement_;
  double velocity_of_velocity_;
  double displacement_m_ = 0.0;
  double velocity_m_per_s_ = 0.0;
};

/// The largest response of an oscillator.
struct PeakResponse {
  double pseudo_acceleration_m_per_s2 = 0.0;  // omega^2 u, with its sign
  double time_s = 0.0;
};

/// Intervals between samples are subdivided to at least 40 instants per period (linear interpolation),
/// so that the peak is underestimated by 1 - cos(pi/40) = 0.3 percent at most.
/// The motion starts at time 0 with its first sample; the oscillator starts at rest.
[[nodiscard]] PeakResponse peak_response(const std::vector<double>& acceleration_m_per_s2, double dt_s, double period_s,
                                         double damping_ratio) noexcept;

}  // namespace hybridtest::design_motion
