#include "plant/effects/stage.hpp"

#include <utility>

#include "core/assert.hpp"

namespace hybridtest {

StageEffects::StageEffects(std::vector<std::unique_ptr<Effect>> effects) : effects_{std::move(effects)} {
  for (const auto& effect : effects_) {
    HYBRIDTEST_ASSERT(effect != nullptr);
    if (effect->is_of_base()) of_base_.push_back(effect.get());
  }
}

void StageEffects::reset() noexcept {
  for (const auto& effect : effects_) effect->reset();
}

}  // namespace hybridtest
