#include "compensation/two_stage_adaptive.hpp"

#include <algorithm>
#include <cmath>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {
TwoStageAdaptive::TwoStageAdaptive(const Parameters& parameters, double control_period_s)
    : parameters_{checked(parameters)},
      delay_{checked_periods("coarse_delay_s", parameters.coarse_delay_s, checked_control_period(control_period_s), 0,
                             "the delay is whole control periods")},
      spacing_{checked_periods("term_spacing_s", parameters.term_spacing_s, control_period_s, 1,
                               "the terms of the model are samples")},
      keep_{1.0 - control_period_s / parameters.memory_s},
      // The filter correlates the error over rate / (2 corner) samples, which count as one.
      error_variance_m2_{parameters.equation_error_m * parameters.equation_error_m /
                         (2.0 * parameters.filter_hz * control_period_s)},
      extrapolation_{{3, static_cast<double>(delay_) * control_period_s, 0.0}, control_period_s},
      measured_filter_{parameters.filter_hz, control_period_s},
      command_filter_{parameters.filter_hz, control_period_s},
      extrapolated_m_{2 * spacing_ + 1},
      measured_m_{2 * spacing_ + 1},
      sent_m_{delay_ + 1} {
  reset();
}

void TwoStageAdaptive::learn(double measured_displacement_m) noexcept {
  if (std::isfinite(measured_displacement_m)) held_measurement_m_ = measured_displacement_m;
  measured_m_.push(measured_filter_.filter(held_measurement_m_));
  sent_m_.push(command_filter_.filter(last_sent_m_));

  const Eigen::Vector3d terms{measured_m_[0], measured_m_[spacing_], measured_m_[2 * spacing_]};
  const Eigen::Vector3d spread = covariance_ * terms;
  const Eigen::Vector3d gain = spread / (error_variance_m2_ + terms.dot(spread));
  theta_ += gain * (sent_m_[delay_] - theta_.dot(terms));
  theta_ = theta_.cwiseMax(-parameters_.theta_max).cwiseMin(parameters_.theta_max).eval();

  covariance_ -= gain * spread.transpose();
  // Forgetting while the motion tells nothing would let the covariance grow without limit.
  const double trace_max = 3.0 * parameters_.theta_deviation * parameters_.theta_deviation;
  if (covariance_.trace() / keep_ < trace_max) covariance_ /= keep_;
  covariance_ = (0.5 * (covariance_ + covariance_.transpose())).eval();
}

double TwoStageAdaptive::command(const CompensatorInput& input) noexcept {
  learn(input.measured_displacement_m);
  const double coarse_m = extrapolation_.advance(input.target_m);
  extrapolated_m_.push(coarse_m);
  const double command_m =
      theta_(0) * coarse_m + theta_(1) * extrapolated_m_[spacing_] + theta_(2) * extrapolated_m_[2 * spacing_];
  if (std::isfinite(command_m)) last_sent_m_ = command_m;
  return command_m;
}

void TwoStageAdaptive::reset() noexcept {
  extrapolation_.reset();
  measured_filter_.reset();
  command_filter_.reset();
  extrapolated_m_.clear();
  measured_m_.clear();
  sent_m_.clear();
  theta_ = {1.0, 0.0, 0.0};
  covariance_ = Eigen::Matrix3d::Identity() * (parameters_.theta_deviation * parameters_.theta_deviation);
  held_measurement_m_ = last_sent_m_ = 0.0;
}

}  // namespace hybridtest
