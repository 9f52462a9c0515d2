#include "compensation/estimated_delay.hpp"

#include "core/config_error.hpp"
#include "core/text/scalar.hpp"

namespace hybridtest {

void check_estimated_delay(const DelayAdaptive* compensator, const DelayEstimator* estimator) {
  if (compensator == nullptr) {
    throw ConfigError{
        "a delay estimator needs a compensator with a delay; expected one of polynomial_displacement, "
        "polynomial_force, newmark_kinematics, linear_acceleration, inverse_compensation"};
  }
  if (estimator == nullptr) throw ConfigError{"no delay estimator is given; expected one"};
  if (estimator->delay_s() > compensator->delay_s_max() * (1.0 + 1e-9)) {
    throw ConfigError{"initial_delay_s is " + written_number(estimator->delay_s()) + "; expected at most " +
                      written_number(compensator->delay_s_max()) +
                      " s, because the compensator cannot make up for more; widen its point_spacing_s"};
  }
}

}  // namespace hybridtest
