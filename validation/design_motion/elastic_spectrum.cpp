#include "validation/design_motion/elastic_spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hybridtest::design_motion {

ElasticSpectrum ElasticSpectrum::type_1_ground_c(double ground_acceleration_m_per_s2) noexcept {
  return {.ground_acceleration_m_per_s2 = ground_acceleration_m_per_s2,
          .soil_factor = 1.15,
          .plateau_begin_s = 0.2,
          .plateau_end_s = 0.6,
          .displacement_begin_s = 2.0,
          .displacement_end_s = 6.0,
          .ground_displacement_begin_s = 10.0,
          .damping_ratio = 0.05};
}

double ElasticSpectrum::at(double period_s) const noexcept {
  const double correction = std::max(0.55, std::sqrt(10.0 / (5.0 + 100.0 * damping_ratio)));  // eta
  const double rigid = ground_acceleration_m_per_s2 * soil_factor;
  const double plateau = 2.5 * rigid * correction;
  if (period_s < plateau_begin_s) {
    return rigid * (1.0 + period_s / plateau_begin_s * (2.5 * correction - 1.0));
  }
  if (period_s <= plateau_end_s) return plateau;
  if (period_s <= displacement_begin_s) return plateau * plateau_end_s / period_s;
  if (period_s <= displacement_end_s) return plateau * plateau_end_s * displacement_begin_s / (period_s * period_s);
  const double place =
      std::min(1.0, (period_s - displacement_end_s) / (ground_displacement_begin_s - displacement_end_s));
  const double displacement_m = ground_displacement_m() * (2.5 * correction + place * (1.0 - 2.5 * correction));
  const double omega = 2.0 * std::numbers::pi / period_s;
  return omega * omega * displacement_m;
}

double ElasticSpectrum::ground_displacement_m() const noexcept {
  return 0.025 * zero_period_m_per_s2() * plateau_end_s * displacement_begin_s;
}

std::vector<double> logarithmic_periods(double first_s, double last_s, int count) {
  std::vector<double> periods;
  for (int i = 0; i < count; ++i) {
    periods.push_back(first_s * std::pow(last_s / first_s, static_cast<double>(i) / (count - 1)));
  }
  return periods;
}

}  // namespace hybridtest::design_motion
