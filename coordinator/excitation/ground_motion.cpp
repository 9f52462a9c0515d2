#include "coordinator/excitation/ground_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "coordinator/excitation/time_history.hpp"

namespace hybridtest {

double GroundMotion::at(double model_time_s) const noexcept {
  return interpolated(acceleration_m_per_s2, dt_s, start_s, model_time_s);
}

double GroundMotion::end_s() const noexcept {
  return acceleration_m_per_s2.empty() ? start_s
                                       : start_s + static_cast<double>(acceleration_m_per_s2.size() - 1) * dt_s;
}

double GroundMotion::peak_m_per_s2() const noexcept {
  double peak = 0.0;
  for (const double value : acceleration_m_per_s2) peak = std::max(peak, std::abs(value));
  return peak;
}

GroundMotionFacts GroundMotion::facts() const noexcept {
  return {.peak_m_per_s2 = peak_m_per_s2(), .points = std::ssize(acceleration_m_per_s2), .duration_s = end_s()};
}

std::vector<double> GroundMotion::sampled(double step_s, std::int64_t last_step) const {
  return at_steps([this](double time_s) { return at(time_s); }, step_s, last_step);
}

void GroundMotion::multiply(double factor) noexcept {
  for (double& value : acceleration_m_per_s2) value *= factor;
}

}  // namespace hybridtest
