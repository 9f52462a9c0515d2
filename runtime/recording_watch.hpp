#pragma once

#include "core/presence.hpp"
#include "core/time.hpp"
#include "recording/recorder.hpp"

namespace hybridtest {

/// Reports once that a participant's recording failed, and once that it dropped rows. The coordinator then decides by
/// `recording.on_failure` whether the test ends.
class RecordingWatch {
 public:
  /// @return true when the recording is found failed for the first time; Recorder::error_text() says why.
  bool look(const Recorder& recorder, Presence& presence, Instant now) noexcept;

 private:
  bool reported_failure_ = false;
  bool reported_drop_ = false;
};

}  // namespace hybridtest
