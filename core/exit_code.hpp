#pragma once

#include <algorithm>
#include <array>
#include <string_view>

#include "core/faults.hpp"

namespace hybridtest {

/// Exit codes of every program.
inline constexpr int kExitCompleted = 0;
inline constexpr int kExitConfiguration = 2;  // also: a participant missing, refused or not able to start
inline constexpr int kExitEndedEarly = 3;     // interlock, participant lost, stopped by the operator
inline constexpr int kExitDataInvalid = 4;
inline constexpr int kExitInternal = 70;

/// One way in which a test can end.
struct TestEnd {
  StopReason reason = StopReason::none;
  std::string_view name;     // in recordings and summary.json
  std::string_view verdict;  // for users; the summary adds who and when
  int exit_code = kExitInternal;
};

/// All of them, one row per StopReason; docs/ends.md describes each.
inline constexpr std::array<TestEnd, 19> kTestEnds{{
    {StopReason::none, "none", "end unknown", kExitEndedEarly},
    {StopReason::completed, "completed", "completed", kExitCompleted},
    {StopReason::interrupted, "interrupted", "stopped by the operator", kExitEndedEarly},
    {StopReason::interlock, "interlock", "ended by an interlock", kExitEndedEarly},
    {StopReason::participant_lost, "participant_lost", "ended: a participant was lost", kExitEndedEarly},
    {StopReason::coordinator_lost, "coordinator_lost", "ended: the coordinator was lost", kExitEndedEarly},
    {StopReason::not_finite, "not_finite", "ended: a number was not finite", kExitEndedEarly},
    {StopReason::not_assembled, "not_assembled", "never started: a participant is missing", kExitConfiguration},
    {StopReason::refused, "refused", "never started: refused", kExitConfiguration},
    {StopReason::recording_failed, "recording_failed", "ended: recording failed", kExitDataInvalid},
    {StopReason::emergency_stop, "emergency_stop", "ended by an emergency stop", kExitEndedEarly},
    {StopReason::participant_failed, "participant_failed", "never started: a participant failed", kExitConfiguration},
    {StopReason::no_equilibrium, "no_equilibrium", "ended: no equilibrium in a step", kExitEndedEarly},
    {StopReason::opensees_lost, "opensees_lost", "ended: OpenSees was lost", kExitEndedEarly},
    {StopReason::opensees_iterates, "opensees_iterates", "ended: OpenSees iterates on a specimen", kExitEndedEarly},
    {StopReason::model_failed, "model_failed", "ended: a numerical model failed", kExitEndedEarly},
    {StopReason::deadlines_missed, "deadlines_missed", "ended: too many deadlines missed in a row", kExitEndedEarly},
    {StopReason::network_too_slow, "network_too_slow", "never started: the round trip does not fit into a step",
     kExitConfiguration},
    {StopReason::resume_refused, "resume_refused", "ended: the resumed test asked for another motion than was imposed",
     kExitEndedEarly},
}};

/// @return the row of `none` for a number that is no reason.
[[nodiscard]] constexpr const TestEnd& test_end(StopReason reason) noexcept {
  const auto* row = std::ranges::find(kTestEnds, reason, &TestEnd::reason);
  return row == kTestEnds.end() ? kTestEnds.front() : *row;
}

/// The exit code of a participant that ended for this reason.
[[nodiscard]] constexpr int exit_code_for(StopReason reason) noexcept { return test_end(reason).exit_code; }

}  // namespace hybridtest
