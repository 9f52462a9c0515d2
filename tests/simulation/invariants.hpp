#pragma once

#include <string>
#include <vector>

#include "tests/simulation/drawn_case.hpp"
#include "tests/simulation/kept_simulation.hpp"

/// What must hold for every run under any network faults. Each function returns the violations, one
/// sentence each.
namespace hybridtest {

using Violations = std::vector<std::string>;

/// Each step was completed once and in order. Every substructure took each step once, at the displacement that the
/// coordinator recorded. The recorded restoring force is that of the substructures.
[[nodiscard]] Violations steps_violated(const KeptSimulation& run, const Scenario& scenario);

/// No command of a site, from the first control period to the last, beyond its displacement
/// limit or faster than its velocity limit; control periods complete.
[[nodiscard]] Violations limits_violated(const KeptSimulation& run, const Scenario& scenario);

/// Kinetic energy + work of damping + work of the restoring force = work put in.
///
/// With v_i = (u_{i+1} - u_{i-1})/2dt and a_i = (u_{i+1} - 2u_i + u_{i-1})/dt^2, dt v_i^T M a_i is
/// the change of 1/2 h^T M h from i - 1/2 to i + 1/2, h = (u_{i+1} - u_i)/dt. So the balance
///
///   1/2 h^T M h |_{1/2}^{n-1/2} + sum dt v_i^T (C v_i + r_i + M iota ag_i) = 0,  i = 1 .. n - 1,
///
/// is an identity of both explicit integrators for any restoring force; the rest is
/// rounding. @return nothing for fewer than three steps.
[[nodiscard]] Violations energy_violated(const KeptSimulation& run, const Scenario& scenario);

/// Every participant ended, for a reason that the faults drawn explain and an event reports.
/// @param reference   the same scenario without faults.
[[nodiscard]] Violations ending_violated(const KeptSimulation& run, const KeptSimulation& reference,
                                         const Scenario& scenario, const DrawnCase& drawn);

/// In lockstep: the same bits as the history without faults, up to the end of the run.
[[nodiscard]] Violations history_violated(const KeptSimulation& run, const KeptSimulation& reference);

}  // namespace hybridtest
