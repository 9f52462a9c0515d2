#pragma once

#include <algorithm>
#include <cmath>

namespace hybridtest {

/// Seals that hold an actuator after each reversal until it is asked to go so much further; then it gains on what is
/// asked at a velocity.
class MadeSeals {
 public:
  /// @param gained_m   in a sample.
  MadeSeals(double breakaway_m, double gained_m) : breakaway_m_{breakaway_m}, gained_m_{gained_m} {}

  /// Where the actuator is at the next sample.
  double next_m(double asked_m) {
    const double travel_m = asked_m - asked_m_;
    asked_m_ = asked_m;
    is_held_ = is_held_ || travel_m * way_m_ < 0.0;
    if (is_held_) behind_m_ += travel_m;
    if (is_held_ && std::abs(behind_m_) > breakaway_m_) {
      is_held_ = false;
      way_m_ = behind_m_;
    }
    if (!is_held_) behind_m_ -= std::clamp(behind_m_, -gained_m_, gained_m_);
    return asked_m - behind_m_;
  }

 private:
  double breakaway_m_;
  double gained_m_;
  double asked_m_ = 0.0;
  double behind_m_ = 0.0;
  double way_m_ = 0.0;
  bool is_held_ = true;
};

}  // namespace hybridtest
