#include "coordinator/rehearsal.hpp"

#include <algorithm>

namespace hybridtest {

Rehearsal::Rehearsal(std::size_t substructures, Duration step)
    : step_{step},
      rounds_{std::clamp(static_cast<int>(std::min<std::int64_t>(kLongest / step, kRoundsMost)), kRoundsLeast,
                         kRoundsMost)},
      round_trips_(substructures, std::vector<Duration>(static_cast<std::size_t>(rounds_), Duration::max())) {}

void Rehearsal::begin(Instant now) noexcept { due_ = now; }

std::optional<std::uint16_t> Rehearsal::next_round(Instant now) noexcept {
  if (now < due_ || round_ + 1 >= rounds_) return {};
  ++round_;
  sent_ = now;
  due_ = now + step_;
  return static_cast<std::uint16_t>(round_);
}

void Rehearsal::take(const ForceMeasurement& answer, Instant now) noexcept {
  if (answer.step != kNoStep || answer.substructure >= round_trips_.size() || answer.iteration != round_) return;
  Duration& kept = round_trips_[answer.substructure][static_cast<std::size_t>(round_)];
  kept = std::min(kept, now - sent_);
}

bool Rehearsal::is_over(Instant now) const noexcept { return round_ + 1 >= rounds_ && now >= due_; }

Duration Rehearsal::percentile(SubstructureIndex substructure, int percent) noexcept {
  std::vector<Duration>& all = round_trips_[substructure];
  std::ranges::sort(all);
  return all[(all.size() * static_cast<std::size_t>(percent) + 99) / 100 - 1];
}

}  // namespace hybridtest
