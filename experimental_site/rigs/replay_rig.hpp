#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "experimental_site/rigs/rig.hpp"

namespace hybridtest {

/// What was measured once, over time.
struct RecordedMeasurement {
  std::vector<double> time_s;                   // [s] strictly rising, at least one
  std::vector<InterfaceVector> displacement_m;  // [m] one for each time
  std::vector<InterfaceVector> force_n;         // [N] one for each time
};

/// Feeds a recorded measurement back, whatever is commanded: for post-mortems, where interlocks,
/// compensation or coordinator are tried again on what a specimen once answered.
///
/// The record's first time is the time of arming; values lie straight between those of the record.
/// Before arm() it stands at the record's begin, once stopped where it is.
class ReplayRig final : public Rig {
 public:
  enum class AtEnd : std::uint8_t {
    fault,  // beyond the record's end there is nothing to tell
    hold,   // the last measurement stays
  };

  /// @throws ConfigError for a record without rows, of unequal lengths or widths, with numbers that are not
  ///         finite, or with times that do not rise.
  ReplayRig(RecordedMeasurement record, AtEnd at_end);

  void connect() override;
  /// @throws std::runtime_error without a connect() before, or when stopped since then.
  void arm() override;
  [[nodiscard]] RigStatus exchange(const ActuatorCommand& command, RigFeedback& feedback) noexcept override;
  void stop_motion() noexcept override { phase_ = Phase::stopped; }

 private:
  enum class Phase : std::uint8_t { disconnected, connected, armed, stopped };

  /// @return false beyond the end of the record.
  bool move_to(double time_s) noexcept;

  RecordedMeasurement record_;
  AtEnd at_end_;
  std::atomic<Phase> phase_{Phase::disconnected};  // the only member that stop_motion() touches
  std::size_t row_ = 0;                            // the last one that is not later than now
  RigFeedback present_;
};

}  // namespace hybridtest
