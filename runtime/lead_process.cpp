#include "runtime/lead_process.hpp"

#include <fmt/format.h>

#include <csignal>
#include <cstdlib>

#include "core/opensees_program.hpp"

namespace hybridtest {
namespace {

/// For the last messages of a process that has ended.
constexpr Duration kAfterEnd = std::chrono::milliseconds{300};
/// Between the request to end and its end by force.
constexpr Duration kGrace = std::chrono::seconds{2};
constexpr std::size_t kLogLines = 10;

}  // namespace

LeadProcess::LeadProcess(const OpenSeesLeadScenario& lead, const std::filesystem::path& run_directory) {
  if (lead.script.empty()) return;
  const std::filesystem::path directory = std::filesystem::absolute(run_directory);
  limit_opensees_threads();
  setenv("HYBRIDTEST_RUN_DIRECTORY", directory.c_str(), 1);
  ChildStart start;
  start.program = find_opensees(lead.program);
  start.arguments = {std::filesystem::absolute(lead.script).string()};
  start.arguments.insert(start.arguments.end(), lead.arguments.begin(), lead.arguments.end());
  start.log_file = directory / "opensees.log";
  start.directory = std::filesystem::absolute(lead.script).parent_path();
  start.is_killed_with_parent = true;
  child_ = std::make_unique<ChildProcess>("opensees", start);
}

bool LeadProcess::has_left(Instant now) noexcept {
  if (!child_ || child_->is_running()) return false;
  if (!left_) left_ = now;
  return now - *left_ >= kAfterEnd;
}

std::string LeadProcess::end_text() const {
  if (!child_ || !child_->exit_code()) return {};
  std::string text = child_->signal() != 0 ? fmt::format("OpenSees was ended by the signal {}", child_->signal())
                                           : fmt::format("OpenSees ended with the exit code {}", *child_->exit_code());
  text += fmt::format("; the end of its log {}:", child_->log_file().string());
  for (const std::string& line : child_->last_lines(kLogLines)) text += "\n  " + line;
  return text;
}

std::string LeadProcess::finish(bool is_completed, Duration limit) {
  if (!child_) {
    return is_completed ? std::string{}
                        : "OpenSees was started by hand and may still wait for an answer: end its process by hand";
  }
  if (is_completed && child_->wait_for_end(limit)) {
    return *child_->exit_code() == 0 ? std::string{} : end_text();
  }
  if (!child_->is_running()) return {};
  child_->send_signal(SIGTERM);
  if (!child_->wait_for_end(kGrace)) child_->kill();
  return is_completed ? fmt::format("OpenSees still ran {:.6g} s after its test (timeouts.stop_s) and was ended",
                                    to_seconds(limit))
                      : std::string{};
}

}  // namespace hybridtest
