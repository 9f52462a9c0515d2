#include "diagnosis/signals/signals.hpp"

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/assert.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {

double mean_square(std::span<const double> values) noexcept {
  if (values.empty()) return 0.0;
  return std::inner_product(values.begin(), values.end(), values.begin(), 0.0) / static_cast<double>(values.size());
}

std::vector<double> displacements_of(std::span<const Motion> motion) {
  std::vector<double> displacement_m(motion.size());
  std::ranges::transform(motion, displacement_m.begin(), &Motion::displacement_m);
  return displacement_m;
}

double variance(std::span<const double> values) noexcept {
  if (values.empty()) return 0.0;
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  double sum = 0.0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return sum / static_cast<double>(values.size());
}

std::vector<Reversal> reversals_of(std::span<const double> displacement_m, double threshold_m) {
  std::vector<Reversal> found;
  if (displacement_m.empty()) return found;
  std::size_t highest = 0;
  std::size_t lowest = 0;
  int direction = 0;  // unknown until the motion has gone by the threshold
  for (std::size_t i = 1; i < displacement_m.size(); ++i) {
    const double x = displacement_m[i];
    if (direction >= 0 && x > displacement_m[highest]) highest = i;
    if (direction <= 0 && x < displacement_m[lowest]) lowest = i;
    if (direction >= 0 && displacement_m[highest] - x > threshold_m) {
      // At the start the motion has come from nowhere: a place, not a turn.
      if (direction > 0) found.push_back({highest, displacement_m[highest]});
      direction = -1;
      lowest = i;
    } else if (direction <= 0 && x - displacement_m[lowest] > threshold_m) {
      if (direction < 0) found.push_back({lowest, displacement_m[lowest]});
      direction = 1;
      highest = i;
    }
  }
  return found;
}

double reversal_threshold_m(std::span<const double> displacement_m) {
  if (displacement_m.empty()) return 0.0;
  const auto [low, high] = std::minmax_element(displacement_m.begin(), displacement_m.end());
  return tuning::kReversalShare * (*high - *low);
}

std::vector<double> distance_since_reversal_m(std::span<const double> displacement_m,
                                              const std::vector<Reversal>& reversals) {
  std::vector<double> distance(displacement_m.size());
  double last_m = displacement_m.empty() ? 0.0 : displacement_m.front();
  auto next = reversals.begin();
  for (std::size_t i = 0; i < displacement_m.size(); ++i) {
    if (next != reversals.end() && next->sample <= i) last_m = (next++)->displacement_m;
    distance[i] = std::abs(displacement_m[i] - last_m);
  }
  return distance;
}

std::vector<double> cycles_completed(std::size_t samples, const std::vector<Reversal>& reversals) {
  std::vector<double> cycles(samples);
  std::size_t turns = 0;
  for (std::size_t i = 0; i < samples; ++i) {
    while (turns < reversals.size() && reversals[turns].sample <= i) ++turns;
    const std::size_t whole_cycles = turns / 2;
    cycles[i] = static_cast<double>(whole_cycles);
  }
  return cycles;
}

double span_of(std::span<const double> values) {
  if (values.empty()) return 0.0;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

std::vector<RestStretch> rest_stretches(std::span<const double> motion_m, double period_s, double share_of_span) {
  const auto length = std::max<std::size_t>(2, static_cast<std::size_t>(std::ceil(tuning::kRestLength_s / period_s)));
  const double allowed_m = share_of_span * span_of(motion_m);
  std::vector<RestStretch> found;
  for (std::size_t begin = 0; begin + length <= motion_m.size(); begin += length) {
    if (span_of(motion_m.subspan(begin, length)) <= allowed_m) found.push_back({begin, length});
  }
  return found;
}

namespace {

constexpr Eigen::Index kCoefficients = tuning::kSmoothingDegree + 1;

double mean_square_difference(std::span<const double> values, const std::vector<double>& smooth) {
  double sum = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) sum += (values[i] - smooth[i]) * (values[i] - smooth[i]);
  return sum / static_cast<double>(values.size());
}

/// Variance of the noise if what the polynomials leave is white.
double implied_variance(std::span<const double> values, std::size_t half_width) {
  const LocalPolynomial polynomial{half_width, 1.0};
  return mean_square_difference(values, polynomial.smooth(values)) / (1.0 - polynomial.noise_share());
}

}  // namespace

LocalPolynomial::LocalPolynomial(std::size_t half_width, double sample_period_s) : half_width_{half_width} {
  HYBRIDTEST_ASSERT(half_width >= kHalfWidthMin && sample_period_s > 0.0);
  const auto points = static_cast<Eigen::Index>(2 * half_width + 1);
  const auto half = static_cast<double>(half_width);
  Eigen::MatrixXd powers(points, kCoefficients);
  const auto place = [&](Eigen::Index row) { return (static_cast<double>(row) - half) / half; };
  for (Eigen::Index row = 0; row < points; ++row) {
    for (Eigen::Index k = 0; k < kCoefficients; ++k) powers(row, k) = std::pow(place(row), static_cast<double>(k));
  }
  const Eigen::MatrixXd fit =
      powers.colPivHouseholderQr().solve(Eigen::MatrixXd::Identity(points, points));  // samples -> coefficients
  const double unit_s = half * sample_period_s;
  weights_.resize(3 * points, points);
  for (Eigen::Index row = 0; row < points; ++row) {
    const double t = place(row);
    Eigen::Matrix<double, 3, kCoefficients> evaluate;
    evaluate << 1.0, t, t * t, t * t * t, t * t * t * t,                                      //
        0.0, 1.0 / unit_s, 2.0 * t / unit_s, 3.0 * t * t / unit_s, 4.0 * t * t * t / unit_s,  //
        0.0, 0.0, 2.0 / (unit_s * unit_s), 6.0 * t / (unit_s * unit_s), 12.0 * t * t / (unit_s * unit_s);
    weights_.middleRows(3 * row, 3) = evaluate * fit;
  }
}

Eigen::Vector3d LocalPolynomial::at(std::span<const double> window, std::size_t row) const {
  const Eigen::Map<const Eigen::VectorXd> samples{window.data(), weights_.cols()};
  return weights_.middleRows(static_cast<Eigen::Index>(3 * row), 3) * samples;
}

std::vector<Motion> LocalPolynomial::motion(std::span<const double> displacement_m) const {
  const std::size_t points = 2 * half_width_ + 1;
  HYBRIDTEST_ASSERT(displacement_m.size() >= points);
  std::vector<Motion> motion(displacement_m.size());
  for (std::size_t i = 0; i < motion.size(); ++i) {
    const std::size_t begin = std::min(i < half_width_ ? 0 : i - half_width_, motion.size() - points);
    const Eigen::Vector3d values = at(displacement_m.subspan(begin, points), i - begin);
    motion[i] = {values[0], values[1], values[2]};
  }
  return motion;
}

std::vector<double> LocalPolynomial::smooth(std::span<const double> values) const {
  const std::vector<Motion> smoothed = motion(values);
  std::vector<double> result(values.size());
  std::ranges::transform(smoothed, result.begin(), &Motion::displacement_m);
  return result;
}

double LocalPolynomial::noise_share() const noexcept {
  // Of a projection the squares of a row's weights add up to its diagonal weight.
  return weights_(static_cast<Eigen::Index>(3 * half_width_), static_cast<Eigen::Index>(half_width_));
}

double peak_of_noise(double deviation, std::size_t draws) {
  return deviation * std::sqrt(2.0 * std::log(static_cast<double>(draws)));
}

double upper_median(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::ranges::nth_element(values, middle);
  return *middle;
}

double white_noise_level(std::span<const double> values) {
  return std::sqrt(implied_variance(values, LocalPolynomial::kHalfWidthMin));
}

double typical_white_noise(std::span<const double> values) {
  const LocalPolynomial polynomial{LocalPolynomial::kHalfWidthMin, 1.0};
  std::vector<double> left = polynomial.smooth(values);
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = std::abs(values[i] - left[i]);
  // The median of the magnitude of a standard normal variable is 0.6745.
  return upper_median(std::move(left)) / (0.6745 * std::sqrt(1.0 - polynomial.noise_share()));
}

std::size_t widest_faithful_half_width(std::span<const double> values) {
  const double allowed = tuning::kSmoothingLeaves * implied_variance(values, tuning::kSmoothingHalfWidths.front()) +
                         tuning::kRoundingVariance * mean_square(values);
  std::size_t widest = tuning::kSmoothingHalfWidths.front();
  for (const std::size_t half_width : tuning::kSmoothingHalfWidths) {
    if (2 * half_width + 1 > values.size() || implied_variance(values, half_width) > allowed) break;
    widest = half_width;
  }
  return widest;
}

namespace {

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
  const auto reach = static_cast<std::size_t>(
      std::ceil(tuning::kSmootherReach * deviation * std::sqrt(static_cast<double>(kPowers.size()))));
  for (std::size_t i = 0; i <= reach; ++i) weights_.push_back(weight_at(static_cast<double>(i), deviation));
  double sum = -weights_.front();
  for (const double weight : weights_) sum += 2.0 * weight;
  for (double& weight : weights_) weight /= sum;
}

std::vector<double> FlatSmoother::smooth(std::span<const double> values) const {
  // In stretches that stay in the cache while all weights go over them.
  const auto length = static_cast<Eigen::Index>(16 * weights_.size());
  const auto samples = static_cast<Eigen::Index>(values.size());
  const Eigen::Map<const Eigen::ArrayXd> given{values.data(), samples};
  std::vector<double> result(values.size());
  Eigen::Map<Eigen::ArrayXd> sums{result.data(), samples};
  for (Eigen::Index begin = 0; begin < samples; begin += length) {
    const Eigen::Index end = std::min(samples, begin + length);
    auto stretch = sums.segment(begin, end - begin);
    stretch = weights_.front() * given.segment(begin, end - begin);
    for (Eigen::Index k = 1; k < std::ssize(weights_); ++k) {
      const double weight = weights_[static_cast<std::size_t>(k)];
      const Eigen::Index before = std::max(begin, k);
      const Eigen::Index after = std::min(end, samples - k);
      if (before < end) sums.segment(before, end - before) += weight * given.segment(before - k, end - before);
      if (after > begin) sums.segment(begin, after - begin) += weight * given.segment(begin + k, after - begin);
    }
  }
  // At the ends, by the weights of the samples that exist.
  Eigen::ArrayXd existing = Eigen::ArrayXd::Ones(samples);
  double missing = 0.0;
  for (Eigen::Index k = std::ssize(weights_) - 1; k > 0; --k) {
    missing += weights_[static_cast<std::size_t>(k)];
    if (k > samples) continue;
    existing[k - 1] -= missing;
    existing[samples - k] -= missing;
  }
  sums /= existing;
  return result;
}

std::vector<Motion> FlatSmoother::smooth(std::vector<Motion> motion) const {
  for (double Motion::*channel : {&Motion::displacement_m, &Motion::velocity_m_per_s, &Motion::acceleration_m_per_s2}) {
    std::vector<double> values(motion.size());
    std::ranges::transform(motion, values.begin(), [channel](const Motion& at) { return at.*channel; });
    values = smooth(values);
    for (std::size_t i = 0; i < motion.size(); ++i) motion[i].*channel = values[i];
  }
  return motion;
}

double FlatSmoother::noise_share() const noexcept {
  double sum = -weights_.front() * weights_.front();
  for (const double weight : weights_) sum += 2.0 * weight * weight;
  return sum;
}

}  // namespace hybridtest
