#pragma once

#include <optional>
#include <vector>

#include "recording/summary/run_summary.hpp"

namespace hybridtest {

class RunFileReader;

/// What a substructure's own file says of it.
struct SiteFigures {
  std::vector<Peak> peak_force_n;
  std::vector<TrackingError> tracking;
  std::optional<EnergyError> energy_error;
};

/// From the rows of the control loop that are of the test, where there is one, else from the steps.
[[nodiscard]] SiteFigures site_figures(const RunFileReader& file);

}  // namespace hybridtest
