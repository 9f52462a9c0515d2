#include "diagnosis/identification/coloured_noise.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <cstddef>
#include <unsupported/Eigen/FFT>

#include "diagnosis/tuning.hpp"

namespace hybridtest {
namespace {

/// Whether so many sums of products take fewer operations than a Fourier transform there and back does.
bool sums_are_cheaper(Eigen::Index samples, Eigen::Index lags, std::size_t transformed) {
  const auto size = static_cast<double>(transformed);
  return 2.0 * static_cast<double>(samples) * static_cast<double>(lags) <= 5.0 * size * std::log2(size);
}

/// Sums of products of a signal's values that are so many samples apart, from none to `lags` - 1.
/// @param signals   one column each. @return   one column each, one row per lag.
Eigen::MatrixXd lagged_products(const Eigen::MatrixXd& signals, Eigen::Index lags) {
  const Eigen::Index n = signals.rows();
  // Zeros stand behind the values, so that no product of the transform goes round their end.
  const auto size = std::bit_ceil(static_cast<std::size_t>(n + lags));
  Eigen::MatrixXd sums(lags, signals.cols());
  if (sums_are_cheaper(n, lags, size)) {
    for (Eigen::Index i = 0; i < signals.cols(); ++i) {
      const auto values = signals.col(i);
      for (Eigen::Index lag = 0; lag < lags; ++lag) sums(lag, i) = values.head(n - lag).dot(values.tail(n - lag));
    }
    return sums;
  }
  Eigen::FFT<double> transform;  // keeps its factors from one signal to the next
  transform.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  Eigen::VectorXcd spectrum;
  for (Eigen::Index i = 0; i < signals.cols(); ++i) {
    Eigen::VectorXd padded = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(size));
    padded.head(n) = signals.col(i);
    transform.fwd(spectrum, padded);
    spectrum = spectrum.cwiseAbs2().cast<std::complex<double>>().eval();
    transform.inv(padded, spectrum, padded.size());
    sums.col(i) = padded.head(lags);
  }
  return sums;
}

/// How many of the autocovariances count: up to the first lag beyond so many of their integrated times.
Eigen::Index counted(const Eigen::VectorXd& sums) {
  double time = 1.0;
  Eigen::Index lag = 1;
  for (; lag < sums.size() && static_cast<double>(lag) <= tuning::kCorrelationTimes * time; ++lag) {
    if (sums[0] > 0.0) time += 2.0 * sums[lag] / sums[0];
  }
  return lag;
}

}  // namespace

ColouredNoise::ColouredNoise(const Eigen::VectorXd& residual) : samples_{residual.size()} {
  // Most noise is known by a few lags; all are computed where these do not suffice.
  const auto few = std::min<Eigen::Index>(samples_, std::bit_width(static_cast<std::size_t>(samples_)));
  covariances_ = lagged_products(residual, few);
  Eigen::Index lags = counted(covariances_);
  if (lags == few && few < samples_) {
    covariances_ = lagged_products(residual, samples_);
    lags = counted(covariances_);
  }
  covariances_.conservativeResize(lags);
}

Eigen::VectorXd ColouredNoise::variances_along(const Eigen::MatrixXd& directions) const {
  const Eigen::Index lags = covariances_.size();
  Eigen::VectorXd weighted = 2.0 * covariances_;
  for (Eigen::Index lag = 0; lag < lags; ++lag) {
    weighted[lag] *= 1.0 - static_cast<double>(lag) / static_cast<double>(lags);
  }
  weighted[0] = covariances_[0];
  const Eigen::VectorXd sums = lagged_products(directions, lags).transpose() * weighted;
  return sums.cwiseMax(0.0) / static_cast<double>(samples_);
}

double ColouredNoise::independent_samples() const {
  const auto n = static_cast<double>(samples_);
  if (!(covariances_[0] > 0.0)) return n;
  const double time = 2.0 * covariances_.sum() / covariances_[0] - 1.0;
  return std::clamp(n / std::max(time, 1.0), 1.0, n);
}

std::optional<double> noise_of_neighbours(const Eigen::VectorXd& values) {
  if (values.size() <= static_cast<Eigen::Index>(tuning::kSamplesMin)) return {};
  const auto apart = [&](Eigen::Index lag) {
    const Eigen::Index count = values.size() - lag;
    return 0.5 * (values.tail(count) - values.head(count)).squaredNorm() / static_cast<double>(count);
  };
  const double one = apart(1);
  const double grown = apart(2) - one;
  if (!(grown > 0.0)) return std::sqrt(one);  // white
  // Of c (1 - r^lag) with a correlation r of neighbours, the growth from 2 to 4 over that from 1 to 2 is r (1 + r).
  const double growth = std::max(0.0, (apart(4) - apart(2)) / grown);
  const double correlation = 0.5 * (std::sqrt(1.0 + 4.0 * growth) - 1.0);
  if (!(correlation < 1.0)) return {};
  const double coloured = correlation > 0.0 ? grown / (correlation * (1.0 - correlation)) : 0.0;
  const double all = correlation > 0.0 ? one + coloured * correlation : apart(2);
  const double expected = all - coloured * std::pow(correlation, 8);
  if (std::abs(apart(8) - expected) > (tuning::kSmoothingLeaves - 1.0) * expected) return {};
  return std::sqrt(all);
}

double independent_samples(const Eigen::VectorXd& values) {
  // Of none there is one.
  return values.size() == 0 ? 1.0 : ColouredNoise{values}.independent_samples();
}

}  // namespace hybridtest
