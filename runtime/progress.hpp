#pragma once

#include <cstdio>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/messages.hpp"
#include "core/time.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {

[[nodiscard]] std::string_view name(LifecycleState state) noexcept;

/// The display of a running test: on a terminal one line, rewritten in place and never longer than the terminal is
/// wide; otherwise one plain line every few seconds. Events are printed above it. Of an event that repeats, the first
/// three are printed, and from time to time how often it has come since.
class Progress {
 public:
  /// @param out   usually standard error; standard output is for the summary.
  /// @param heard   the participants whose states are shown; all of the scenario by default.
  Progress(const Scenario& scenario, std::FILE* out, std::vector<std::string> heard = {});
  /// Prints what is left of repeated events and ends the rewritten line.
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

  /// The state in at most `width` columns: step, time and rate, then the states of the participants, then as many
  /// signals as fit.
  [[nodiscard]] std::string line(std::size_t width) const;

 private:
  /// Events that are alike but for their numbers.
  struct Repeated {
    Event last;
    int printed = 0;  // in the present window
    int unprinted = 0;
    Instant window_end{};
  };

  void print_line(const Event& event, const std::string& suffix);
  void print_repeated(Instant now);
  [[nodiscard]] std::string states() const;

  const Scenario& scenario_;
  std::FILE* out_;
  std::vector<std::string> heard_;
  bool is_terminal_;
  bool line_is_shown_ = false;
  Instant now_{};  // of the last show()
  Instant next_show_{};
  Step completed_ = 0;
  Instant first_step_at_{};
  Instant last_step_at_{};
  std::map<std::string, LifecycleState, std::less<>> states_;
  /// Of a site's first interface degree of freedom.
  struct Reading {
    double displacement_m = 0.0;
    double force_n = 0.0;
  };
  std::map<std::string, Reading, std::less<>> readings_;
  std::map<std::string, Repeated> repeated_;  // by source, code and subject
};

}  // namespace hybridtest
