#pragma once

#include <cmath>

namespace hybridtest {

/// One pole with a time constant of zero or more, exact for a signal that runs straight from sample to
/// sample (first-order hold; Franklin, Powell and Workman, Digital Control of Dynamic Systems, 1998,
/// section 6.3). At rest at zero one sample before the first.
class FirstOrderLag {
 public:
  FirstOrderLag() = default;
  FirstOrderLag(double time_constant_s, double period_s) {
    const double late = time_constant_s / period_s;
    if (late < kShortest) {  // nothing is left of it but its delay
      from_previous_ = late;
    } else {
      const double mean_decay = -std::expm1(-1.0 / late) * late;
      decay_ = std::exp(-1.0 / late);
      from_previous_ = mean_decay - decay_;
    }
    from_newest_ = 1.0 - decay_ - from_previous_;
  }

  [[nodiscard]] double step(double newest) noexcept {
    value_ = decay_ * value_ + from_previous_ * previous_ + from_newest_ * newest;
    previous_ = newest;
    return value_;
  }
  void reset() noexcept { value_ = previous_ = 0.0; }

  /// In samples: a lag that is shorter passes the signal on with its delay alone.
  static constexpr double kShortest = 1e-3;

 private:
  double decay_ = 0.0;
  double from_previous_ = 0.0;
  double from_newest_ = 1.0;
  double value_ = 0.0;
  double previous_ = 0.0;
};

}  // namespace hybridtest
