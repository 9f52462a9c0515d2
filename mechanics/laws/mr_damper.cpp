#include "mechanics/laws/mr_damper.hpp"

#include <cmath>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

MrDamper::MrDamper(const Parameters& parameters)
    : parameters_{checked(parameters)},
      hysteresis_{BoucWen::Parameters{
          .stiffness_n_per_m = 1.0 / parameters.hysteretic_displacement_m,
          .alpha = 0.0,
          .n = parameters.exponent,
          .gamma_per_m = 0.5 / std::pow(parameters.hysteretic_displacement_m, parameters.exponent),
          .beta_per_m = 0.5 / std::pow(parameters.hysteretic_displacement_m, parameters.exponent)}} {}

double MrDamper::trial(double displacement_m, double velocity_m_per_s) noexcept {
  return parameters_.damping_n_s_per_m * velocity_m_per_s + parameters_.stiffness_n_per_m * displacement_m +
         parameters_.hysteretic_force_n * hysteresis_.trial(displacement_m, velocity_m_per_s);
}

double MrDamper::initial_stiffness_n_per_m() const noexcept {
  return parameters_.stiffness_n_per_m + parameters_.hysteretic_force_n / parameters_.hysteretic_displacement_m;
}

}  // namespace hybridtest
