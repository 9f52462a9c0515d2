#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// The clock of the site is slow: it plays the targets later and later (Mills, RFC 5905, 2010), until it is a second
/// behind, where the coupling would have ended.
class ClockDrift final : public Effect {
 public:
  static constexpr std::string_view kEquation = "u(t) = u0((1 - r) t), at most 1 s behind";
  static constexpr std::string_view kSource = "Mills (2010)";
  static constexpr EffectTraits kTraits{.family = EffectFamily::arrival, .needs_time = true};
  static constexpr std::array kParameters{EffectParameter{
      .name = "drift_ratio", .unit = "", .what = "r, seconds lost per second", .low = 0.0, .high = 0.1}};

  ClockDrift(std::span<const double> values, double sample_period_s);
  void before(const StageSample& sample, Motion& target) noexcept override;
  void reset() noexcept override;

 private:
  double drift_ratio_;
  std::vector<double> samples_;  // a ring of the last second
  std::size_t newest_ = 0;
  double lag_ = 0.0;  // in samples
};

}  // namespace hybridtest
