#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <ranges>
#include <span>
#include <vector>

#include "diagnosis/tuning.hpp"
#include "plant/effects/effect.hpp"

namespace hybridtest {

/// The signals of one interface: constant sample period, all of the same length, finite.
struct GapSignals {
  double period_s = 0.0;
  std::span<const double> input_m;   // input displacement of the interface
  std::span<const double> measured;  // output [m] or [N]
  std::span<const double> residual;  // measured minus modelled, in the unit of `measured`

  [[nodiscard]] std::size_t size() const noexcept { return residual.size(); }
  [[nodiscard]] double duration_s() const noexcept { return static_cast<double>(size()) * period_s; }
};

/// Mean square; 0 for nothing.
[[nodiscard]] double mean_square(std::span<const double> values) noexcept;
/// Mean square about the mean.
[[nodiscard]] double variance(std::span<const double> values) noexcept;

/// The first value and every one that many samples behind the one before.
template <class Values>
[[nodiscard]] auto every_nth(const Values& values, std::size_t stride) {
  std::vector<std::ranges::range_value_t<Values>> kept;
  for (std::size_t i = 0; i < values.size(); i += stride) kept.push_back(values[i]);
  return kept;
}

/// One per sample.
[[nodiscard]] std::vector<double> displacements_of(std::span<const Motion> motion);

/// A reversal of the motion: it is found after the motion has come back by a threshold.
struct Reversal {
  std::size_t sample = 0;  // of the extreme
  double displacement_m = 0.0;
};

/// Extremes between which the motion goes by more than `threshold_m`, in order; maxima and minima in turn.
[[nodiscard]] std::vector<Reversal> reversals_of(std::span<const double> displacement_m, double threshold_m);

/// A threshold above the noise: a fiftieth of the whole range.
[[nodiscard]] double reversal_threshold_m(std::span<const double> displacement_m);

/// |displacement - displacement at the last reversal| at every sample; before the first, from the start.
[[nodiscard]] std::vector<double> distance_since_reversal_m(std::span<const double> displacement_m,
                                                            const std::vector<Reversal>& reversals);

/// Whole cycles completed at every sample: two reversals each.
[[nodiscard]] std::vector<double> cycles_completed(std::size_t samples, const std::vector<Reversal>& reversals);

struct RestStretch {
  std::size_t begin = 0;
  std::size_t count = 0;
};

/// Stretches of 0.2 s, side by side, in which the motion stays within this share of its whole span; within a thousandth
/// it rests.
[[nodiscard]] std::vector<RestStretch> rest_stretches(std::span<const double> motion_m, double period_s,
                                                      double share_of_span = tuning::kRestSpan);

/// Largest minus smallest value; 0 of none.
[[nodiscard]] double span_of(std::span<const double> values);

/// Motion from sampled displacements: a polynomial of degree 4 through the 2 m + 1 samples around
/// each one, by least squares (Savitzky and Golay, 1964). Zero phase; towards the ends, where no
/// window fits around a sample, the outermost window's polynomial is evaluated off its centre.
class LocalPolynomial {
 public:
  /// The narrowest window with more samples than coefficients.
  static constexpr std::size_t kHalfWidthMin = tuning::kSmoothingDegree / 2 + 1;

  /// @param half_width   m in samples, at least kHalfWidthMin.
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

/// The largest of so many independent draws of normal noise, as it is expected.
[[nodiscard]] double peak_of_noise(double deviation, std::size_t draws);

/// The one in the middle; of an even number the greater of the two.
/// @param values   at least one.
[[nodiscard]] double upper_median(std::vector<double> values);

/// Standard deviation of the white part of a signal: what a narrow local polynomial leaves. An
/// upper limit for signals with content up to half the sampling rate.
/// @param values   at least 7 samples.
[[nodiscard]] double white_noise_level(std::span<const double> values);

/// The same by the median of what the polynomial leaves: jumps of the signal, as of a dry friction at its reversals, do
/// not count. Of a signal that stands still over most samples it is 0.
[[nodiscard]] double typical_white_noise(std::span<const double> values);

/// The widest window whose polynomials still leave no more than white noise of that level, so that
/// derivatives have as little noise as the motion allows.
[[nodiscard]] std::size_t widest_faithful_half_width(std::span<const double> values);

/// Weighted mean of the samples around each one. The weights are those of a normal distribution of deviation s, applied
/// again to what they leave, and once more (twicing: Tukey, Exploratory Data Analysis, 1977): the gain at a frequency
/// f, 1 - (1 - g)^3 with g = exp(-(2 pi f s)^2 / 2), is flat to the sixth order at low ones and falls so steeply at
/// high ones that it removes the noise of a second derivative. Zero phase; at the ends only the existing samples are
/// weighted.
class FlatSmoother {
 public:
  /// @param deviation   s in samples; 0 changes nothing.
  explicit FlatSmoother(double deviation);

  [[nodiscard]] std::vector<double> smooth(std::span<const double> values) const;
  /// Displacement, velocity and acceleration alike.
  [[nodiscard]] std::vector<Motion> smooth(std::vector<Motion> motion) const;
  /// Samples on either side that take part.
  [[nodiscard]] std::size_t reach() const noexcept { return weights_.size() - 1; }
  /// Share of white noise variance that smoothing leaves.
  [[nodiscard]] double noise_share() const noexcept;

 private:
  std::vector<double> weights_;  // of the sample itself and of those 1, 2, … beside it; their sum both ways is 1
};

}  // namespace hybridtest
