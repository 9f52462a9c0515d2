#include "mechanics/laws/elastic.hpp"

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

Elastic::Elastic(const Parameters& parameters) : stiffness_n_per_m_{checked(parameters).stiffness_n_per_m} {}

double Elastic::trial(double displacement_m, double /*velocity_m_per_s*/) noexcept {
  return stiffness_n_per_m_ * displacement_m;
}

}  // namespace hybridtest
