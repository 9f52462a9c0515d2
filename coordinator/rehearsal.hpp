#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/messages.hpp"
#include "core/time.hpp"

namespace hybridtest {

/// The round trips to the substructures before a test in real time, measured at the rate and with the message sizes of
/// the test. Nothing moves. Answers that are lost or come after the next round count as endless.
class Rehearsal {
 public:
  static constexpr int kRoundsMost = 256;
  static constexpr int kRoundsLeast = 16;
  /// Long steps have fewer rounds, so that the rehearsal takes no longer than this where it can.
  static constexpr Duration kLongest = std::chrono::seconds{2};

  Rehearsal(std::size_t substructures, Duration step);

  void begin(Instant now) noexcept;
  /// @return the number of the round whose commands are to be sent now.
  [[nodiscard]] std::optional<std::uint16_t> next_round(Instant now) noexcept;
  void take(const ForceMeasurement& answer, Instant now) noexcept;
  /// All rounds were sent, and the last one had its time.
  [[nodiscard]] bool is_over(Instant now) const noexcept;
  [[nodiscard]] Instant wake() const noexcept { return due_; }

  /// Of all rounds; Duration::max() when so many answers were lost that there is none.
  [[nodiscard]] Duration percentile(SubstructureIndex substructure, int percent) noexcept;

 private:
  Duration step_;
  int rounds_;
  int round_ = -1;
  Instant due_ = kNever;
  Instant sent_{};
  std::vector<std::vector<Duration>> round_trips_;  // by substructure
};

}  // namespace hybridtest
