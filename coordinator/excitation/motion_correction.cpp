#include "coordinator/excitation/motion_correction.hpp"

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include "coordinator/excitation/read_ground_motion.hpp"
#include "core/config_error.hpp"

namespace hybridtest {
namespace {

/// Integral of a piecewise linear function at its points, zero at the first.
Eigen::VectorXd integrated(const Eigen::VectorXd& values, double dt_s) {
  Eigen::VectorXd integral = Eigen::VectorXd::Zero(values.size());
  for (Eigen::Index i = 1; i < values.size(); ++i) {
    integral[i] = integral[i - 1] + 0.5 * dt_s * (values[i - 1] + values[i]);
  }
  return integral;
}

/// Second order, or first order with two zero coefficients: y_i = b0 x_i + b1 x_{i-1} + … - a1 y_{i-1} - a2 y_{i-2}.
struct FilterStage {
  double b0 = 0.0;
  double b1 = 0.0;
  double b2 = 0.0;
  double a1 = 0.0;
  double a2 = 0.0;

  void run(std::vector<double>& values) const noexcept {
    double x1 = 0.0;
    double x2 = 0.0;
    double y1 = 0.0;
    double y2 = 0.0;
    for (double& value : values) {
      const double y = b0 * value + b1 * x1 + b2 * x2 - a1 * y1 - a2 * y2;
      x2 = x1;
      x1 = value;
      y2 = y1;
      y1 = y;
      value = y;
    }
  }
};

/// By the bilinear transform, with the frequency prewarped (Oppenheim and Schafer, Discrete-Time Signal Processing,
/// section 7.2).
std::vector<FilterStage> butterworth_high_pass(const HighPassFilter& high_pass, double dt_s) {
  const double k = std::tan(std::numbers::pi * high_pass.frequency_hz * dt_s);
  std::vector<FilterStage> stages;
  for (int pair = 0; pair < high_pass.order / 2; ++pair) {
    // s^2 + 2 cos(angle) s + 1: two of the poles on the unit circle of the prototype.
    const double angle = std::numbers::pi * (high_pass.order - 1 - 2.0 * pair) / (2.0 * high_pass.order);
    const double damping = 2.0 * std::cos(angle) * k;
    const double scale = 1.0 / (1.0 + damping + k * k);
    stages.push_back({.b0 = scale,
                      .b1 = -2.0 * scale,
                      .b2 = scale,
                      .a1 = 2.0 * (k * k - 1.0) * scale,
                      .a2 = (1.0 - damping + k * k) * scale});
  }
  if (high_pass.order % 2 == 1) {
    const double scale = 1.0 / (1.0 + k);
    stages.push_back({.b0 = scale, .b1 = -scale, .b2 = 0.0, .a1 = (k - 1.0) * scale, .a2 = 0.0});
  }
  return stages;
}

}  // namespace

MotionEnd motion_end(const GroundMotion& motion) {
  const std::vector<double>& ground = motion.acceleration_m_per_s2;
  const double dt_s = motion.dt_s;
  MotionEnd end;
  for (std::size_t i = 0; i + 1 < ground.size(); ++i) {
    end.displacement_m += dt_s * end.velocity_m_per_s + dt_s * dt_s * (ground[i] / 3.0 + ground[i + 1] / 6.0);
    end.velocity_m_per_s += 0.5 * dt_s * (ground[i] + ground[i + 1]);
  }
  return end;
}

void correct_baseline(GroundMotion& motion, BaselineCorrection correction) {
  std::vector<double>& ground = motion.acceleration_m_per_s2;
  const auto points = std::ssize(ground);
  if (correction == BaselineCorrection::none || points < 2) return;
  const auto degree = static_cast<Eigen::Index>(correction) - static_cast<Eigen::Index>(BaselineCorrection::mean);
  const Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(points, 0.0, 1.0);  // over the duration
  // Powers of time minus the constant that gives the same velocity at the end: they leave the end as it is.
  Eigen::MatrixXd shapes(points, degree);
  Eigen::MatrixXd velocities(points, degree);
  for (Eigen::Index k = 0; k < degree; ++k) {
    shapes.col(k) = time.array().pow(static_cast<double>(k + 1));
    shapes.col(k).array() -=
        integrated(shapes.col(k), motion.dt_s)[points - 1] / (motion.dt_s * static_cast<double>(points - 1));
    velocities.col(k) = integrated(shapes.col(k), motion.dt_s);
  }
  Eigen::Map<Eigen::VectorXd> acceleration{ground.data(), points};
  const Eigen::VectorXd velocity = integrated(acceleration, motion.dt_s);
  acceleration.array() -= velocity[points - 1] / (motion.dt_s * static_cast<double>(points - 1));
  if (degree == 0) return;
  const Eigen::VectorXd left = velocity - time * velocity[points - 1];
  acceleration -= shapes * Eigen::VectorXd{velocities.colPivHouseholderQr().solve(left)};
}

void filter(GroundMotion& motion, const HighPassFilter& high_pass) {
  const double limit_hz = 0.25 / motion.dt_s;
  if (high_pass.frequency_hz > limit_hz) {
    throw ConfigError{"the frequency of the high-pass filter is above a quarter of the sampling rate of the motion, " +
                      std::to_string(limit_hz) + " Hz; expected the lowest frequency that the record has, such as 0.1"};
  }
  const double padding = std::ceil(1.5 * high_pass.order / high_pass.frequency_hz / motion.dt_s);
  if (padding > static_cast<double>(kGroundMotionPointsMax)) {
    throw ConfigError{
        "the frequency of the high-pass filter is too low for the step of the motion; expected the lowest "
        "frequency that the record has, such as 0.1"};
  }
  std::vector<double>& ground = motion.acceleration_m_per_s2;
  const auto zeros = static_cast<std::ptrdiff_t>(padding);
  std::vector<double> padded(ground.size() + 2 * static_cast<std::size_t>(zeros), 0.0);
  std::ranges::copy(ground, padded.begin() + zeros);
  const std::vector<FilterStage> stages = butterworth_high_pass(high_pass, motion.dt_s);
  for (int pass = 0; pass < 2; ++pass) {
    for (const FilterStage& stage : stages) stage.run(padded);
    std::ranges::reverse(padded);
  }
  std::copy_n(padded.begin() + zeros, ground.size(), ground.begin());
}

}  // namespace hybridtest
