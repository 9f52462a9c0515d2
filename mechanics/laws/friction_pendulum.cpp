#include "mechanics/laws/friction_pendulum.hpp"

#include <cmath>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

FrictionPendulum::FrictionPendulum(const Parameters& parameters)
    : parameters_{checked(parameters)}, committed_{parameters.presliding_displacement_m}, trial_{committed_} {}

double FrictionPendulum::trial(double displacement_m, double velocity_m_per_s) noexcept {
  const double fast = 1.0 - std::exp(-parameters_.friction_rate_s_per_m * std::abs(velocity_m_per_s));
  const double slow = parameters_.slow_friction_ratio;
  trial_ = committed_;
  const double share = trial_.share(displacement_m, slow + (1.0 - slow) * fast);
  return parameters_.weight_n * (displacement_m / parameters_.radius_m + parameters_.friction_coefficient * share);
}

void FrictionPendulum::reset() noexcept {
  committed_.reset();
  trial_.reset();
}

double FrictionPendulum::initial_stiffness_n_per_m() const noexcept {
  return parameters_.weight_n *
         (1.0 / parameters_.radius_m + parameters_.friction_coefficient / parameters_.presliding_displacement_m);
}

}  // namespace hybridtest
