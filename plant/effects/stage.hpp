#pragma once

#include <memory>
#include <vector>

#include "plant/effects/effect.hpp"

namespace hybridtest {

/// The effects on one stage, in order. See Effect.
class StageEffects {
 public:
  StageEffects() = default;
  /// @param effects   none null.
  explicit StageEffects(std::vector<std::unique_ptr<Effect>> effects);

  /// Runs the stage once around its base.
  /// @param base   called once with the motion as changed; returns the base's output.
  template <class Base>
  [[nodiscard]] double step(const StageSample& sample, Base&& base) noexcept {
    const Motion motion = before(sample);
    return after(sample, motion, base(motion));
  }
  /// The two halves of step(), for a base that several stages share.
  [[nodiscard]] Motion before(const StageSample& sample) noexcept {
    Motion motion = sample.motion;
    for (const auto& effect : effects_) effect->before(sample, motion);
    return motion;
  }
  [[nodiscard]] double after(const StageSample& sample, const Motion& motion, double output) noexcept {
    for (const auto& effect : effects_) effect->after(sample, motion, output);
    return output;
  }
  void reset() noexcept;
  [[nodiscard]] bool empty() const noexcept { return effects_.empty(); }

 private:
  std::vector<std::unique_ptr<Effect>> effects_;
};

}  // namespace hybridtest
