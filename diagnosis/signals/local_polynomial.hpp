#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "plant/effects/effect.hpp"

namespace hybridtest {

/// Motion from sampled displacements: a polynomial of degree 4 through the 2 m + 1 samples around
/// each one, by least squares (Savitzky and Golay, 1964). Zero phase; towards the ends, where no
/// window fits around a sample, the outermost window's polynomial is evaluated off its centre.
class LocalPolynomial {
 public:
  static constexpr std::size_t kSmallestHalfWidth = 3;

  /// @param half_width   m in samples, at least kSmallestHalfWidth.
  LocalPolynomial(std::size_t half_width, double sample_period_s);

  /// @param displacement_m   at least 2 m + 1 samples.
  [[nodiscard]] std::vector<Motion> motion(std::span<const double> displacement_m) const;
  /// The displacement alone.
  [[nodiscard]] std::vector<double> smooth(std::span<const double> values) const;
  /// Share of white noise variance that smoothing leaves.
  [[nodiscard]] double noise_share() const noexcept;

 private:
  [[nodiscard]] Eigen::Vector3d at(std::span<const double> window, std::size_t row) const;

  std::size_t half_width_;
  // Weights of value, first and second derivative at each place of the window, 3 rows per place.
  Eigen::MatrixXd weights_;
};

/// Standard deviation of the white part of a signal: what a narrow local polynomial leaves. An
/// upper limit for signals with content up to half the sampling rate.
/// @param values   at least 7 samples.
[[nodiscard]] double white_noise_level(std::span<const double> values);

/// The widest window whose polynomials still leave no more than white noise of that level, so that
/// derivatives are as quiet as the motion allows.
[[nodiscard]] std::size_t widest_faithful_half_width(std::span<const double> values);

}  // namespace hybridtest
