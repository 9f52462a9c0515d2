#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "compensation/compensator.hpp"
#include "compensation/delay_setting.hpp"
#include "scenario/catalogue/delay_estimators.hpp"
#include "scenario/catalogue/part.hpp"

namespace hybridtest {

struct CompensatorReading {
  /// @param delay_change_s   added to its setting; 0 where it has none that `setting` speaks of.
  std::function<std::unique_ptr<Compensator>(double control_period_s, double delay_change_s)> make;
  double delay_s = 0.0;  // that it makes up for, at first
  DelaySetting setting = {};
  bool learns_delay = false;  // during the test
  /// With an estimator: the same with its estimate at a bound. Empty without one.
  std::function<std::unique_ptr<Compensator>(double control_period_s, EstimateBound bound)> make_at = {};
};

/// Every compensator on commands that a file can name.
[[nodiscard]] const std::vector<PartType<CompensatorReading>>& compensators();

/// `none` when no type is given.
[[nodiscard]] CompensatorReading read_compensator(config::Section section);

}  // namespace hybridtest
