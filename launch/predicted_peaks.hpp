#pragma once

#include <string>
#include <vector>

#include "core/faults.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {

/// Largest magnitudes at a site over its degrees of freedom, in site time.
struct SitePeaks {
  const SubstructureScenario* site = nullptr;
  std::string rig;                // `its simulated rig`
  double displacement_m = 0.0;    // of target, command and measurement
  double velocity_m_per_s = 0.0;  // of the target
  double force_n = 0.0;           // as measured
};

struct PredictedTest {
  StopReason reason = StopReason::none;
  double end_s = 0.0;               // model time
  std::vector<std::string> faults;  // as reported
  std::vector<SitePeaks> sites;
};

/// Simulates the whole test in this process. A rig that is elsewhere is replaced by the `model` beside it or, without
/// one, by an elastic specimen of the initial stiffness behind an actuator of the delay given. Prints its progress to
/// standard error where it takes long.
[[nodiscard]] PredictedTest predicted_test(const Scenario& scenario);

}  // namespace hybridtest
