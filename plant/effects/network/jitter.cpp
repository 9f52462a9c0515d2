#include "plant/effects/network/jitter.hpp"

#include <algorithm>
#include <cmath>

namespace hybridtest {
namespace {

constexpr std::uint64_t kStream = 102;

}  // namespace

NetworkJitter::NetworkJitter(std::span<const double> values, double sample_period_s)
    : jitter_{values[0] / sample_period_s},
      initial_random_{static_cast<std::uint64_t>(values[1]), kStream},
      random_{initial_random_},
      sent_(static_cast<std::size_t>(std::ceil(jitter_)) + 2) {}

void NetworkJitter::before(const StageSample& /*sample*/, Motion& target) noexcept {
  newest_ = newest_ + 1 == sent_.size() ? 0 : newest_ + 1;
  sent_[newest_] = {.displacement_m = target.displacement_m, .lateness = jitter_ * random_.uniform()};
  std::size_t place = newest_;
  for (std::size_t age = 0; age + 1 < sent_.size(); ++age) {
    if (sent_[place].lateness <= static_cast<double>(age)) break;
    place = place == 0 ? sent_.size() - 1 : place - 1;
  }
  target.displacement_m = sent_[place].displacement_m;
}

void NetworkJitter::reset() noexcept {
  random_ = initial_random_;
  std::ranges::fill(sent_, Sent{});
}

}  // namespace hybridtest
