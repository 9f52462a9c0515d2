#include "diagnosis/identification/quasi_static.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "diagnosis/signals/signals.hpp"
#include "diagnosis/traces/traces.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {

namespace {

std::vector<Motion> motion_without_rate(std::span<const double> displacement_m) {
  constexpr double kHardlyMoving_m_per_s = std::numeric_limits<double>::min();
  std::vector<Motion> motion(displacement_m.size());
  double velocity_m_per_s = 0.0;
  for (std::size_t i = 0; i < motion.size(); ++i) {
    const double change_m = i == 0 ? 0.0 : displacement_m[i] - displacement_m[i - 1];
    if (change_m != 0.0) velocity_m_per_s = std::copysign(kHardlyMoving_m_per_s, change_m);
    motion[i] = {.displacement_m = displacement_m[i], .velocity_m_per_s = velocity_m_per_s};
  }
  return motion;
}

}  // namespace

double noise_along_path(std::span<const double> displacement_m, std::span<const double> force_n) {
  // A polynomial of half the usual degree: branches between two reversals are short. One point more than it needs.
  constexpr std::size_t kPoints = tuning::kSmoothingDegree / 2 + 2;
  std::vector<double> deviations;
  for (std::size_t begin = 0; begin + kPoints <= displacement_m.size(); ++begin) {
    const auto x = displacement_m.subspan(begin, kPoints);
    if (!std::ranges::is_sorted(x, std::ranges::less_equal{}) &&
        !std::ranges::is_sorted(x, std::ranges::greater_equal{}))
      continue;
    double difference = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < kPoints; ++i) {
      double weight = 1.0;
      for (std::size_t k = 0; k < kPoints; ++k) {
        if (k != i) weight *= (x.back() - x.front()) / (x[i] - x[k]);
      }
      difference += weight * force_n[begin + i];
      squares += weight * weight;
    }
    deviations.push_back(std::abs(difference) / std::sqrt(squares));
  }
  if (deviations.empty()) return 0.0;
  return upper_median(std::move(deviations)) / 0.6745;  // the median of the magnitude of a standard normal variable
}

std::vector<Segment> quasi_static_segments(const Recording& recording, const DofRecording& dof, std::size_t position) {
  if (!dof.has(Channel::measured_displacement) || !dof.has(Channel::measured_force)) return {};
  const std::vector<double>& displacement_m = dof.of(Channel::measured_displacement);
  Segment segment;
  segment.from = Channel::measured_displacement;
  segment.to = Channel::measured_force;
  segment.interface = EffectInterface::specimen;
  segment.recording = position;
  segment.period_s = recording.sample_period_s;
  segment.is_quasi_static = true;
  segment.input = motion_without_rate(displacement_m);
  segment.inputs = inputs_of(recording);
  segment.measured = dof.of(Channel::measured_force);
  segment.measured_noise = noise_along_path(displacement_m, segment.measured);
  segment.step_noise = steps_of_slow_readings(segment.measured).step / std::sqrt(12.0);
  return {std::move(segment)};
}

}  // namespace hybridtest
