#include "mechanics/laws/friction.hpp"

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

Friction::Friction(const Parameters& parameters)
    : parameters_{checked(parameters)}, committed_{parameters.presliding_displacement_m}, trial_{committed_} {}

double Friction::trial(double displacement_m, double /*velocity_m_per_s*/) noexcept {
  trial_ = committed_;
  return parameters_.friction_force_n * trial_.share(displacement_m);
}

void Friction::reset() noexcept {
  committed_.reset();
  trial_.reset();
}

double Friction::initial_stiffness_n_per_m() const noexcept {
  return parameters_.friction_force_n / parameters_.presliding_displacement_m;
}

}  // namespace hybridtest
