#include "core/signal/frequency_evaluation.hpp"

#include <algorithm>
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

std::vector<std::complex<double>> spectrum(std::span<const double> signal) {
  const double mean = std::accumulate(signal.begin(), signal.end(), 0.0) / static_cast<double>(signal.size());
  // Zeros up to a power of two: they interpolate the spectrum and keep the transform fast.
  std::size_t length = 1;
  while (length < signal.size()) length *= 2;
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

std::optional<FrequencyEvaluation> evaluate_tracking_frequency(std::span<const double> target,
                                                               std::span<const double> measured, double period_s) {
  HYBRIDTEST_ASSERT(target.size() == measured.size());
  if (target.size() < kSamplesMin || !(period_s > 0.0) || rests(target) || rests(measured)) return {};
  const auto input = spectrum(target);
  const auto output = spectrum(measured);
  std::complex<double> cross{};
  double input_power = 0.0;
  double output_power = 0.0;
  double frequency_moment = 0.0;
  for (std::size_t i = 1; i < input.size(); ++i) {
    cross += output[i] * std::conj(input[i]);
    input_power += std::norm(input[i]);
    output_power += std::norm(output[i]);
    frequency_moment += static_cast<double>(i) * std::norm(input[i]);
  }
  const double coherence = std::abs(cross) / std::sqrt(input_power * output_power);
  if (!(coherence >= kCoherenceMin)) return {};

  const double length = 2.0 * static_cast<double>(input.size() - 1);
  FrequencyEvaluation result;
  result.frequency_hz = frequency_moment / input_power / (length * period_s);
  result.amplitude = std::abs(cross) / input_power;
  result.delay_s = -std::arg(cross) / (2.0 * std::numbers::pi * result.frequency_hz);
  result.coherence = coherence;
  return result;
}

}  // namespace hybridtest
