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

/// What the default limits of a site's interlocks are derived from. Times are site time.
struct TrackingExpectation {
  bool follows_commands = true;  // false: nothing there tracks a target, and there are no default limits
  double control_period_s = 0.0;
  double reading_delay_s = 0.0;            // longest that a sound reading stays behind the command
  double remaining_delay_s = 0.0;          // that the compensators of the commands leave, either way
  double displacement_resolution_m = 0.0;  // of coarse readings
  bool force_always_varies = true;         // false: a sound force may read the same to the last bit during motion
};

/// Reads `limits`, `interlocks`, `trajectory`, `ramp_in_s`, `zero_offsets`, `at_end` and `return_time_s`.
///
/// Two interlocks have a limit by default, because without them a site with dead sensors passes for a sound one:
///   - `tracking_error`: a tenth of the displacement limit, plus the motion at the velocity limit within the delay
///     that is left uncompensated. A rig further from its target than that does not follow it.
///   - `stuck_sensor`: identical readings for 0.1 s longer than a reading may be late, after the command has moved by
///     a thousandth of the displacement limit: twice the step of a 12-bit converter over a range of both limits.
/// @param site          the experimental substructure's section.
/// Where the test waits for a link that is down, the site waits with it: in paced mode `command_age` clears by itself,
/// in lockstep, where nothing moves meanwhile, its limit is that time.
/// @param site_step_s   coupling step in site time.
/// @param link_s        for so long the test waits for a link that is down.
[[nodiscard]] LoopScenario read_loop(config::Section& site, CouplingMode mode, double site_step_s, double link_s,
                                     const TrackingExpectation& rig);

/// Reads `real_time`, of a site, a numerical substructure or the coordinator.
/// @param has_deadlines   of the thread in question; without them the section is read where it stands, and not used.
[[nodiscard]] RealTimeRequest read_real_time(config::Section& parent, bool has_deadlines);

}  // namespace hybridtest
