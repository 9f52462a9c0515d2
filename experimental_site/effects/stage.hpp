#pragma once

#include <memory>
#include <vector>

#include "experimental_site/effects/effect.hpp"

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
    Motion motion = sample.motion;
    for (const auto& effect : effects_) effect->before(sample, motion);
    double output = base(motion);
    for (const auto& effect : effects_) effect->after(sample, motion, output);
    return output;
  }
  void reset() noexcept;
  [[nodiscard]] bool empty() const noexcept { return effects_.empty(); }

 private:
  std::vector<std::unique_ptr<Effect>> effects_;
};

}  // namespace hybridtest
