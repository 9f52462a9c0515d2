#include "core/signal/frequency_evaluation.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "core/assert.hpp"

namespace hybridtest {
namespace {

constexpr std::size_t kSamplesMin = 16;
constexpr double kTaperShare = 0.1;  // of the length, at either end
constexpr double kCoherenceMin = 0.5;

double taper(std::size_t i, std::size_t size) {
  const double edge = kTaperShare * static_cast<double>(size);
  const double from_end = static_cast<double>(std::min(i, size - 1 - i)) + 0.5;
  return from_end >= edge ? 1.0 : 0.5 * (1.0 - std::cos(std::numbers::pi * from_end / edge));
}

/// Zeros up to the length interpolate the spectrum.
std::vector<std::complex<double>> spectrum(std::span<const double> signal, std::size_t length) {
  const double mean = std::accumulate(signal.begin(), signal.end(), 0.0) / static_cast<double>(signal.size());
  std::vector<double> tapered(length, 0.0);
  for (std::size_t i = 0; i < signal.size(); ++i) tapered[i] = (signal[i] - mean) * taper(i, signal.size());
  Eigen::FFT<double> transform;
  std::vector<std::complex<double>> result;
  transform.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  transform.fwd(result, tapered);
  return result;
}

bool rests(std::span<const double> signal) {
  const auto [low, high] = std::minmax_element(signal.begin(), signal.end());
  return *low == *high;
}

}  // namespace

FrequencyEvaluationSum::FrequencyEvaluationSum(double period_s, std::size_t length)
    : period_s_{period_s}, length_{length} {
  HYBRIDTEST_ASSERT(std::has_single_bit(length) && length >= kSamplesMin);
}

void FrequencyEvaluationSum::add(std::span<const double> target, std::span<const double> measured) {
  HYBRIDTEST_ASSERT(target.size() == measured.size() && !target.empty() && target.size() <= length_);
  samples_ += target.size();
  target_moves_ = target_moves_ || !rests(target);
  measured_moves_ = measured_moves_ || !rests(measured);
  if (rests(target) && rests(measured)) return;
  const auto input = spectrum(target, length_);
  const auto output = spectrum(measured, length_);
  for (std::size_t i = 1; i < input.size(); ++i) {
    cross_ += output[i] * std::conj(input[i]);
    input_power_ += std::norm(input[i]);
    output_power_ += std::norm(output[i]);
    frequency_moment_ += static_cast<double>(i) * std::norm(input[i]);
  }
}

std::optional<FrequencyEvaluation> FrequencyEvaluationSum::result() const {
  if (samples_ < kSamplesMin || !(period_s_ > 0.0) || !target_moves_ || !measured_moves_) return {};
  const double coherence = std::abs(cross_) / std::sqrt(input_power_ * output_power_);
  if (!(coherence >= kCoherenceMin)) return {};

  FrequencyEvaluation result;
  result.frequency_hz = frequency_moment_ / input_power_ / (static_cast<double>(length_) * period_s_);
  result.amplitude = std::abs(cross_) / input_power_;
  result.delay_s = -std::arg(cross_) / (2.0 * std::numbers::pi * result.frequency_hz);
  result.coherence = coherence;
  return result;
}

std::optional<FrequencyEvaluation> evaluate_tracking_frequency(std::span<const double> target,
                                                               std::span<const double> measured, double period_s) {
  HYBRIDTEST_ASSERT(target.size() == measured.size());
  if (target.size() < kSamplesMin) return {};
  // A power of two keeps the transform fast.
  FrequencyEvaluationSum sum{period_s, std::bit_ceil(target.size())};
  sum.add(target, measured);
  return sum.result();
}

}  // namespace hybridtest
