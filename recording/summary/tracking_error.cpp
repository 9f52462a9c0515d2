#include "recording/summary/tracking_error.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/assert.hpp"
#include "core/signal/frequency_evaluation.hpp"

namespace hybridtest {
namespace {

/// Largest deviation of a sample interval from the usual one that still counts as even spacing.
constexpr double kEvenSpacing = 0.01;

struct Stretch {
  std::size_t first = 0;
  std::size_t count = 0;
};

double usual_period(std::span<const double> time_s) {
  std::vector<double> periods;
  for (std::size_t i = 1; i < time_s.size(); ++i) periods.push_back(time_s[i] - time_s[i - 1]);
  const auto middle = periods.begin() + static_cast<std::ptrdiff_t>(periods.size() / 2);
  std::nth_element(periods.begin(), middle, periods.end());
  return *middle;
}

/// The longest run of finite samples with even spacing.
Stretch longest_even_stretch(std::span<const double> time_s, std::span<const double> target_m,
                             std::span<const double> measured_m, double period_s) {
  Stretch best;
  Stretch current;
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    const bool finite = std::isfinite(target_m[i]) && std::isfinite(measured_m[i]);
    const bool joins = current.count > 0 && std::abs(time_s[i] - time_s[i - 1] - period_s) <= kEvenSpacing * period_s;
    if (!finite) {
      current = {};
    } else if (joins) {
      ++current.count;
    } else {
      current = {i, 1};
    }
    if (current.count > best.count) best = current;
  }
  return best;
}

void add_frequency_evaluation(TrackingError& error, std::span<const double> time_s, std::span<const double> target_m,
                              std::span<const double> measured_m) {
  const bool times_finite = std::all_of(time_s.begin(), time_s.end(), [](double time) { return std::isfinite(time); });
  if (time_s.size() < 2 || !times_finite) return;
  const double period_s = usual_period(time_s);
  const auto [first, count] = longest_even_stretch(time_s, target_m, measured_m, period_s);
  const auto result =
      evaluate_tracking_frequency(target_m.subspan(first, count), measured_m.subspan(first, count), period_s);
  if (!result) return;
  error.amplitude = result->amplitude;
  error.equivalent_delay_s = result->delay_s;
  error.equivalent_frequency_hz = result->frequency_hz;
}

}  // namespace

std::optional<TrackingError> evaluate_tracking(std::string dof, std::span<const double> time_s,
                                               std::span<const double> target_m, std::span<const double> measured_m) {
  HYBRIDTEST_ASSERT(time_s.size() == target_m.size() && target_m.size() == measured_m.size());
  TrackingError error;
  error.dof = std::move(dof);
  double error_squares = 0.0;
  double target_squares = 0.0;
  for (std::size_t i = 0; i < target_m.size(); ++i) {
    const double difference = measured_m[i] - target_m[i];
    if (!std::isfinite(difference)) continue;
    error_squares += difference * difference;
    target_squares += target_m[i] * target_m[i];
    error.peak_m = std::max(error.peak_m, std::abs(difference));
    ++error.samples;
  }
  if (error.samples == 0) return {};
  error.rms_m = std::sqrt(error_squares / static_cast<double>(error.samples));
  if (target_squares > 0.0) error.rms_relative = std::sqrt(error_squares / target_squares);
  add_frequency_evaluation(error, time_s, target_m, measured_m);
  return error;
}

}  // namespace hybridtest
