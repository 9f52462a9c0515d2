#include "coordinator/ground_motion/ground_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace hybridtest {
namespace {

/// Times that are samples up to rounding count as samples, the last one too.
constexpr double kSampleRounding = 1e-9;

}  // namespace

double GroundMotion::at(double model_time_s) const noexcept {
  if (acceleration_m_per_s2.empty()) return 0.0;
  const double position = (model_time_s - start_s) / dt_s;
  const auto last = static_cast<double>(acceleration_m_per_s2.size() - 1);
  // Written so that NaN counts as outside.
  if (!(position >= -kSampleRounding && position <= last + kSampleRounding)) return 0.0;
  const double inside = std::clamp(position, 0.0, last);
  const auto index = static_cast<std::size_t>(inside);
  if (index + 1 >= acceleration_m_per_s2.size()) return acceleration_m_per_s2.back();
  const double fraction = inside - static_cast<double>(index);
  return acceleration_m_per_s2[index] + fraction * (acceleration_m_per_s2[index + 1] - acceleration_m_per_s2[index]);
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
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(last_step) + 1);
  for (std::int64_t step = 0; step <= last_step; ++step) values.push_back(at(static_cast<double>(step) * step_s));
  return values;
}

}  // namespace hybridtest
