#pragma once

#include <Eigen/Core>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/first_order_lag.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// The ratio r of SecondOrderLag as a parameter of an effect.
constexpr EffectParameter second_order_ratio(std::string_view what) {
  return {.name = "second_order_ratio",
          .unit = "",
          .what = what,
          .low = 0.0,
          .high = 100.0,
          .neutral = kNoNeutral,
          .fallback = 0.0};
}

/// Two poles,
///
///     x(s) = u(s) / (1 + T s + r T^2 s^2)
///
/// one for r = 0, two equal ones for r = 1/4, a Butterworth filter for r = 1/2, a resonance beyond: natural frequency
/// 1 / (T sqrt(r)) rad/s, damping ratio 1 / (2 sqrt(r)). T is the delay of a slow signal whatever r is. Exact for a
/// signal that runs straight from sample to sample (matrix exponential; Van Loan, IEEE Trans. Automatic Control 23,
/// 1978). At rest at zero one sample before the first.
class SecondOrderLag {
 public:
  SecondOrderLag(double time_constant_s, double ratio, double period_s);

  [[nodiscard]] double step(double newest) noexcept;
  void reset() noexcept;

 private:
  bool is_resonant_ = false;
  // Real poles: the difference of two lags.
  FirstOrderLag slow_;
  FirstOrderLag fast_;
  double slow_share_ = 1.0;
  double fast_share_ = 0.0;
  // Otherwise: value and T times its rate.
  Eigen::Matrix2d transition_ = Eigen::Matrix2d::Zero();
  Eigen::Vector2d from_previous_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d from_newest_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d state_ = Eigen::Vector2d::Zero();
  double previous_ = 0.0;
};

}  // namespace hybridtest
