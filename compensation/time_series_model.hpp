#pragma once

#include <Eigen/Core>

#include "compensation/compensator.hpp"
#include "compensation/low_pass.hpp"

namespace hybridtest {

/// What both adaptive time series are told. Ranges, rates and window as published by Chae,
/// Kazemibidokhti and Ricles (2013).
struct TimeSeriesParameters {
  // At first: published are 1, the delay, delay^2/2. Within their ranges below.
  double a0 = 1.0;             // []
  double a1_s = 0.020;         // [s]
  double a2_s2 = 0.0002;       // [s2]
  double window_s = 1.0;       // [s] of the least squares, its memory in the conditional variant; 0.1 to 10
  double filter_hz = 20.0;     // [Hz] corner of the low-pass on both signals; 0.001 to 0.45 of the control rate
  double motion_m_min = 1e-4;  // [m] root mean square of the measurement below which nothing is learnt; 1e-9 to 1
  double a0_min = 0.7, a0_max = 1.3;           // [] 0 to 10
  double a1_s_min = 0.0, a1_s_max = 0.08;      // [s] 0 to 1
  double a2_s2_min = 0.0, a2_s2_max = 0.0032;  // [s2] 0 to 1
  double a0_rate_max = 2.0;                    // [1/s] 0 to 1000
  double a1_rate_s_max = 0.05;                 // [s/s] 0 to 100
  double a2_rate_s2_max = 0.001;               // [s2/s] 0 to 100
};

/// The transfer system seen backwards as a time series of second order: the command that was sent is
///
///     u = a0 x_m + a1 x_m' + a2 x_m'',
///
/// x_m the measurement, so that u = a0 x + a1 x' + a2 x'' brings it to the target x. Both u and x_m
/// pass the same low-pass; derivatives of x_m are backward differences.
class TimeSeriesModel {
 public:
  /// Regressors x_m, x_m', x_m'' and regressand u, scaled to like size.
  using Row = Eigen::Vector4d;
  using Coefficients = Eigen::Vector3d;

  /// @throws ConfigError for parameters outside their ranges.
  TimeSeriesModel(const TimeSeriesParameters& parameters, double control_period_s);

  /// Takes the newest measurement (held where it is not finite) and the command that it answers.
  [[nodiscard]] Row observe(double measured_displacement_m) noexcept;
  /// Least-squares coefficients of a sum of row * row'; not finite where the motion does not tell them.
  [[nodiscard]] Coefficients solve(const Eigen::Matrix4d& sum) const noexcept;
  /// Lets coefficient i go towards `wanted` by no more than its rate allows in one period.
  void approach(Eigen::Index i, double wanted) noexcept;
  /// The command for a target, remembered as the one sent.
  [[nodiscard]] double command(const CompensatorInput& input) noexcept;
  void reset() noexcept;

  [[nodiscard]] bool is_in_range(Eigen::Index i, double value) const noexcept {
    return value >= lower_(i) && value <= upper_(i);
  }
  [[nodiscard]] double clamped(Eigen::Index i, double value) const noexcept;
  [[nodiscard]] const Coefficients& coefficients() const noexcept { return coefficients_; }
  /// Control periods in the window.
  [[nodiscard]] std::size_t window() const noexcept { return window_; }
  /// Is the mean of squares of that many rows enough to learn from?
  [[nodiscard]] bool is_motion(const Eigen::Matrix4d& sum) const noexcept;

 private:
  double control_period_s_;
  std::size_t window_;
  double least_square_sum_m2_;
  Coefficients initial_, lower_, upper_, step_max_, coefficients_;
  LowPass measured_filter_, command_filter_;
  double held_measurement_m_ = 0.0;
  double filtered_m_[2] = {0.0, 0.0};  // x_m one and two samples ago
  double sent_m_ = 0.0;
};

}  // namespace hybridtest
