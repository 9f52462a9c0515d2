#pragma once

#include <Eigen/Core>

#include "compensation/compensator.hpp"
#include "compensation/low_pass.hpp"
#include "core/parameters/parameter_archive.hpp"

namespace hybridtest {

/// What both adaptive time series are told. Ranges, rates and window as published by Chae,
/// Kazemibidokhti and Ricles (2013).
struct TimeSeriesParameters {
  // Published for the start: 1, the delay, half the delay squared.
  double a0 = 1.0;
  double a1_s = 0.020;
  double a2_s2 = 0.0002;
  double window_s = 1.0;
  double filter_hz = 20.0;
  double motion_m_min = 1e-4;
  double a0_min = 0.7, a0_max = 1.3;
  double a1_s_min = 0.0, a1_s_max = 0.08;
  double a2_s2_min = 0.0, a2_s2_max = 0.0032;
  double a0_rate_max = 2.0;
  double a1_rate_s_max = 0.05;
  double a2_rate_s2_max = 0.001;

  void serialize(ParameterArchive& archive) {
    constexpr Range kA0{.low = 0.0, .high = 10.0};
    constexpr Range kRate{.low = 0.0, .high = 100.0};
    constexpr const char* kFar = "no transfer system of a hybrid test is so far from its command";
    constexpr const char* kNoise = "a faster change would follow noise";
    archive.optional("a0", a0, {kA0, "at first", kFar, "`a0_min` to `a0_max`"});
    archive.optional("a1_s", a1_s, {kZeroToOne, "at first: the delay", kFar, "`a1_s_min` to `a1_s_max`"});
    archive.optional("a2_s2", a2_s2,
                     {kZeroToOne, "at first: half the delay squared", kFar, "`a2_s2_min` to `a2_s2_max`"});
    archive.optional("window_s", window_s,
                     {{.low = 0.1, .high = 10.0},
                      "of the least squares; the memory in the conditional variant",
                      "it holds some cycles of the structure"});
    archive.optional("filter_hz", filter_hz, kFilterHz);
    archive.optional("motion_m_min", motion_m_min,
                     {{.low = 1e-9, .high = 1.0},
                      "root mean square of the measurement below which nothing is learnt",
                      "coefficients learnt from sensor noise are noise"});
    archive.optional("a0_min", a0_min, {kA0, "bound of `a0`", kFar});
    archive.optional("a0_max", a0_max, {kA0, "bound of `a0`", kFar, "`a0_min` to 10"});
    archive.optional("a1_s_min", a1_s_min, {kZeroToOne, "bound of `a1_s`", kFar});
    archive.optional("a1_s_max", a1_s_max, {kZeroToOne, "bound of `a1_s`", kFar, "`a1_s_min` to 1"});
    archive.optional("a2_s2_min", a2_s2_min, {kZeroToOne, "bound of `a2_s2`", kFar});
    archive.optional("a2_s2_max", a2_s2_max, {kZeroToOne, "bound of `a2_s2`", kFar, "`a2_s2_min` to 1"});
    archive.optional(
        "a0_rate_max", a0_rate_max,
        {.range = {.low = 0.0, .high = 1000.0}, .what = "change of `a0`", .reason = kNoise, .unit = "1/s"});
    archive.optional("a1_rate_s_max", a1_rate_s_max,
                     {.range = kRate, .what = "change of `a1_s`", .reason = kNoise, .unit = "s/s"});
    archive.optional("a2_rate_s2_max", a2_rate_s2_max,
                     {.range = kRate, .what = "change of `a2_s2`", .reason = kNoise, .unit = "s²/s"});
  }
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
