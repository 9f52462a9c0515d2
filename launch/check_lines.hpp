#pragma once

#include "launch/check_report.hpp"
#include "scenario/scenario.hpp"
#include "scenario/test_stability.hpp"

namespace hybridtest {

/// The lines of `hybridtest check` that need no simulated test: ground motion, modes, integrator, sites. Each section
/// is printed once it is judged.
/// @param out   nullptr: nothing is printed.
/// @return the stability that the lines are from.
TestStability check_stability(const Scenario& scenario, CheckReport& report, std::FILE* out);

/// The same of a test that OpenSees leads, whose structure is not known here: how it starts, its elements, and the
/// sites.
void check_led_test(const Scenario& scenario, CheckReport& report, std::FILE* out);

/// The lines that need one: peaks at each site against its limits and the rating of its rig.
void check_peaks(const Scenario& scenario, CheckReport& report, std::FILE* out);

/// Judges the stability before a test, as `check` does, and prints what fails to standard error. A test of a rig that
/// is not simulated is refused.
/// @throws ConfigError for an unstable test with such a rig, unless it is allowed.
void require_stable_test(const Scenario& scenario, bool even_if_unstable);

/// Says on standard error which inputs of effects have their nominal value, because a simulated rig records none.
void say_nominal_inputs(const Scenario& scenario);

}  // namespace hybridtest
