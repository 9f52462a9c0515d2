#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenario/scenario.hpp"
#include "transport/fast_dds/fast_dds_settings.hpp"

namespace hybridtest {

/// Listens who of a test still waits for its coordinator.
/// @param local   ids of the processes of this machine, the coordinator first.
/// @return those that are gone and are to be started again: the coordinator, and numerical substructures.
/// @throws ConfigError, in words, when a coordinator is still there, or a site is gone.
[[nodiscard]] std::vector<std::string> processes_to_restart(const Scenario& scenario,
                                                            const std::filesystem::path& run_directory,
                                                            fast_dds::FastDdsSettings network,
                                                            const std::vector<std::string>& local);

/// The sites and substructures that were not started again close their files a little after the coordinator.
void await_closed_files(const Scenario& scenario, const std::filesystem::path& run_directory);

}  // namespace hybridtest
