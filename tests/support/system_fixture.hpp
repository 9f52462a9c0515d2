#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "core/exit_code.hpp"
#include "tests/support/recorded_run.hpp"
#include "tests/support/started_program.hpp"

namespace hybridtest {

using Arguments = std::vector<std::string>;

/// A test that starts the real programs. It has its own directory, test name and DDS domain, so that other processes on
/// the machine cannot join it. The directory of a failed test is kept and printed.
class SystemTest : public ::testing::Test {
 protected:
  SystemTest();
  ~SystemTest() override;

  [[nodiscard]] const std::filesystem::path& directory() const noexcept { return directory_; }
  [[nodiscard]] const std::string& test_name() const noexcept { return test_name_; }

  /// `hybridtest run` or `simulate` of the scenario into `directory() / run`.
  [[nodiscard]] StartedProgram start_run(const std::filesystem::path& scenario, const std::string& run,
                                         const Arguments& more = {}, const ProgramOptions& options = {}) const;
  [[nodiscard]] StartedProgram start_simulate(const std::filesystem::path& scenario, const std::string& run,
                                              const Arguments& more = {}, const ProgramOptions& options = {}) const;
  /// One of the three programs, as started from its own terminal on this machine.
  [[nodiscard]] StartedProgram start_participant(const std::string& program, const std::string& id,
                                                 const std::filesystem::path& scenario, const std::string& run,
                                                 const Arguments& more = {}, const ProgramOptions& options = {}) const;
  /// Any subcommand of `hybridtest`, without further arguments.
  [[nodiscard]] StartedProgram start_hybridtest(const Arguments& arguments, const std::string& output) const;

  [[nodiscard]] RecordedRun recorded(const std::string& run) const { return RecordedRun{directory_ / run}; }
  /// Waits until the participant's file holds this many steps.
  [[nodiscard]] bool has_recorded(const std::string& run, std::string_view participant, double step) const;
  /// Domain of the test, for every command that talks to others.
  [[nodiscard]] Arguments network() const { return {"--domain", std::to_string(domain_)}; }

 private:
  /// Beside the run directories, never in one.
  [[nodiscard]] std::filesystem::path output(std::string run, const std::string& id) const;
  [[nodiscard]] Arguments shared(const std::filesystem::path& scenario, const std::string& run,
                                 const Arguments& more) const;

  std::filesystem::path directory_;
  std::string test_name_;
  int domain_ = 0;
};

/// The running process of a participant that `hybridtest run` started; 0 when there is none.
[[nodiscard]] pid_t participant_of(const StartedProgram& run, std::string_view id);

/// A scenario that ships with the program.
[[nodiscard]] std::filesystem::path shipped_scenario(const std::string& name);
/// One written for these tests.
[[nodiscard]] std::filesystem::path system_scenario(const std::string& name);
[[nodiscard]] std::filesystem::path program(const std::string& name);

}  // namespace hybridtest
