#pragma once

#include <filesystem>

#include "experimental_site/rigs/replay_rig.hpp"

namespace hybridtest {

/// Reads a recorded measurement from a CSV file whose first line names its columns: `time_s`,
/// `measured_displacement_m` and `measured_force_n`, for several actuators with the suffix `_1`, `_2` …; as
/// `hybridtest export` writes the table `control` of a site. Other columns are passed over.
/// @throws ConfigError naming the file, and the line where there is one: columns that are missing, a line of
///         another length, what is no finite number, times that do not rise.
[[nodiscard]] RecordedMeasurement read_measurement(const std::filesystem::path& file, int actuators);

}  // namespace hybridtest
