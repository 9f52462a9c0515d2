#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/config/section.hpp"
#include "core/records.hpp"
#include "experimental_site/rigs/rig.hpp"

namespace hybridtest {

/// What the preflight needs to know of a rig besides how to make it.
struct RigReading {
  std::string type;
  std::function<std::unique_ptr<Rig>(double control_period_s)> make;
  double transfer_delay_s = 0.0;    // at low frequency, of a simulated rig's slowest actuator
  bool is_elsewhere = false;        // outside the process that makes it: not under simulated time
  bool keeps_time = false;          // by a clock of its own: not in lockstep
  std::vector<TableLayout> tables;  // that it records by itself, see Rig::record_to()
};

/// @param directory   where files that it names are looked for.
/// @param site        counts the sites of a test, so that no two of one seed have the same noise.
[[nodiscard]] RigReading read_rig(config::Section section, int dofs, const std::filesystem::path& directory, int site);

}  // namespace hybridtest
