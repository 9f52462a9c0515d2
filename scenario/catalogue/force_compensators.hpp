#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "compensation/force_compensator.hpp"
#include "scenario/catalogue/delay_estimators.hpp"
#include "scenario/catalogue/part.hpp"

namespace hybridtest {

struct ForceCompensatorReading {
  std::function<std::unique_ptr<ForceCompensator>(double control_period_s)> make;
  // Delays of the measured displacement behind the target that it makes up for; negative: ahead of the target.
  double delay_s_min = 0.0;
  double delay_s_max = 0.0;
  bool learns_delay = false;  // during the test
  bool is_linear = true;      // false: it moves the force in time, as the displacements say
  /// With an estimator: the same with its estimate at a bound. Empty without one.
  std::function<std::unique_ptr<ForceCompensator>(double control_period_s, EstimateBound bound)> make_at = {};
};

/// Every compensator on forces that a file can name.
[[nodiscard]] const std::vector<PartType<ForceCompensatorReading>>& force_compensators();

/// `none` when no type is given.
[[nodiscard]] ForceCompensatorReading read_force_compensator(config::Section section);

}  // namespace hybridtest
