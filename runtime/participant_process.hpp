#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenario/scenario.hpp"
#include "transport/fast_dds/fast_dds_settings.hpp"

namespace hybridtest {

/// How one participant is started: the options its three programs share.
struct ParticipantProcessOptions {
  std::filesystem::path scenario_file;
  std::vector<std::string> overrides;
  std::string id;                       // of the substructure; the coordinator has none to choose
  std::filesystem::path run_directory;  // made if it is not there
  fast_dds::FastDdsSettings network;
};

/// The whole life of the process that is this participant: reads the scenario, joins the test,
/// takes part until it ends, closes the records.
/// @return the exit code of the process; errors are printed.
int run_participant_process(const ParticipantProcessOptions& options, Role role) noexcept;

/// The `main` of the three programs.
int participant_main(int argc, char** argv, Role role);

}  // namespace hybridtest
