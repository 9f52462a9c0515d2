#pragma once

#include "core/answer_memory.hpp"
#include "core/presence.hpp"

namespace hybridtest {

/// Reports why a substructure does not go on under a resumed coordinator, with the step that it was asked for. The
/// caller ends its part of the test.
/// @param recall   of the point: different or forgotten.
inline void report_refused_resumption(Recall recall, const CommandPoint& point, const AnswerMemory& memory,
                                      Presence& presence, Instant now) noexcept {
  presence.raise(FaultFlags::resume_refused);
  if (recall == Recall::forgotten) {
    presence.report(now, Severity::fault, EventCode::answer_forgotten, presence.identity().id,
                    {static_cast<double>(memory.oldest_step()), static_cast<double>(point.step)}, point.step,
                    point.model_time_s);
  } else {
    presence.report(now, Severity::fault, EventCode::imposed_differently, presence.identity().id,
                    memory.difference(point), point.step, point.model_time_s);
  }
}

}  // namespace hybridtest
