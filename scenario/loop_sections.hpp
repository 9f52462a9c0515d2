#pragma once

#include "core/config/section.hpp"
#include "core/messages.hpp"
#include "core/real_time_thread.hpp"
#include "experimental_site/interlocks.hpp"
#include "experimental_site/trajectory.hpp"

namespace hybridtest {

/// What a scenario says of a site's control loop, besides its rig and its compensators.
struct LoopScenario {
  SiteLimits limits;
  InterlockRules rules = default_interlock_rules();
  double tracking_window_s = 1.0;
  TrajectorySettings trajectory;
  double ramp_in_s = 0.0;
  bool captures_zero_offsets = false;
  bool returns_at_end = true;
  double return_time_s = 0.0;
};

/// Reads `limits`, `interlocks`, `trajectory`, `ramp_in_s`, `zero_offsets`, `at_end` and `return_time_s`.
/// @param site          the experimental substructure's section.
/// @param site_step_s   coupling step in site time.
[[nodiscard]] LoopScenario read_loop(config::Section& site, CouplingMode mode, double site_step_s);

/// Reads `real_time`. In lockstep, where the loop has no thread and no deadlines, it is not read.
[[nodiscard]] RealTimeRequest read_real_time(config::Section& site, CouplingMode mode);

}  // namespace hybridtest
