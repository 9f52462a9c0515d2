#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "compensation/compensator.hpp"
#include "compensation/time_series_model.hpp"

namespace hybridtest {

/// Conditional adaptive time series (after Palacio-Betancur and Gutierrez Soto, Mech. Syst. Signal
/// Process. 134, 2019).
///
///     command = a0 x + a1 x' + a2 x''
///
/// as the adaptive time series (adaptive_time_series.hpp), but with recursive least squares with
/// forgetting in place of the moving window,
///
///     S <- (1 - T/memory) S + row row'
///
/// and with conditions on every update: the measured motion is above a threshold, and the new value
/// of the coefficient is inside its range; a coefficient that fails stays where it is.
///
/// Interpretation: the paper's text was not at hand. That it replaces the window by a recursion and
/// makes updates conditional is from its abstract and from later papers; the exact conditions, the
/// forgetting and the use of the rates of the adaptive time series are ours. `window_s` is the memory.
class ConditionalAdaptiveTimeSeries final : public Compensator {
 public:
  using Parameters = TimeSeriesParameters;

  /// @throws ConfigError for parameters outside their ranges.
  ConditionalAdaptiveTimeSeries(const Parameters& parameters, double control_period_s);

  [[nodiscard]] double command(const CompensatorInput& input) noexcept override;
  void reset() noexcept override;

  /// a0 [], a1 [s], a2 [s2].
  [[nodiscard]] const Eigen::Vector3d& coefficients() const noexcept { return model_.coefficients(); }

 private:
  TimeSeriesModel model_;
  double keep_;
  std::size_t observed_ = 0;
  Eigen::Matrix4d sum_ = Eigen::Matrix4d::Zero();
};

}  // namespace hybridtest
