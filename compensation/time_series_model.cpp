#include "compensation/time_series_model.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {
namespace {

// Makes x, x' and x'' of like size at about 5 Hz, for the sake of the least squares.
const Eigen::Vector3d kScale{1.0, 1.0 / 30.0, 1.0 / 900.0};

void expect_inside(const std::string& name, double value, double low, double high, double high_max) {
  expect_in_range(name + "_max", high, {.low = low, .high = high_max}, "a range ends above its beginning");
  expect_in_range(name, value, {.low = low, .high = high}, "the coefficient starts inside its own range");
}

TimeSeriesParameters checked_ranges(const TimeSeriesParameters& parameters) {
  const TimeSeriesParameters p = checked(parameters);
  expect_inside("a0", p.a0, p.a0_min, p.a0_max, 10.0);
  expect_inside("a1_s", p.a1_s, p.a1_s_min, p.a1_s_max, 1.0);
  expect_inside("a2_s2", p.a2_s2, p.a2_s2_min, p.a2_s2_max, 1.0);
  return p;
}

}  // namespace

TimeSeriesModel::TimeSeriesModel(const TimeSeriesParameters& parameters, double control_period_s)
    : control_period_s_{checked_control_period(control_period_s)},
      window_{checked_periods("window_s", checked_ranges(parameters).window_s, control_period_s, 10,
                              "three coefficients are fitted in it")},
      least_square_sum_m2_{parameters.motion_m_min * parameters.motion_m_min * static_cast<double>(window_)},
      initial_{parameters.a0, parameters.a1_s, parameters.a2_s2},
      lower_{parameters.a0_min, parameters.a1_s_min, parameters.a2_s2_min},
      upper_{parameters.a0_max, parameters.a1_s_max, parameters.a2_s2_max},
      step_max_{Eigen::Vector3d{parameters.a0_rate_max, parameters.a1_rate_s_max, parameters.a2_rate_s2_max} *
                control_period_s},
      coefficients_{initial_},
      measured_filter_{parameters.filter_hz, control_period_s},
      command_filter_{parameters.filter_hz, control_period_s} {}

TimeSeriesModel::Row TimeSeriesModel::observe(double measured_displacement_m) noexcept {
  if (std::isfinite(measured_displacement_m)) held_measurement_m_ = measured_displacement_m;
  const double x = measured_filter_.filter(held_measurement_m_);
  const double velocity = (x - filtered_m_[0]) / control_period_s_;
  const double acceleration = (x - 2.0 * filtered_m_[0] + filtered_m_[1]) / (control_period_s_ * control_period_s_);
  filtered_m_[1] = filtered_m_[0];
  filtered_m_[0] = x;
  return {x * kScale(0), velocity * kScale(1), acceleration * kScale(2), command_filter_.filter(sent_m_)};
}

TimeSeriesModel::Coefficients TimeSeriesModel::solve(const Eigen::Matrix4d& sum) const noexcept {
  const Eigen::Matrix3d normal = sum.topLeftCorner<3, 3>();
  const Eigen::Vector3d right = sum.topRightCorner<3, 1>();
  return normal.ldlt().solve(right).cwiseProduct(kScale);
}

double TimeSeriesModel::clamped(Eigen::Index i, double value) const noexcept {
  return std::clamp(value, lower_(i), upper_(i));
}

void TimeSeriesModel::approach(Eigen::Index i, double wanted) noexcept {
  coefficients_(i) += std::clamp(wanted - coefficients_(i), -step_max_(i), step_max_(i));
}

bool TimeSeriesModel::is_motion(const Eigen::Matrix4d& sum) const noexcept { return sum(0, 0) >= least_square_sum_m2_; }

double TimeSeriesModel::command(const CompensatorInput& input) noexcept {
  const double command_m = coefficients_(0) * input.target_m + coefficients_(1) * input.target_velocity_m_per_s +
                           coefficients_(2) * input.target_acceleration_m_per_s2;
  if (std::isfinite(command_m)) sent_m_ = command_m;
  return command_m;
}

void TimeSeriesModel::reset() noexcept {
  measured_filter_.reset();
  command_filter_.reset();
  coefficients_ = initial_;
  held_measurement_m_ = filtered_m_[0] = filtered_m_[1] = sent_m_ = 0.0;
}

}  // namespace hybridtest
