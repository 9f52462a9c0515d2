#include "coordinator/command_repeats.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace hybridtest {
namespace {

using std::chrono::milliseconds;

/// Of the loss: it follows within about so many answers.
constexpr double kLossMemory = 16.0;

/// All copies of a command may be lost in this share of the steps.
constexpr double kAllLost = 0.002;

/// Between copies: not less, or a queue that overflows takes all of them.
constexpr Duration kSpacingLeast = std::chrono::microseconds{250};

/// While nothing is lost, and where the network is faster than the second time, an answer that is late was delayed by a
/// busy machine, most likely.
constexpr Duration kBusyMachine = milliseconds{20};
constexpr Duration kNear = milliseconds{5};

/// Once an answer is late: copies in a round trip, and copies after which the interval doubles.
constexpr int kInRoundTrip = 10;
constexpr int kUntilDoubled = 8;

[[nodiscard]] Duration magnitude(Duration duration) noexcept { return duration < Duration{} ? -duration : duration; }

}  // namespace

void CommandRepeats::Usual::add(Duration sample) noexcept {
  if (!std::exchange(is_known, true)) {
    mean = sample;
    deviation = sample / 2;
    return;
  }
  deviation += (magnitude(sample - mean) - deviation) / 4;
  mean += (sample - mean) / 8;
}

void CommandRepeats::open(Instant now) noexcept {
  opened_ = now;
  sent_ = 1;
  is_overdue_ = false;
  plan(now);
}

void CommandRepeats::sent_again(Instant now) noexcept {
  ++sent_;
  plan(now);
}

void CommandRepeats::answered(const ForceMeasurement& answer, Instant now) noexcept {
  due_ = kNever;
  const Instant copy_sent{answer.command_send_time};
  if (copy_sent < opened_ || copy_sent > now) return;  // not an echo of this command
  const bool was_lost = copy_sent > opened_;
  loss_ += ((was_lost ? 1.0 : 0.0) - loss_) / kLossMemory;
  if (answer.receive_time < Duration{} || answer.send_time < answer.receive_time) return;
  const Duration away = answer.send_time - answer.receive_time;
  if (away > now - copy_sent) return;
  net_.add(now - copy_sent - away);
  // The answer to a repeated command comes from memory.
  if (!any(answer.flags & MeasurementFlags::repeated)) turnaround_.add(away);
}

bool CommandRepeats::becomes_overdue(Instant now) noexcept {
  return now - opened_ >= patience_ && !std::exchange(is_overdue_, true);
}

int CommandRepeats::copies() const noexcept {
  int copies = 1;
  for (double all_lost = loss_; all_lost > kAllLost && copies < kCopiesMost; all_lost *= loss_) ++copies;
  return copies;
}

Duration CommandRepeats::turnaround() const noexcept { return std::max(turnaround_least_, turnaround_.mean); }

// Copies that are farther apart than the network varies do not overtake each other.
Duration CommandRepeats::spacing() const noexcept {
  return std::max(kSpacingLeast, std::clamp(net_.deviation, net_.mean / 32, net_.mean / 16));
}

// A substructure that takes its time has nothing to answer until then. As many copies come when it has answered.
int CommandRepeats::planned() const noexcept {
  const int early = copies();
  if (early == 1) return 1;
  return early + static_cast<int>(std::min<std::int64_t>(early - 1, turnaround() / spacing()));
}

Duration CommandRepeats::time_of(int copy) const noexcept {
  if (copy == 0) return {};
  const int early = copies();
  if (copy < early) return copy * spacing();
  return std::max(early * spacing(), turnaround() + 3 * spacing() / 2) + (copy - early) * spacing();
}

Duration CommandRepeats::late_after(int planned) const noexcept {
  if (!net_.is_known) return patience_;
  const bool is_lossy = planned > 1;
  const Duration varies = 4 * (net_.deviation + turnaround_.deviation);
  const Duration least = is_lossy ? std::max<Duration>(milliseconds{1}, net_.mean / kInRoundTrip) : kBusyMachine;
  return std::max(turnaround(), time_of(planned - 1)) + net_.mean + std::max(varies, least);
}

Duration CommandRepeats::interval(int number) const noexcept {
  if (!net_.is_known) return patience_;
  const Duration first = net_.mean < kNear ? kBusyMachine : net_.mean / kInRoundTrip;
  return std::min(patience_, first * (1 << std::min(number / kUntilDoubled, 10)));
}

void CommandRepeats::plan(Instant now) noexcept {
  const int planned = this->planned();
  if (sent_ < planned) {
    due_ = opened_ + time_of(sent_);
  } else if (sent_ == planned) {
    due_ = opened_ + late_after(planned);
  } else {
    due_ = now + interval(sent_ - planned - 1);
  }
}

}  // namespace hybridtest
