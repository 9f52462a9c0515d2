#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hybridtest {

class RunFileReader;

/// Bounds of the offset of a clock from half a second of exchanges; see ClockWindow for `there` and `back`. All by the
/// coordinator's clock [s].
struct ClockBounds {
  double there_at_s = 0.0;
  double there_s = 0.0;  // the least: the offset was not more
  double back_at_s = 0.0;
  double back_s = 0.0;  // the least: the offset was not less than -back_s
  double exchanges = 0.0;
  double mean_there_s = 0.0;
  double mean_back_s = 0.0;
};

/// The clock of a participant against the coordinator's, over a part of a test:
///
///   clock = coordinator's + offset_s + drift (coordinator's - at_s).
///
/// The offset and the drift are the middle of all straight lines between the bounds, and the uncertainties are half the
/// range of those lines: they hold the truth, not a share of it, as long as the drift is constant over the part and no
/// latency is negative.
struct ClockRelation {
  double begin_s = 0.0;  // of the part, by the coordinator's clock
  double end_s = 0.0;
  double at_s = 0.0;  // its middle
  double offset_s = 0.0;
  double offset_uncertainty_s = 0.0;
  double drift = 0.0;  // [s/s]
  double drift_uncertainty = 0.0;
  double latency_there_s = 0.0;  // mean, of the commands; its uncertainty is that of the offset
  double latency_back_s = 0.0;   // mean, of the answers; likewise

  /// Of a reading of the participant's clock: that of the coordinator's at the same time [s].
  [[nodiscard]] double to_coordinator_s(double clock_s) const noexcept;
  /// How far off that may be [s].
  [[nodiscard]] double uncertainty_s(double coordinator_s) const noexcept;
};

/// The relation over all of the bounds. Those that contradict each other, because a machine stood still between a
/// message and the reading of its clock, are left out in pairs.
/// @return nothing when no bound is left.
[[nodiscard]] std::optional<ClockRelation> relate_clocks(std::span<const ClockBounds> bounds);

/// Relations of one participant, in parts of up to two minutes, in which a quartz keeps its drift.
struct ParticipantClock {
  std::string participant;
  std::vector<ClockRelation> parts;  // in their order; never empty

  /// The part that a reading of its clock belongs to, or the nearest.
  [[nodiscard]] const ClockRelation& at(double clock_s) const noexcept;
};

/// From the table `clocks` of the coordinator's file; participants without an exchange are absent.
[[nodiscard]] std::vector<ParticipantClock> participant_clocks(const RunFileReader& coordinator);

}  // namespace hybridtest
