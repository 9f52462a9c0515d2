#include "mechanics/laws/gap_spring.hpp"

#include "core/parameters/checked_parameter.hpp"

namespace hybridtest {

GapSpring::GapSpring(const Parameters& parameters) : parameters_{parameters} {
  static_cast<void>(checked("stiffness_n_per_m", parameters.stiffness_n_per_m, kPositive));
  static_cast<void>(checked("gap_m", parameters.gap_m, kNotNegative));
}

}  // namespace hybridtest
