#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "core/child_process.hpp"
#include "core/time.hpp"
#include "scenario/opensees_section.hpp"

namespace hybridtest {

/// The OpenSees that leads a test: started by the coordinator, ended with the test. Its output is opensees.log in the
/// folder of the run. Started by hand, it is only told of.
class LeadProcess {
 public:
  /// Starts it, unless it is started by hand. HYBRIDTEST_RUN_DIRECTORY in its environment names the folder of the run.
  /// @throws ConfigError where there is no OpenSees; std::runtime_error when it cannot be started.
  LeadProcess(const OpenSeesLeadScenario& lead, const std::filesystem::path& run_directory);

  /// Its process has ended, and what it sent last had the time to arrive.
  [[nodiscard]] bool has_left(Instant now) noexcept;
  /// How it ended, with the end of its log; empty while it runs.
  [[nodiscard]] std::string end_text() const;
  /// Ends it after the test.
  /// @param is_completed   it may finish its script within `limit`; otherwise it is ended at once: it waits for an
  /// answer
  ///                       that will not come.
  /// @return what the users should know; empty when there is nothing.
  [[nodiscard]] std::string finish(bool is_completed, Duration limit);

 private:
  std::unique_ptr<ChildProcess> child_;  // none when it is started by hand
  std::optional<Instant> left_;
};

}  // namespace hybridtest
