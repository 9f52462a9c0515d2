#include "diagnosis/signals/noise_parts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <vector>

#include "diagnosis/signals/signals.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {
namespace {

/// Weights of neighbouring means.
constexpr std::array kThirdDifference{1.0, -3.0, 3.0, -1.0};

/// Sums of products of the samples' weights in a third difference that are so many samples apart. Between whole lengths
/// they go straight.
std::vector<double> lagged_weights(std::size_t length) {
  constexpr std::size_t kMeans = kThirdDifference.size();
  std::array<double, kMeans + 1> of_means{};
  for (std::size_t lag = 0; lag < kMeans; ++lag) {
    for (std::size_t k = lag; k < kMeans; ++k) of_means[lag] += kThirdDifference[k] * kThirdDifference[k - lag];
  }
  const auto whole = static_cast<double>(length);
  std::vector<double> sums;
  for (std::size_t lag = 0; lag < kMeans * length; ++lag) {
    const double part = static_cast<double>(lag % length) / whole;
    sums.push_back(((1.0 - part) * of_means[lag / length] + part * of_means[lag / length + 1]) / whole);
  }
  return sums;
}

/// Third differences of means over so many samples, from every sample on.
std::vector<double> third_differences(std::span<const double> values, std::size_t length) {
  std::vector<double> sums(values.size() + 1);
  std::partial_sum(values.begin(), values.end(), sums.begin() + 1);
  std::vector<double> result(values.size() + 1 - kThirdDifference.size() * length);
  for (std::size_t i = 0; i < result.size(); ++i) {
    for (std::size_t k = 0; k < kThirdDifference.size(); ++k) {
      const std::size_t at = i + k * length;
      result[i] += kThirdDifference[k] * (sums[at + length] - sums[at]) / static_cast<double>(length);
    }
  }
  return result;
}

/// Means over one length.
struct MeansOfLength {
  double variance = 0.0;        // of their third differences
  double error = 0.0;           // of its logarithm, standard deviation
  std::vector<double> weights;  // lagged_weights()

