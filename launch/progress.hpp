#pragma once

#include <cstdio>
#include <map>
#include <string>
#include <string_view>

#include "core/messages.hpp"
#include "core/time.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {

[[nodiscard]] std::string_view name(LifecycleState state) noexcept;

/// What a person sees while a test runs: on a terminal one line that is rewritten, elsewhere a
/// plain line now and then. Events are printed above it.
class Progress {
 public:
  /// @param out   standard error, as a rule; standard output stays free for the summary.
  Progress(const Scenario& scenario, std::FILE* out);
  /// Ends the rewritten line.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void learn(const ParticipantStatus& status);
  void learn(const SignalBlock& block);
  /// The newest step that is completed.
  void set_completed(Step step, Instant now);
  void print(const Event& event);
  /// Shows where the test stands, if it is time to.
  void show(Instant now);

 private:
  [[nodiscard]] std::string line() const;
  void clear_line();

  const Scenario& scenario_;
  std::FILE* out_;
  bool is_terminal_;
  bool line_is_shown_ = false;
  Instant next_show_{};
  Step completed_ = 0;
  Instant first_step_at_{};
  Instant last_step_at_{};
  std::map<std::string, LifecycleState, std::less<>> states_;
  std::map<SubstructureIndex, SignalSample> signals_;
};

}  // namespace hybridtest
