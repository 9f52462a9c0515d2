#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "experimental_site/rigs/rig.hpp"

namespace hybridtest {

/// A recorded measurement.
struct RecordedMeasurement {
  std::vector<double> time_s;              // [s] strictly increasing, at least one
  std::vector<SiteVector> displacement_m;  // [m] one for each time
  std::vector<SiteVector> force_n;         // [N] one for each time
};

/// Returns a recorded measurement as the feedback, independent of the command. For the analysis after
/// a test: interlocks, compensation or coordinator run again on the recorded answer of a specimen.
///
/// The first time of the record is the time of arming. Values between two rows are interpolated
/// linearly. Before arm() the feedback is the first row; after stop_motion() it does not change.
class ReplayRig final : public Rig {
 public:
  enum class AtEnd : std::uint8_t {
    fault,  // an exchange after the end of the record is a fault
    hold,   // the last measurement is kept
  };

  /// @throws ConfigError for a record without rows, of unequal lengths or widths, with numbers that are not
  ///         finite, or with times that do not increase.
  ReplayRig(RecordedMeasurement record, AtEnd at_end);

  void connect() override;
  /// @throws std::runtime_error without a connect() before, or when stopped since then.
  void arm() override;
  [[nodiscard]] RigStatus exchange(const ActuatorCommand& command, RigFeedback& feedback) noexcept override;
  [[nodiscard]] RigFault fault() const noexcept override { return fault_; }
  void stop_motion() noexcept override { phase_ = Phase::stopped; }

 private:
  enum class Phase : std::uint8_t { disconnected, connected, armed, stopped };

  /// @return false beyond the end of the record.
  bool move_to(double time_s) noexcept;

  RecordedMeasurement record_;
  AtEnd at_end_;
  RigFault fault_ = RigFault::unknown;
  std::atomic<Phase> phase_{Phase::disconnected};  // the only member that stop_motion() uses
  std::size_t row_ = 0;                            // the last one that is not later than now
  RigFeedback present_;
};

}  // namespace hybridtest
