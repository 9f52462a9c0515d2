#include "mechanics/laws/viscous.hpp"

#include <cmath>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

Viscous::Viscous(const Parameters& parameters) : parameters_{checked(parameters)} {}

double Viscous::trial(double /*displacement_m*/, double velocity_m_per_s) noexcept {
  const double size = std::pow(std::abs(velocity_m_per_s), parameters_.exponent);
  return parameters_.damping_n_s_per_m * std::copysign(size, velocity_m_per_s);
}

}  // namespace hybridtest
