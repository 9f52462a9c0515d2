#include "mechanics/elastic.hpp"

#include "mechanics/checked_parameter.hpp"

namespace hybridtest {

Elastic::Elastic(double stiffness_n_per_m)
    : stiffness_n_per_m_{checked("stiffness_n_per_m", stiffness_n_per_m, config::kPositive)} {}

double Elastic::trial(double displacement_m, double /*velocity_m_per_s*/) noexcept {
  return stiffness_n_per_m_ * displacement_m;
}

}  // namespace hybridtest
