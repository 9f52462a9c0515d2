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
    return after(sample, motion, base(for_base(motion)));
  }
  /// The parts of step(), for a base that several stages share: the motion as changed,
  [[nodiscard]] Motion before(const StageSample& sample) noexcept {
    Motion motion = sample.motion;
    for (const auto& effect : effects_) effect->before(sample, motion);
    return motion;
  }
  /// the one that the base is given,
  [[nodiscard]] Motion for_base(Motion motion) const noexcept {
    for (Effect* const number : of_base_) number->before_base(motion);
    return motion;
  }
  /// and what comes out. @param motion   of before(); @param output   of the base.
  [[nodiscard]] double after(const StageSample& sample, const Motion& motion, double output) noexcept {
    for (Effect* const number : of_base_) number->after_base(output);
    for (const auto& effect : effects_) effect->after(sample, motion, output);
    return output;
  }
  void reset() noexcept;
  [[nodiscard]] bool empty() const noexcept { return effects_.empty(); }

 private:
  std::vector<std::unique_ptr<Effect>> effects_;
  std::vector<Effect*> of_base_;  // of these
};

}  // namespace hybridtest
