#include "compensation/quadratic_fit.hpp"

#include <Eigen/Core>
#include <Eigen/QR>

namespace hybridtest {

QuadraticFit::QuadraticFit(std::size_t points, std::size_t spacing, double sample_period_s)
    : points_{points}, spacing_{spacing}, weights_(points) {
  // Time in units of the span, for the sake of the condition.
  const double unit_s = static_cast<double>(span() - 1) * sample_period_s;
  const auto rows = static_cast<Eigen::Index>(points);
  Eigen::MatrixX3d powers(rows, 3);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double t = -static_cast<double>(i) / static_cast<double>(rows - 1);
    powers.row(i) << 1.0, t, t * t;
  }
  const Eigen::MatrixXd weights = powers.householderQr().solve(Eigen::MatrixXd::Identity(rows, rows));
  for (Eigen::Index i = 0; i < rows; ++i) {
    weights_[static_cast<std::size_t>(i)] = {weights(0, i), weights(1, i) / unit_s, weights(2, i) / (unit_s * unit_s)};
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
