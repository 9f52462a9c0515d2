#include "compensation/delay_estimators/frequency_evaluation_index.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {
namespace {

std::size_t checked_samples(const FrequencyEvaluationIndex::Parameters& parameters, double control_period_s) {
  expect_in_range("frequency_hz_max", parameters.frequency_hz_max,
                  {.low = 0.0, .high = 0.45 / control_period_s, .low_open = true},
                  "faster motion is not seen at the control rate");
  expect_in_range("frequency_hz_max", parameters.frequency_hz_max,
                  {.low = 0.0, .high = 256.0 / parameters.window_s, .low_open = true},
                  "every multiple of 1/window_s costs time at each sample");
  expect_in_range("frequency_hz_min", parameters.frequency_hz_min, {.low = 0.0, .high = parameters.frequency_hz_max},
                  "a band ends above its beginning");
  return 2 * checked_periods("window_s", 0.5 * parameters.window_s, control_period_s, 4,
                             "a window has a beginning, a middle and an end");
}

std::size_t first_multiple(double frequency_hz, double window_s) {
  return std::max<std::size_t>(static_cast<std::size_t>(std::ceil(frequency_hz * window_s - 1e-9)), 1);
}

std::size_t last_multiple(double frequency_hz, double window_s) {
  return static_cast<std::size_t>(std::floor(frequency_hz * window_s + 1e-9));
}

}  // namespace

FrequencyEvaluationIndex::FrequencyEvaluationIndex(const Parameters& parameters, double control_period_s)
    : DelayEstimator{parameters.limits, control_period_s},
      parameters_{checked(parameters)},
      samples_{checked_samples(parameters, control_period_s)},
      first_{first_multiple(parameters.frequency_hz_min, parameters.window_s)},
      count_{last_multiple(parameters.frequency_hz_max, parameters.window_s) + 1 - first_},
      turns_(samples_),
      taper_(samples_),
      windows_{Window{count_}, Window{count_}} {
  expect_in_range("frequency_hz_max", parameters.frequency_hz_max,
                  {.low = static_cast<double>(first_) / parameters.window_s, .high = 0.45 / control_period_s},
                  "the band holds a multiple of 1/window_s");
  for (std::size_t n = 0; n < samples_; ++n) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(n) / static_cast<double>(samples_);
    turns_[n] = std::polar(1.0, -angle);
    taper_[n] = 0.5 - 0.5 * std::cos(angle);
  }
  windows_[0].has_begun = true;
}

void FrequencyEvaluationIndex::observe(const DelaySample& sample) noexcept {
  for (Window& window : windows_) {
    if (window.has_begun) accumulate(window, sample);
  }
  // The second begins when the first is half over; from then on they keep their distance.
  if (windows_[0].sample == samples_ / 2) windows_[1].has_begun = true;
}

void FrequencyEvaluationIndex::accumulate(Window& window, const DelaySample& sample) noexcept {
  const double reference = taper_[window.sample] * sample.reference_m;
  const double measured = taper_[window.sample] * sample.measured_displacement_m;
  const std::size_t step = window.sample;  // turns from one frequency to the next
  std::size_t turn = first_ * window.sample % samples_;
  for (std::size_t j = 0; j < count_; ++j) {
    window.reference[j] += reference * turns_[turn];
    window.measured[j] += measured * turns_[turn];
    turn += step;
    if (turn >= samples_) turn -= samples_;
  }
  if (++window.sample < samples_) return;
  evaluate(window);
  clear(window);
}

void FrequencyEvaluationIndex::evaluate(const Window& window) noexcept {
  std::complex<double> cross = 0.0;
  double power = 0.0;
  double moment = 0.0;
  for (std::size_t j = 0; j < count_; ++j) {
    const double square = std::norm(window.reference[j]);
    cross += window.measured[j] * std::conj(window.reference[j]);
    power += square;
    moment += square * static_cast<double>(first_ + j);
  }
  // Parseval, for the positive frequencies: power = samples / 2 times the sum of (taper r)^2; the mean of
  // taper^2 is 3/8.
  const auto samples = static_cast<double>(samples_);
  const double mean_square_m2 = power / (0.5 * samples * samples * 0.375);
  if (mean_square_m2 < parameters_.motion_m_min * parameters_.motion_m_min) return;
  const double window_s = samples * control_period_s();
  amplitude_ = std::abs(cross) / power;
  frequency_hz_ = moment / power / window_s;
  believe(-std::arg(cross) / (2.0 * std::numbers::pi * frequency_hz_));
}

void FrequencyEvaluationIndex::clear(Window& window) noexcept {
  std::fill(window.reference.begin(), window.reference.end(), 0.0);
  std::fill(window.measured.begin(), window.measured.end(), 0.0);
  window.sample = 0;
}

void FrequencyEvaluationIndex::forget() noexcept {
  for (Window& window : windows_) clear(window);
  windows_[1].has_begun = false;
  amplitude_ = 1.0;
  frequency_hz_ = 0.0;
}

}  // namespace hybridtest
