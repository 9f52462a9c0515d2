#include "diagnosis/localisation/spectra.hpp"

#include <cmath>
#include <numbers>
#include <numeric>
#include <unsupported/Eigen/FFT>

#include "core/assert.hpp"

namespace hybridtest {
namespace {

constexpr std::size_t kShortestSegment = 16;
constexpr std::size_t kLongestSegment = 8192;

std::vector<double> hann(std::size_t size) {
  std::vector<double> window(size);
  for (std::size_t i = 0; i < size; ++i) {
    const double phase = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(size);
    window[i] = 0.5 * (1.0 - std::cos(phase));
  }
  return window;
}

std::vector<std::complex<double>> transformed(std::span<const double> values, const std::vector<double>& window,
                                              Eigen::FFT<double>& transform) {
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  std::vector<double> weighted(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) weighted[i] = (values[i] - mean) * window[i];
  std::vector<std::complex<double>> result;
  transform.fwd(result, weighted);
  return result;
}

}  // namespace

double Spectra::coherence(std::size_t i) const noexcept {
  const double product = input[i] * output[i];
  return product > 0.0 ? std::norm(cross[i]) / product : 0.0;
}

Spectra welch(std::span<const double> input, std::span<const double> output, double period_s, std::size_t segment) {
  HYBRIDTEST_ASSERT(input.size() == output.size() && segment >= kShortestSegment && segment <= input.size());
  const std::vector<double> window = hann(segment);
  const double window_power = std::inner_product(window.begin(), window.end(), window.begin(), 0.0);
  Eigen::FFT<double> transform;
  transform.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  const std::size_t size = segment / 2 + 1;
  Spectra spectra{.resolution_hz = 1.0 / (static_cast<double>(segment) * period_s),
                  .averages = 0,
                  .input = std::vector<double>(size, 0.0),
                  .output = std::vector<double>(size, 0.0),
                  .cross = std::vector<std::complex<double>>(size)};
  for (std::size_t begin = 0; begin + segment <= input.size(); begin += segment / 2) {
    const auto x = transformed(input.subspan(begin, segment), window, transform);
    const auto y = transformed(output.subspan(begin, segment), window, transform);
    for (std::size_t i = 0; i < size; ++i) {
      spectra.input[i] += std::norm(x[i]);
      spectra.output[i] += std::norm(y[i]);
      spectra.cross[i] += y[i] * std::conj(x[i]);
    }
    ++spectra.averages;
  }
  for (std::size_t i = 0; i < size; ++i) {
    // Both sides of the spectrum, but for its ends.
    const double sides = i == 0 || i + 1 == size ? 1.0 : 2.0;
    const double scale = sides * period_s / (window_power * static_cast<double>(spectra.averages));
    spectra.input[i] *= scale;
    spectra.output[i] *= scale;
    spectra.cross[i] *= scale;
  }
  return spectra;
}

std::size_t welch_segment(std::size_t samples) noexcept {
  std::size_t segment = kShortestSegment;
  // n averages with half overlap take (n + 1) / 2 segments.
  while (segment < kLongestSegment && 2 * segment * 9 / 2 <= samples) segment *= 2;
  return segment;
}

}  // namespace hybridtest
