#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenario/scenario.hpp"
#include "transport/fast_dds/fast_dds_settings.hpp"

namespace hybridtest {

/// Options of one participant, the same for the three programs.
struct ParticipantProcessOptions {
  std::filesystem::path scenario_file;
  std::vector<std::string> overrides;
  std::string id;                       // of the substructure; not used by the coordinator
  std::filesystem::path run_directory;  // created if it does not exist
  /// Takes the place of a process of this run directory that died, with its state. The scenario is that of the
  /// directory.
  bool resumes = false;
  fast_dds::FastDdsSettings network;
  bool shows_progress = true;  // on standard error; and the coordinator's summary on standard output
};

/// @throws ConfigError for more substructures than a test over a network may have.
void require_distributable(const Scenario& scenario);

/// Runs one participant in this process: reads the scenario, joins the test, takes part until it ends,
/// closes the records.
/// @return the exit code of the process; errors are printed.
int run_participant_process(const ParticipantProcessOptions& options, Role role) noexcept;

/// The `main` of the three programs.
int participant_main(int argc, char** argv, Role role);

}  // namespace hybridtest
