#pragma once

#include <cstddef>
#include <vector>

/// Whole signals in equal intervals, and what is done to them. The plant works on histories, not
/// sample by sample: what follows what is the order of the calls.
namespace hybridtest::blind {

using History = std::vector<double>;

/// Fine steps of the plant per sample of a recording: 8 to 16 kHz.
inline constexpr std::size_t kFineSteps = 16;

/// On the fine grid.
struct MotionHistory {
  double period_s = 0.0;
  History displacement_m;
  History velocity_m_per_s;
  History acceleration_m_per_s2;

  [[nodiscard]] std::size_t size() const noexcept { return displacement_m.size(); }
};

/// Straight lines between the samples, kFineSteps to an interval.
[[nodiscard]] History straight_lines(const History& samples);
/// Natural cubic spline through the samples, kFineSteps to an interval.
[[nodiscard]] History spline(const History& samples);
/// Every kFineSteps-th value.
[[nodiscard]] History sampled(const History& fine);

/// Central differences; one-sided at the ends.
[[nodiscard]] History derivative(const History& values, double period_s);
[[nodiscard]] MotionHistory motion_of(History displacement_m, double period_s);
/// Butterworth, second order, run forward and backward: no phase. @param cutoff_hz   below half the rate.
[[nodiscard]] History smoothed(const History& values, double period_s, double cutoff_hz);

/// The signal at a broken index, straight between samples, the first value before the first.
[[nodiscard]] double value_at(const History& values, double index) noexcept;
[[nodiscard]] History delayed(const History& values, double samples);

[[nodiscard]] double peak(const History& values) noexcept;
[[nodiscard]] double rms(const History& values) noexcept;
[[nodiscard]] History difference(const History& a, const History& b);
void add(History& values, const History& more, double factor = 1.0);

}  // namespace hybridtest::blind
