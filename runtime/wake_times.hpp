#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <vector>

#include "core/time.hpp"

namespace hybridtest {

/// When each of a fixed number of participants wants to run. A change costs the logarithm of their number, and so does
/// each participant that is due: nobody looks at the others.
class WakeTimes {
 public:
  /// All kNever.
  explicit WakeTimes(std::size_t participants)
      : leaves_{std::bit_ceil(std::max<std::size_t>(participants, 1))}, earliest_(2 * leaves_, kNever) {}

  void set(std::size_t participant, Instant at) noexcept {
    std::size_t place = leaves_ + participant;
    earliest_[place] = at;
    for (place /= 2; place > 0; place /= 2) {
      const Instant earliest = std::min(earliest_[2 * place], earliest_[2 * place + 1]);
      if (earliest_[place] == earliest) return;  // and so are those above
      earliest_[place] = earliest;
    }
  }
  [[nodiscard]] Instant at(std::size_t participant) const noexcept { return earliest_[leaves_ + participant]; }
  /// Of all.
  [[nodiscard]] Instant earliest() const noexcept { return earliest_[1]; }
  /// The participant with earliest(), of several the first.
  [[nodiscard]] std::size_t first() const noexcept {
    std::size_t place = 1;
    while (place < leaves_) {
      place *= 2;
      if (earliest_[place] != earliest_[place / 2]) ++place;
    }
    return place - leaves_;
  }
  /// Those who want to run by now, in order.
  void find_due(Instant now, std::vector<std::size_t>& due) const {
    due.clear();
    for (std::size_t place = 1; place > 0; place = after(place)) {
      while (earliest_[place] <= now && place < leaves_) place *= 2;
      if (earliest_[place] <= now) due.push_back(place - leaves_);
    }
  }

 private:
  /// The place to look at when all of this one has been seen, in order; 0 after the last.
  [[nodiscard]] static std::size_t after(std::size_t place) noexcept {
    place >>= std::countr_one(place);  // up, out of the second halves
    return place == 0 ? 0 : place + 1;
  }

  std::size_t leaves_;             // a power of two
  std::vector<Instant> earliest_;  // [1] of all; [2 i] and [2 i + 1] of the halves of [i]; the leaves from [leaves_]
};

}  // namespace hybridtest
