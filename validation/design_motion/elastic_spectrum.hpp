#pragma once

#include <vector>

namespace hybridtest::design_motion {

/// Horizontal elastic response spectrum of EN 1998-1:2004: 3.2.2.2, equations 3.2 to 3.6, up to
/// T_E, and beyond it Annex A, in which the displacement falls to that of the ground.
struct ElasticSpectrum {
  double ground_acceleration_m_per_s2 = 0.0;  // a_g, on rock
  double soil_factor = 1.0;                   // S
  double plateau_begin_s = 0.0;               // T_B
  double plateau_end_s = 0.0;                 // T_C
  double displacement_begin_s = 0.0;          // T_D
  double displacement_end_s = 0.0;            // T_E
  double ground_displacement_begin_s = 0.0;   // T_F
  double damping_ratio = 0.05;

  /// Type 1 on ground C, tables 3.2 and A.1: S = 1.15, T_B = 0.2 s, T_C = 0.6 s, T_D = 2.0 s,
  /// T_E = 6.0 s, T_F = 10.0 s.
  [[nodiscard]] static ElasticSpectrum type_1_ground_c(double ground_acceleration_m_per_s2) noexcept;

  /// S_e(T) [m/s2]. @param period_s   not negative.
  [[nodiscard]] double at(double period_s) const noexcept;
  /// S_e(0) = a_g S.
  [[nodiscard]] double zero_period_m_per_s2() const noexcept { return at(0.0); }
  /// d_g, equation 3.12.
  [[nodiscard]] double ground_displacement_m() const noexcept;
};

/// `count` periods from `first_s` to `last_s`, evenly on a logarithmic scale. @param count   at least 2.
[[nodiscard]] std::vector<double> logarithmic_periods(double first_s, double last_s, int count);

}  // namespace hybridtest::design_motion
