#pragma once

#include <string_view>
#include <vector>

#include "recording/run_file.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {

/// What the tables of a participant's run file hold, for people who read the file with other tools.
///
/// The time column of `steps` is model time; that of `control` is the time of the control loop since it was armed.
[[nodiscard]] std::vector<TableNote> table_notes(const Scenario& scenario, std::string_view participant);

}  // namespace hybridtest
