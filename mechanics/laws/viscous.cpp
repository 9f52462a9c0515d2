#include "mechanics/laws/viscous.hpp"

#include <cmath>

#include "core/parameters/checked_parameter.hpp"

namespace hybridtest {

Viscous::Viscous(const Parameters& parameters) : parameters_{parameters} {
  static_cast<void>(checked("damping_n_s_per_m", parameters.damping_n_s_per_m, kNotNegative));
  static_cast<void>(checked("exponent", parameters.exponent, {.low = 0.1, .high = 3.0}));
}

double Viscous::trial(double /*displacement_m*/, double velocity_m_per_s) noexcept {
  const double size = std::pow(std::abs(velocity_m_per_s), parameters_.exponent);
  return parameters_.damping_n_s_per_m * std::copysign(size, velocity_m_per_s);
}

}  // namespace hybridtest
