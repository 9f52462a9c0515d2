#pragma once

#include "core/interface_vector.hpp"

namespace hybridtest {

/// Tracking indicator (Mercan and Ricles, 2009) over a sliding exponential window.
///
/// In one sample the indicator grows by half the difference of the areas that the synchronisation
/// subspace plot of measured displacement m against target c encloses with its two axes,
/// dT = 1/2 (c' m - c m'), c' and m' the values of the sample before. For a sine of amplitude X
/// that is measured with a phase lag phi, dT is 1/2 X^2 sin(phi) sin(omega dt) in each sample.
/// Means of dT, of c^2 and of the squared change of c over a sliding exponential window then
/// give, for any amplitude and frequency,
///
///   lag_sine = mean(dT) / sqrt(mean(c^2) mean(dc^2)) = sin(phi) cos(omega dt / 2),
///
/// positive when the measured displacement lags and negative when it leads; a gain g of the
/// measurement multiplies it. Motion smaller than `displacement_m_min` in a window counts as
/// that large, so that noise at rest is not a lag. One value per degree of freedom; a value type.
class TrackingIndicator {
 public:
  TrackingIndicator() = default;
  /// @param window_s   time constant of forgetting, at least one period.
  TrackingIndicator(int dofs, double period_s, double window_s, double displacement_m_min) noexcept;

  /// The values must be finite: another one would stay in the means.
  void sample(const SiteVector& wanted_m, const SiteVector& measured_m) noexcept;

  /// Of the degree of freedom where it is largest in magnitude, with its sign [-].
  [[nodiscard]] double lag_sine() const noexcept { return lag_sine_; }

 private:
  [[nodiscard]] double largest_lag_sine() const noexcept;

  double kept_ = 0.0;                  // share of a mean that remains after one sample
  double square_m2_min_ = 0.0;         // added to mean(c^2)
  double change_square_m2_min_ = 0.0;  // added to mean(dc^2)
  bool has_sample_ = false;
  double lag_sine_ = 0.0;
  SiteVector wanted_m_;
  SiteVector measured_m_;
  SiteVector mean_growth_m2_;
  SiteVector mean_square_m2_;
  SiteVector mean_change_square_m2_;
};

}  // namespace hybridtest
