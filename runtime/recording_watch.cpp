#include "runtime/recording_watch.hpp"

namespace hybridtest {

bool RecordingWatch::look(const Recorder& recorder, Presence& presence, Instant now) noexcept {
  const bool fails_now = !reported_failure_ && recorder.failed();
  if (fails_now) {
    reported_failure_ = true;
    presence.raise(FaultFlags::recording_failed);
    presence.report(now, Severity::fault, EventCode::recording_failed, {},
                    {static_cast<double>(recorder.error_number()), 0.0});
  }
  if (!reported_drop_ && recorder.dropped() > 0) {
    reported_drop_ = true;
    presence.raise(FaultFlags::records_dropped);
    presence.report(now, Severity::fault, EventCode::records_dropped, {},
                    {static_cast<double>(recorder.dropped()), 0.0});
  }
  return fails_now;
}

}  // namespace hybridtest
