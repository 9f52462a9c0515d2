#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/random.hpp"
#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// Targets that come late by a different time each, evenly spread up to J (Mosqueda, Stojadinovic and Mahin, EERC
/// 2005-08); the newest that has come is held, whatever overtook it.
class NetworkJitter final : public Effect {
 public:
  static constexpr std::string_view kEquation = "u(t) = newest u0(ti) with ti + J ui <= t, ui even in 0 to 1";
  static constexpr std::string_view kSource = "Mosqueda et al. (2005)";
  static constexpr EffectTraits kTraits{
      .family = EffectFamily::arrival, .digits = DigitTrace::lateness, .needs_time = true};
  static constexpr std::array kParameters{
      EffectParameter{.name = "jitter_s", .unit = "s", .what = "J, greatest lateness", .low = 0.0, .high = 1.0},
      EffectParameter{.name = "seed",
                      .unit = "",
                      .what = "of the draw",
                      .low = 0.0,
                      .high = 9007199254740992.0,
                      .neutral = kNoNeutral,
                      .fallback = 0.0}};

  NetworkJitter(std::span<const double> values, double sample_period_s);
  void before(const StageSample& sample, Motion& target) noexcept override;
  void reset() noexcept override;

 private:
  struct Sent {
    double displacement_m = 0.0;
    double lateness = 0.0;  // in samples
  };

  double jitter_;  // in samples
  Random initial_random_;
  Random random_;
  std::vector<Sent> sent_;  // a ring of as many as may still come
  std::size_t newest_ = 0;
};

}  // namespace hybridtest
