#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "diagnosis/structure/computed_structure.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {

/// The computed part of a test, as a scenario has it and as a run recorded it.
struct StructureRecord {
  ComputedStructure model;
  StructureRecording recording;
  std::vector<std::string> notes;  // what differs besides, and what was not recorded
};

/// @param scenario   the user's; of the same degrees of freedom and substructures as the run's own.
/// @throws ConfigError when they are not. @throws RecordingError when the coordinator's record is not there.
[[nodiscard]] StructureRecord structure_record(const std::filesystem::path& run, const Scenario& scenario);

}  // namespace hybridtest
