#pragma once

#include "core/faults.hpp"

namespace hybridtest {

/// Exit codes of every program.
inline constexpr int kExitCompleted = 0;
inline constexpr int kExitConfiguration = 2;  // also: a participant missing or refused
inline constexpr int kExitEndedEarly = 3;     // interlock, participant lost, stopped by hand
inline constexpr int kExitDataInvalid = 4;
inline constexpr int kExitInternal = 70;

/// The exit code of a participant that ended for this reason.
[[nodiscard]] constexpr int exit_code_for(StopReason reason) noexcept {
  switch (reason) {
    case StopReason::completed: return kExitCompleted;
    case StopReason::not_assembled:
    case StopReason::refused: return kExitConfiguration;
    case StopReason::recording_failed: return kExitDataInvalid;
    case StopReason::none:
    case StopReason::interrupted:
    case StopReason::interlock:
    case StopReason::participant_lost:
    case StopReason::coordinator_lost:
    case StopReason::not_finite: return kExitEndedEarly;
  }
  return kExitInternal;
}

}  // namespace hybridtest