  /// Of noise of unit variance with that correlation of neighbouring samples.
  [[nodiscard]] double of_noise(double correlation) const {
    double sum = weights[0];
    double power = 2.0;
    for (std::size_t lag = 1; lag < weights.size(); ++lag) sum += (power *= correlation) * weights[lag];
    return sum;
  }
};

std::vector<MeansOfLength> means_of(std::span<const double> values) {
  std::vector<MeansOfLength> scales;
  for (std::size_t length = 1; kThirdDifference.size() * length <= values.size(); length *= 2) {
    MeansOfLength scale{.weights = lagged_weights(length)};
    std::vector<double> left = third_differences(values, length);
    double shared = 1.0;  // samples that share what they tell, of white noise
    for (std::size_t lag = 1; lag < scale.weights.size(); ++lag) {
      shared += 2.0 * std::pow(scale.weights[lag] / scale.weights[0], 2);
    }
    const double independent = static_cast<double>(left.size()) / shared;
    if (independent < static_cast<double>(tuning::kSamplesMin)) break;
    for (double& value : left) value = std::abs(value);
    // The median of the magnitude of a standard normal variable is 0.6745, its density there 0.6356.
    scale.variance = std::pow(upper_median(std::move(left)) / 0.6745, 2);
    scale.error = 1.0 / (0.6745 * 0.6356 * std::sqrt(independent));
    if (!(scale.variance > 0.0)) break;
    scales.push_back(std::move(scale));
  }
  return scales;
}

struct FittedParts {
  double size = 0.0;                                        // variance
  double share = 0.0;                                       // of the coloured part in it
  double correlation = 0.0;                                 // of neighbouring samples
  double misfit = std::numeric_limits<double>::infinity();  // sum of squares, each over its variance
};

/// Fits the size of noise whose third differences have these variances, up to a factor.
FittedParts with_size(std::span<const MeansOfLength> scales, std::span<const double> shape) {
  double sum = 0.0;
  double weight = 0.0;
  for (std::size_t i = 0; i < scales.size(); ++i) {
    sum += std::log(scales[i].variance / shape[i]) / std::pow(scales[i].error, 2);
    weight += 1.0 / std::pow(scales[i].error, 2);
  }
  const double mean = sum / weight;
  double misfit = 0.0;
  for (std::size_t i = 0; i < scales.size(); ++i) {
    misfit += std::pow((std::log(scales[i].variance / shape[i]) - mean) / scales[i].error, 2);
  }
  return {.size = std::exp(mean), .misfit = misfit};
}

/// Of noise of unit variance.
std::vector<double> variances_of(std::span<const MeansOfLength> scales, double correlation) {
  std::vector<double> shape;
  for (const MeansOfLength& scale : scales) shape.push_back(scale.of_noise(correlation));
  return shape;
}

FittedParts fitted_parts(std::span<const MeansOfLength> scales, std::span<const double> values) {
  const std::vector<double> white = variances_of(scales, 0.0);
  FittedParts best;
  const double most = mean_square(values);
  std::vector<double> shape(scales.size());
  // Correlated over a sample, up to the widest differences, in steps of a quarter octave.
  for (double samples = 1.0; samples <= static_cast<double>(scales.back().weights.size());
       samples *= std::sqrt(std::sqrt(2.0))) {
    const double correlation = std::exp(-1.0 / samples);
    const double squared = correlation * correlation;
    const double error = std::sqrt(2.0 * (1.0 + squared) / (1.0 - squared) / static_cast<double>(values.size()));
    const std::vector<double> coloured = variances_of(scales, correlation);
    const auto try_share = [&](double share) {
      for (std::size_t i = 0; i < shape.size(); ++i) shape[i] = (1.0 - share) * white[i] + share * coloured[i];
      FittedParts parts = with_size(scales, shape);
      parts.share = share;
      parts.correlation = correlation;
      parts.misfit += std::pow(std::max(0.0, std::log(parts.size / most)) / error, 2);
      if (parts.misfit < best.misfit) best = parts;
    };
    // From a thousandth of the other part to a thousand times as much.
    for (double ratio = 0.001; ratio < 1000.0; ratio *= std::sqrt(2.0)) try_share(ratio / (1.0 + ratio));
    try_share(1.0);
  }
  return best;
}

/// What a sum of so many squares of standard normal variables exceeds in one of 200 cases (Wilson and Hilferty, 1931).
double squares_by_chance(std::size_t count) {
  const double part = 2.0 / (9.0 * static_cast<double>(count));
  return static_cast<double>(count) * std::pow(1.0 - part + tuning::kTwoSided99 * std::sqrt(part), 3);
}

}  // namespace

NoiseParts noise_parts(std::span<const double> remainder, double period_s) {
  std::vector<MeansOfLength> scales = means_of(remainder);
  const std::size_t parameters = 3;
  for (; scales.size() > parameters; scales.pop_back()) {
    const FittedParts white = with_size(scales, variances_of(scales, 0.0));
    const FittedParts both = fitted_parts(scales, remainder);
    if (both.misfit > squares_by_chance(scales.size() - parameters)) continue;
    // Two more parameters gain more than x in exp(-x / 2) of all cases, at each of as many times as there are lengths.
    const double by_chance = 2.0 * std::log(static_cast<double>(scales.size()) / tuning::kFalseAlarms);
    const bool is_near = mean_square(remainder) <= std::pow(tuning::kNearFloor, 2) * both.size;
    if (white.misfit - both.misfit < by_chance || !is_near) return {.white = std::sqrt(white.size)};
    return {.white = std::sqrt((1.0 - both.share) * both.size),
            .coloured = std::sqrt(both.share * both.size),
            .correlation_time_s = -period_s / std::log(both.correlation)};
  }
  return {};
}

}  // namespace hybridtest
