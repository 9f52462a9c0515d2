#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "coordinator/coordinator.hpp"
#include "core/records.hpp"
#include "recording/run_file.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {

/// The time of the wall clock: `2026-11-22T10:15:00Z`.
[[nodiscard]] std::string time_utc();

/// `runs/<test name>_<UTC time>` below the working directory.
[[nodiscard]] std::filesystem::path default_run_directory(std::string_view test_name);

/// Makes the directory and writes `scenario.yaml`, the effective scenario with its ground motion
/// beside it, so that the directory can be run again.
/// @throws ConfigError when the directory cannot be made or holds a run of another scenario.
void prepare_run_directory(const std::filesystem::path& directory, const Scenario& scenario);

/// @throws ConfigError when this participant has recorded into the directory before.
void require_new_run(const std::filesystem::path& directory, std::string_view participant);

[[nodiscard]] std::filesystem::path run_file(const std::filesystem::path& directory, std::string_view participant);

[[nodiscard]] RunFileHeader run_file_header(const Scenario& scenario, std::string_view participant, Role role,
                                            Incarnation incarnation);

/// The table `test`, with one row, that the coordinator writes at the end.
[[nodiscard]] TableLayout test_layout();
[[nodiscard]] std::vector<double> test_row(const Scenario& scenario, const CoordinatorReport& report, int exit_code);

}  // namespace hybridtest
