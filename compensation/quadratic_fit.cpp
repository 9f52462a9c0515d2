#include "compensation/quadratic_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace hybridtest {

QuadraticFit::QuadraticFit(std::size_t points, std::size_t spacing, double sample_period_s)
    : points_{points}, spacing_{spacing}, weights_(points) {
  // value = a + b x + c x^2 over x from -1, the oldest, to 1, the newest: well conditioned.
  const auto row = [points](std::size_t i) {
    const double x = 1.0 - 2.0 * static_cast<double>(i) / static_cast<double>(points - 1);
    return Eigen::Vector3d{1.0, x, x * x};
  };
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < points; ++i) normal += row(i) * row(i).transpose();
  const double half_s = 0.5 * static_cast<double>(span() - 1) * sample_period_s;
  for (std::size_t i = 0; i < points; ++i) {
    const Eigen::Vector3d w = normal.ldlt().solve(row(i));
    // At the newest sample, by x = 1 + t / half.
    weights_[i] = {w(0) + w(1) + w(2), (w(1) + 2.0 * w(2)) / half_s, w(2) / (half_s * half_s)};
  }
}

Quadratic QuadraticFit::fit(const SampleHistory& history) const noexcept {
  Quadratic quadratic;
  for (std::size_t i = 0; i < points_; ++i) {
    const double value = history[i * spacing_];
    quadratic.constant += weights_[i][0] * value;
    quadratic.linear += weights_[i][1] * value;
    quadratic.square += weights_[i][2] * value;
  }
  return quadratic;
}

}  // namespace hybridtest
