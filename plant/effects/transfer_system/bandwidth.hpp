#pragma once

#include <Eigen/Core>
#include <array>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/first_order_lag.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// The actuator has poles that its model lacks (Zhao, French, Shield and Posbergh, Earthquake Eng.
/// Struct. Dyn. 32, 2003):
///
///     x0(s) = u(s) / (1 + T s + r T^2 s^2)
///
/// One pole for r = 0, two equal ones for r = 1/4, a resonance beyond: natural frequency
/// 1 / (T sqrt(r)) rad/s, damping ratio 1 / (2 sqrt(r)). T is the delay of slow motion whatever r
/// is. Exact for a command that runs straight from sample to sample (matrix exponential; Van
/// Loan, IEEE Trans. Automatic Control 23, 1978).
class Bandwidth final : public Effect {
 public:
  static constexpr std::string_view kEquation = "x0 + T x0' + r T^2 x0'' = u";
  static constexpr std::string_view kSource = "Zhao et al. (2003)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::rate, .needs_time = true};
  static constexpr std::array kParameters{
      EffectParameter{
          .name = "time_constant_s", .unit = "s", .what = "T, delay of slow motion", .low = 0.0, .high = 1e3},
      EffectParameter{.name = "second_order_ratio",
                      .unit = "",
                      .what = "r, 0: one pole, 0.25: two equal ones",
                      .low = 0.0,
                      .high = 100.0,
                      .neutral = kNoNeutral,
                      .fallback = 0.0}};

  Bandwidth(std::span<const double> values, double sample_period_s);
  void before(const StageSample& sample, Motion& command) noexcept override;
  void reset() noexcept override;

 private:
  bool is_resonant_ = false;
  // Real poles: the difference of two lags.
  FirstOrderLag slow_;
  FirstOrderLag fast_;
  double slow_share_ = 1.0;
  double fast_share_ = 0.0;
  // Otherwise: displacement and T times the velocity.
  Eigen::Matrix2d transition_ = Eigen::Matrix2d::Zero();
  Eigen::Vector2d from_previous_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d from_newest_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d state_ = Eigen::Vector2d::Zero();
  double previous_m_ = 0.0;
};

}  // namespace hybridtest
