#include "diagnosis/signals/local_polynomial.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/assert.hpp"

namespace hybridtest {
namespace {

constexpr Eigen::Index kCoefficients = 5;

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

double mean_square(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return sum / static_cast<double>(values.size());
}

}  // namespace

LocalPolynomial::LocalPolynomial(std::size_t half_width, double sample_period_s) : half_width_{half_width} {
  HYBRIDTEST_ASSERT(half_width >= kSmallestHalfWidth && sample_period_s > 0.0);
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

double white_noise_level(std::span<const double> values) {
  return std::sqrt(implied_variance(values, LocalPolynomial::kSmallestHalfWidth));
}

std::size_t widest_faithful_half_width(std::span<const double> values) {
  // A fifth more than white noise alone would leave: the smoothing error then stays below half the noise.
  constexpr double kFaithful = 1.2;
  // Rounding of the values themselves.
  constexpr double kRounding = 1e-24;
  constexpr std::array<std::size_t, 9> kHalfWidths{3, 4, 5, 7, 10, 14, 20, 28, 40};
  const double allowed = kFaithful * implied_variance(values, kHalfWidths.front()) + kRounding * mean_square(values);
  std::size_t widest = kHalfWidths.front();
  for (const std::size_t half_width : kHalfWidths) {
    if (2 * half_width + 1 > values.size() || implied_variance(values, half_width) > allowed) break;
    widest = half_width;
  }
  return widest;
}

}  // namespace hybridtest
