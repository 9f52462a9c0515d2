#pragma once

#include <ctime>
#include <filesystem>
#include <functional>
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
/// Another time in the same form.
[[nodiscard]] std::string time_utc_of(std::time_t seconds);

/// `runs/<test name>_<UTC time>` below the working directory.
[[nodiscard]] std::filesystem::path default_run_directory(std::string_view test_name);

/// Makes the directory and writes `scenario.yaml`, the effective scenario with its ground motion
/// beside it, so that the directory can be run again.
/// @throws ConfigError when the directory cannot be made or holds a run of another scenario.
void prepare_run_directory(const std::filesystem::path& directory, const Scenario& scenario);

/// @throws ConfigError when this participant has recorded into the directory before.
void require_new_run(const std::filesystem::path& directory, std::string_view participant);

[[nodiscard]] std::filesystem::path run_file(const std::filesystem::path& directory, std::string_view participant);

/// @param clock_zero_unix_s   [s] when the participant's clock stood at zero, see ProcessClock::zero_unix_s().
[[nodiscard]] RunFileHeader run_file_header(const Scenario& scenario, std::string_view participant, Role role,
                                            Incarnation incarnation, double clock_zero_unix_s);

/// The tables of the coordinator's file about the test as a whole, which it writes at the end: `test`, with one row;
/// `ground_motions`, with a row for each; `response_spectra` of what was applied.
[[nodiscard]] std::vector<TableLayout> test_tables();
/// @param sink   of one of these tables.
void write_test_tables(const Scenario& scenario, const CoordinatorReport& report, int exit_code,
                       const std::function<RowSink&(std::string_view table)>& sink);

}  // namespace hybridtest
