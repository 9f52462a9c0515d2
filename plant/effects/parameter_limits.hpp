#pragma once

#include <limits>

namespace hybridtest {

/// Bound of parameters that nothing bounds but sense: as much in any SI unit as no test has.
inline constexpr double kUnbounded = 1e12;
/// No value of the parameter alone removes the effect.
inline constexpr double kNoNeutral = std::numeric_limits<double>::quiet_NaN();

}  // namespace hybridtest
