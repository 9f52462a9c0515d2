#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "compensation/compensator.hpp"
#include "compensation/time_series_model.hpp"

namespace hybridtest {

/// Adaptive time series of second order (Chae, Kazemibidokhti and Ricles, Earthquake Engng Struct.
/// Dyn. 42, 2013).
///
///     command = a0 x + a1 x' + a2 x'',   (a0, a1, a2) = (X'X)^-1 X'U
///
/// X the measured displacement and its derivatives, U the commands sent, both low-passed
/// (time_series_model.hpp), over a moving window of one second. From when the window is full, and
/// while the measured motion in it is above a threshold, each coefficient follows its least-squares
/// value inside its range and no faster than its rate. Target, velocity x' and acceleration x'' are
/// the integrator's.
///
/// With a0 = 1, a1 = a2 = 0 the identity. As published the target is differentiated in the
/// compensator and only every so-many-th sample is put into the fit; this one has the integrator's
/// derivatives and uses every sample. Order and corner of the filter are choices.
class AdaptiveTimeSeries final : public Compensator {
 public:
  using Parameters = TimeSeriesParameters;

  /// @throws ConfigError for parameters outside their ranges.
  AdaptiveTimeSeries(const Parameters& parameters, double control_period_s);

  [[nodiscard]] double command(const CompensatorInput& input) noexcept override;
  void reset() noexcept override;

  /// a0 [], a1 [s], a2 [s2].
  [[nodiscard]] const Eigen::Vector3d& coefficients() const noexcept { return model_.coefficients(); }

 private:
  void slide(const TimeSeriesModel::Row& row) noexcept;

  TimeSeriesModel model_;
  std::vector<TimeSeriesModel::Row> rows_;
  std::size_t oldest_ = 0;
  bool is_full_ = false;
  Eigen::Matrix4d sum_ = Eigen::Matrix4d::Zero();
  // Sum of the rows since the ring began anew; takes the place of sum_ when it is full again, so that
  // the rounding of a subtraction lives no longer than a window.
  Eigen::Matrix4d fresh_sum_ = Eigen::Matrix4d::Zero();
};

}  // namespace hybridtest
