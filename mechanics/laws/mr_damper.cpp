#include "mechanics/laws/mr_damper.hpp"

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

MrDamper::MrDamper(const Parameters& parameters)
    : parameters_{checked(parameters)}, committed_{parameters.hysteretic_displacement_m}, trial_{committed_} {}

double MrDamper::trial(double displacement_m, double velocity_m_per_s) noexcept {
  trial_ = committed_;
  return parameters_.damping_n_s_per_m * velocity_m_per_s + parameters_.stiffness_n_per_m * displacement_m +
         parameters_.hysteretic_force_n * trial_.share(displacement_m);
}

void MrDamper::reset() noexcept {
  committed_.reset();
  trial_.reset();
}

double MrDamper::initial_stiffness_n_per_m() const noexcept {
  return parameters_.stiffness_n_per_m + parameters_.hysteretic_force_n / parameters_.hysteretic_displacement_m;
}

}  // namespace hybridtest
