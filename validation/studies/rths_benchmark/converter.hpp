#pragma once

#include <algorithm>
#include <cmath>

namespace hybridtest::rths {

/// Range of the converters of the benchmark; one volt is one unit.
[[nodiscard]] inline double saturated(double value) noexcept { return std::clamp(value, -3.8, 3.8); }

/// Resolution of the converters, 2^-18.
[[nodiscard]] inline double quantised(double value) noexcept { return std::nearbyint(value * 0x1p18) * 0x1p-18; }

}  // namespace hybridtest::rths
