#pragma once

#include <filesystem>
#include <string>

#include "core/messages.hpp"
#include "tests/support/recorded_run.hpp"

/// What must hold for the records of a test for any end of it.
namespace hybridtest {

/// Longest time between two flushes of a run file.
inline constexpr double kFlushInterval_s = 0.1;
/// Duration of a flush on a busy machine.
inline constexpr double kFlushMargin_s = 0.4;

/// HDF5's own tool reads it; nothing is checked where the tool is not installed.
/// @param scratch   a directory for what the tool prints.
void expect_opens_with_h5dump(const std::filesystem::path& file, const std::filesystem::path& scratch);
/// Steps 0, 1, 2 … without a gap.
void expect_all_steps_from_the_first(const RecordedRun& run, const std::string& participant);
/// The last command to the actuators is zero.
void expect_rig_came_to_zero(const RecordedRun& run, const std::string& site);
/// The commands to the actuators are constant from shortly after one event until the other.
void expect_held_between(const RecordedRun& run, const std::string& site, const Event& begin, const Event& end);

}  // namespace hybridtest
