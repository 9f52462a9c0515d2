#pragma once

#include <array>
#include <cstdint>

#include "core/random.hpp"
#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// Targets that are lost on their way; the newest that came is held (Mosqueda, Stojadinovic and Mahin, EERC 2005-08).
/// Each is lost by itself, as drawn from a seeded stream.
class NetworkLoss final : public Effect {
 public:
  static constexpr std::string_view kEquation = "u = newest target that was not lost, each lost with probability p";
  static constexpr std::string_view kSource = "Mosqueda et al. (2005)";
  static constexpr EffectTraits kTraits{
      .family = EffectFamily::arrival, .digits = DigitTrace::loss, .needs_time = true};
  static constexpr std::array kParameters{
      EffectParameter{.name = "loss_ratio", .unit = "", .what = "p, share of lost targets", .low = 0.0, .high = 1.0},
      EffectParameter{.name = "seed",
                      .unit = "",
                      .what = "of the draw",
                      .low = 0.0,
                      .high = 9007199254740992.0,
                      .neutral = kNoNeutral,
                      .fallback = 0.0}};

  NetworkLoss(std::span<const double> values, double /*sample_period_s*/)
      : loss_ratio_{values[0]},
        initial_random_{static_cast<std::uint64_t>(values[1]), kStream},
        random_{initial_random_} {}
  void before(const StageSample& /*sample*/, Motion& target) noexcept override {
    if (random_.uniform() >= loss_ratio_) held_m_ = target.displacement_m;
    target.displacement_m = held_m_;
  }
  void reset() noexcept override {
    random_ = initial_random_;
    held_m_ = 0.0;
  }

 private:
  static constexpr std::uint64_t kStream = 101;

  double loss_ratio_;
  Random initial_random_;
  Random random_;
  double held_m_ = 0.0;
};

}  // namespace hybridtest
