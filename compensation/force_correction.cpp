#include "compensation/force_correction.hpp"

#include <algorithm>
#include <cmath>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {
namespace {

QuadraticFit window_fit(const ForceCorrection::Parameters& parameters, double control_period_s) {
  const std::size_t points =
      checked_periods("window_s", checked(parameters).window_s, checked_control_period(control_period_s), 3,
                      "a quadratic is fitted in it");
  return {points, 1, control_period_s};
}

}  // namespace

ForceCorrection::ForceCorrection(const Parameters& parameters, double control_period_s)
    : parameters_{parameters},
      control_period_s_{control_period_s},
      keep_{std::exp(-control_period_s / parameters.stiffness_memory_s)},
      fit_{window_fit(parameters, control_period_s)},
      desired_m_{fit_.span()},
      displacements_m_{fit_.span()},
      forces_n_{fit_.span()} {}

double ForceCorrection::corrected_force(const ForceSample& sample) noexcept {
  desired_m_.push(sample.desired_displacement_m);
  displacements_m_.push(sample.measured_displacement_m);
  forces_n_.push(sample.measured_force_n);
  learn_stiffness(sample);
  const Quadratic displacement = fit_.fit(displacements_m_);
  const Quadratic force = fit_.fit(forces_n_);
  follow(wanted_root(displacement, fit_.fit(desired_m_)));
  return force.at(root_s_) + stiffness_n_per_m() * (sample.desired_displacement_m - displacement.at(root_s_));
}

double ForceCorrection::wanted_root(const Quadratic& displacement, const Quadratic& desired) const noexcept {
  // x'(t) at the roots is plus and minus the square root of the discriminant.
  const double c = displacement.constant - desired.constant;
  const double discriminant = displacement.linear * displacement.linear - 4.0 * displacement.square * c;
  if (discriminant < 0.0) return -0.5 * displacement.linear / displacement.square;
  const double velocity = std::copysign(std::sqrt(discriminant), desired.linear);
  // Of the two forms of the same root, the one without cancellation.
  if (velocity * displacement.linear > 0.0) return -2.0 * c / (displacement.linear + velocity);
  return (velocity - displacement.linear) / (2.0 * displacement.square);
}

void ForceCorrection::follow(double wanted_s) noexcept {
  if (std::isnan(wanted_s)) return;
  const double within_s = std::clamp(wanted_s, -parameters_.window_s, parameters_.horizon_s);
  const double step_s = parameters_.root_rate_s_per_s_max * control_period_s_;
  root_s_ += std::clamp(within_s - root_s_, -step_s, step_s);
}

void ForceCorrection::learn_stiffness(const ForceSample& sample) noexcept {
  const double x = sample.measured_displacement_m;
  const double f = sample.measured_force_n;
  if (!std::isfinite(x) || !std::isfinite(f)) return;
  displacement_square_m2_s_ = keep_ * displacement_square_m2_s_ + control_period_s_ * x * x;
  displacement_force_n_m_s_ = keep_ * displacement_force_n_m_s_ + control_period_s_ * x * f;
}

double ForceCorrection::stiffness_n_per_m() const noexcept {
  const double prior_m2_s = parameters_.prior_motion_m * parameters_.prior_motion_m * parameters_.stiffness_memory_s;
  return (displacement_force_n_m_s_ + prior_m2_s * parameters_.stiffness_n_per_m) /
         (displacement_square_m2_s_ + prior_m2_s);
}

void ForceCorrection::reset() noexcept {
  desired_m_.clear();
  displacements_m_.clear();
  forces_n_.clear();
  root_s_ = 0.0;
  displacement_square_m2_s_ = displacement_force_n_m_s_ = 0.0;
}

}  // namespace hybridtest
