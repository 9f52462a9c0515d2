#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/emulated_network.hpp"
#include "tests/support/recorded_run.hpp"
#include "tests/support/started_program.hpp"

namespace hybridtest {

/// One of the three programs that take part in tests.
struct ParticipantProgram {
  std::filesystem::path program;
  std::string id;
};

/// The participants of one test, each in a host of its own with its own records, as started by hand on several hosts.
/// They find each other by the addresses of the others, without multicast.
class ProgramsOnHosts {
 public:
  /// @param programs    one for each host of the network, in its order; the coordinator first.
  /// @param directory   where the run directories are made, each with the name of its participant.
  /// @param arguments   further ones of every program.
  ProgramsOnHosts(const EmulatedNetwork& network, const std::vector<ParticipantProgram>& programs,
                  const std::filesystem::path& scenario, const std::filesystem::path& directory,
                  const std::vector<std::string>& arguments);

  /// Waits for all of them. @return their exit codes, -1 for one that still runs.
  [[nodiscard]] std::vector<int> wait(std::chrono::milliseconds patience = kPatience);
  [[nodiscard]] StartedProgram& program(std::size_t host) { return programs_.at(host); }
  /// The files of the others are copied to that of the coordinator, as after a test across hosts.
  [[nodiscard]] RecordedRun collected() const;
  /// What each of them wrote to standard error.
  [[nodiscard]] std::string messages() const;

 private:
  std::filesystem::path directory_;
  std::vector<std::string> ids_;
  std::vector<StartedProgram> programs_;
};

}  // namespace hybridtest
