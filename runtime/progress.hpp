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

/// The display of a running test: on a terminal one line, rewritten in place; otherwise one plain line
/// every few seconds. Events are printed above it.
class Progress {
 public:
  /// @param out   usually standard error; standard output is for the summary.
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
  /// Shows the state of the test, if the next display is due.
  void show(Instant now);
  /// Takes the rewritten line off the terminal, before something else is printed there.
  void clear_line();

 private:
  [[nodiscard]] std::string line() const;

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
