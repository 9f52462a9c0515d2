#include "coordinator/integrators/initial_ramp.hpp"

#include <utility>

namespace hybridtest {

InitialRampPoint initial_ramp_point(double share, double duration_s) noexcept {
  const double x = share;
  const double y = 1.0 - share;
  return {.displacement = {x * x * x * (10.0 - 15.0 * x + 6.0 * x * x),
                           duration_s * x * x * x * (-4.0 + 7.0 * x - 3.0 * x * x)},
          .velocity = {30.0 * x * x * y * y / duration_s, x * x * (-12.0 + 28.0 * x - 15.0 * x * x)},
          .acceleration = {60.0 * x * y * (1.0 - 2.0 * x) / (duration_s * duration_s),
                           x * (-24.0 + 84.0 * x - 60.0 * x * x) / duration_s}};
}

InitialRamp::InitialRamp(std::unique_ptr<Integrator> method, const InitialMotion& initial, double step_s,
                         const InitialRampSteps& steps)
    : method_{std::move(method)},
      initial_{starting_state(initial, method_->current().displacement_m.size())},
      step_s_{step_s},
      steps_{steps},
      current_{initial_},
      completed_{initial_} {
  prescribe();
}

const MotionState& InitialRamp::current() const noexcept { return is_released() ? method_->current() : current_; }

const MotionState& InitialRamp::completed() const noexcept {
  return has_method_completed_ ? method_->completed() : completed_;
}

void InitialRamp::advance(const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
                          const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) noexcept {
  if (is_released()) {
    method_->advance(restoring_force_n, applied_force_n);
    has_method_completed_ = true;
    return;
  }
  std::swap(completed_, current_);
  ++step_;
  prescribe();
}

void InitialRamp::prescribe() noexcept {
  if (step_ >= steps_.ramp) {
    current_.displacement_m = initial_.displacement_m;
    current_.velocity_m_per_s = initial_.velocity_m_per_s;
    current_.acceleration_m_per_s2.setZero();
    return;
  }
  const InitialRampPoint point = initial_ramp_point(static_cast<double>(step_) / static_cast<double>(steps_.ramp),
                                                    static_cast<double>(steps_.ramp) * step_s_);
  const auto& u = initial_.displacement_m;
  const auto& v = initial_.velocity_m_per_s;
  current_.displacement_m = point.displacement[0] * u + point.displacement[1] * v;
  current_.velocity_m_per_s = point.velocity[0] * u + point.velocity[1] * v;
  current_.acceleration_m_per_s2 = point.acceleration[0] * u + point.acceleration[1] * v;
}

}  // namespace hybridtest
