#include "mechanics/gap_spring.hpp"

#include "mechanics/checked_parameter.hpp"

namespace hybridtest {

GapSpring::GapSpring(const Parameters& parameters) : parameters_{parameters} {
  static_cast<void>(checked("stiffness_n_per_m", parameters.stiffness_n_per_m, config::kPositive));
  static_cast<void>(checked("gap_m", parameters.gap_m, config::kNotNegative));
}

}  // namespace hybridtest
