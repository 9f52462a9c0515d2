#pragma once

#include <Eigen/Core>
#include <optional>

namespace hybridtest {

/// Noise of any colour that is the same throughout a residual: what is known of it are its autocovariances, up to the
/// first lag beyond five times the integrated autocorrelation time 1 + 2 sum r(k) (Sokal, Monte Carlo Methods in
/// Statistical Mechanics, 1997).
class ColouredNoise {
 public:
  /// @param residual   in any unit; not empty.
  explicit ColouredNoise(const Eigen::VectorXd& residual);

  /// Variances of the products of directions with the noise, with Bartlett's weights, which keep them positive (Newey
  /// and West, Econometrica 55, 1987). In squares of the residual's unit.
  /// @param directions   one column each, one row per sample.
  [[nodiscard]] Eigen::VectorXd variances_along(const Eigen::MatrixXd& directions) const;

  /// Samples over the integrated autocorrelation time. At least 1, at most all.
  [[nodiscard]] double independent_samples() const;

 private:
  Eigen::Index samples_ = 0;
  Eigen::VectorXd covariances_;  // times the number of samples, from lag 0 on
};

/// Root mean square of noise that is white, first-order autoregressive, or both together, in a remainder that may hold
/// something slower besides: by half the mean squares of differences between values 1, 2 and 4 samples apart, which
/// grow towards the noise's. Nothing where those 8 samples apart are not as these say: there is something else in it.
[[nodiscard]] std::optional<double> noise_of_neighbours(const Eigen::VectorXd& values);

/// See ColouredNoise::independent_samples().
[[nodiscard]] double independent_samples(const Eigen::VectorXd& values);

}  // namespace hybridtest
