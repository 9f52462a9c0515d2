#include "compensation/feedforward_lqg.hpp"

#include <cmath>

#include "compensation/discrete_regulator.hpp"
#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {
FeedforwardLqg::FeedforwardLqg(const Parameters& parameters, double control_period_s)
    : has_feedback_{parameters.has_feedback},
      inverse_{checked(parameters).model.inverse_coefficients()},
      jerk_samples_{checked_periods("jerk_difference_s", parameters.jerk_difference_s,
                                    checked_control_period(control_period_s), 1, "it is a difference of samples")},
      jerk_difference_s_{static_cast<double>(jerk_samples_) * control_period_s},
      system_{discretised(parameters.model, control_period_s)},
      accelerations_m_per_s2_{jerk_samples_ + 1} {
  using Matrix = TransferSystemModel::Matrix;
  Matrix weight = Matrix::Zero();
  weight(TransferSystemModel::kDisplacement, TransferSystemModel::kDisplacement) = parameters.regulator_weight;
  regulator_gain_ = regulator_gain(system_.transition, system_.input, weight, 1.0);

  // Covariances in units of the sensor's variance.
  const double ratio = parameters.input_noise_m / parameters.displacement_noise_m;
  const Matrix noise = system_.input * system_.input.transpose() * ratio * ratio;
  Eigen::RowVectorXd sensor = Eigen::RowVectorXd::Zero(kStates);
  sensor(TransferSystemModel::kDisplacement) = 1.0;
  estimator_gain_ = estimator_gain(system_.transition, sensor, noise, 1.0);
}

double FeedforwardLqg::feedforward(const CompensatorInput& input) noexcept {
  accelerations_m_per_s2_.push(input.target_acceleration_m_per_s2);
  const double jerk_m_per_s3 =
      (input.target_acceleration_m_per_s2 - accelerations_m_per_s2_[jerk_samples_]) / jerk_difference_s_;
  return inverse_[0] * input.target_m + inverse_[1] * input.target_velocity_m_per_s +
         inverse_[2] * input.target_acceleration_m_per_s2 + inverse_[3] * jerk_m_per_s3;
}

void FeedforwardLqg::regulate(const CompensatorInput& input) noexcept {
  const double error_m = input.measured_displacement_m - previous_target_m_;
  if (has_target_ && std::isfinite(error_m)) {
    deviation_ += estimator_gain_ * (error_m - deviation_(TransferSystemModel::kDisplacement));
  }
  deviation_ = (system_.transition * deviation_ + system_.input * feedback_m_).eval();
  feedback_m_ = -(regulator_gain_ * deviation_).value();
}

double FeedforwardLqg::command(const CompensatorInput& input) noexcept {
  if (has_feedback_) regulate(input);
  previous_target_m_ = input.target_m;
  has_target_ = true;
  return feedforward(input) + feedback_m_;
}

void FeedforwardLqg::reset() noexcept {
  deviation_.setZero();
  accelerations_m_per_s2_.clear();
  previous_target_m_ = feedback_m_ = 0.0;
  has_target_ = false;
}

}  // namespace hybridtest
