#include "diagnosis/identification/signal_scales.hpp"

#include <algorithm>
#include <cmath>

namespace hybridtest {
namespace {

double ratio_or_one(double numerator, double denominator) noexcept {
  return numerator > 0.0 && denominator > 0.0 ? numerator / denominator : 1.0;
}

}  // namespace

double SignalScales::of(ParameterScale scale) const noexcept {
  switch (scale) {
    case ParameterScale::displacement_m: return ratio_or_one(displacement_m, 1.0);
    case ParameterScale::velocity_m_per_s: return ratio_or_one(velocity_m_per_s, 1.0);
    case ParameterScale::force_n: return ratio_or_one(force_n, 1.0);
    case ParameterScale::stiffness_n_per_m: return ratio_or_one(force_n, displacement_m);
    case ParameterScale::damping_n_s_per_m: return ratio_or_one(force_n, velocity_m_per_s);
    case ParameterScale::damping_n_s2_per_m2: return ratio_or_one(force_n, velocity_m_per_s * velocity_m_per_s);
    case ParameterScale::stiffness_n_per_m3:
      return ratio_or_one(force_n, displacement_m * displacement_m * displacement_m);
    case ParameterScale::compliance_m_per_n: return ratio_or_one(displacement_m, force_n);
    case ParameterScale::mass_kg: return ratio_or_one(force_n, acceleration_m_per_s2);
    case ParameterScale::duration_s: return ratio_or_one(duration_s, 1.0);
    case ParameterScale::one:
    case ParameterScale::time_s: break;
  }
  return 1.0;
}

SignalScales scales_of(std::span<const Segment> segments) {
  SignalScales scales;
  for (const Segment& segment : segments) {
    for (const Motion& motion : segment.input) {
      scales.displacement_m = std::max(scales.displacement_m, std::abs(motion.displacement_m));
      scales.velocity_m_per_s = std::max(scales.velocity_m_per_s, std::abs(motion.velocity_m_per_s));
      scales.acceleration_m_per_s2 = std::max(scales.acceleration_m_per_s2, std::abs(motion.acceleration_m_per_s2));
    }
    scales.duration_s = std::max(scales.duration_s, segment.period_s * static_cast<double>(segment.input.size()));
    if (segment.to != Channel::measured_force) continue;
    for (const double force_n : segment.measured) scales.force_n = std::max(scales.force_n, std::abs(force_n));
  }
  return scales;
}

}  // namespace hybridtest
