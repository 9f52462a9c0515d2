#include "mechanics/laws/elastic.hpp"

#include "core/parameters/checked_parameter.hpp"

namespace hybridtest {

Elastic::Elastic(double stiffness_n_per_m)
    : stiffness_n_per_m_{checked("stiffness_n_per_m", stiffness_n_per_m, kPositive)} {}

double Elastic::trial(double displacement_m, double /*velocity_m_per_s*/) noexcept {
  return stiffness_n_per_m_ * displacement_m;
}

}  // namespace hybridtest
