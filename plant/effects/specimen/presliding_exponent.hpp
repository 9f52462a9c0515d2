#pragma once

#include "plant/effects/effect_type.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

/// How a dry friction comes near sliding (PreslidingElement).
inline constexpr EffectParameter kPreslidingExponent{.name = "presliding_exponent",
                                                     .unit = "",
                                                     .what = "i, 0: elastoplastic, 1: exponential",
                                                     .low = 0.0,
                                                     .high = 5.0,
                                                     .neutral = kNoNeutral,
                                                     .fallback = 0.0};

}  // namespace hybridtest
