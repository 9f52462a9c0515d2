#include "diagnosis/signals/flat_smoother.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/assert.hpp"

namespace hybridtest {
namespace {

/// Weights are left out beyond so many deviations of the widest part: 3e-4 of its largest.
constexpr double kReach = 4.0;

/// 1 - (1 - g)^3 = 3 g - 3 g^2 + g^3, and the k-th power of a normal distribution is one of k times the variance.
constexpr std::array kPowers{3.0, -3.0, 1.0};

double weight_at(double samples, double deviation) {
  if (deviation == 0.0) return 1.0;
  double weight = 0.0;
  for (std::size_t k = 0; k < kPowers.size(); ++k) {
    const double variance = deviation * deviation * static_cast<double>(k + 1);
    weight += kPowers[k] * std::exp(-0.5 * samples * samples / variance) / std::sqrt(variance);
  }
  return weight;
}

}  // namespace

FlatSmoother::FlatSmoother(double deviation) {
  HYBRIDTEST_ASSERT(deviation >= 0.0);
  const auto reach =
      static_cast<std::size_t>(std::ceil(kReach * deviation * std::sqrt(static_cast<double>(kPowers.size()))));
  for (std::size_t i = 0; i <= reach; ++i) weights_.push_back(weight_at(static_cast<double>(i), deviation));
  double sum = -weights_.front();
  for (const double weight : weights_) sum += 2.0 * weight;
  for (double& weight : weights_) weight /= sum;
}

std::vector<double> FlatSmoother::smooth(std::span<const double> values) const {
  std::vector<double> result(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    double sum = weights_.front() * values[i];
    double weight = weights_.front();
    for (std::size_t k = 1; k < weights_.size(); ++k) {
      if (k <= i) {
        sum += weights_[k] * values[i - k];
        weight += weights_[k];
      }
      if (i + k < values.size()) {
        sum += weights_[k] * values[i + k];
        weight += weights_[k];
      }
    }
    result[i] = sum / weight;
  }
  return result;
}

double FlatSmoother::noise_share() const noexcept {
  double sum = -weights_.front() * weights_.front();
  for (const double weight : weights_) sum += 2.0 * weight * weight;
  return sum;
}

}  // namespace hybridtest
