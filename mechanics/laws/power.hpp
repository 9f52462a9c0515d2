#pragma once

#include <cmath>

namespace hybridtest {

/// base^exponent, within a relative error of 1 + |log2 of the result| units in the last place (2.2e-16). Cheaper than
/// std::pow(), which also takes negative bases and is right to the last place: laws that integrate an equation need
/// neither, and do little else.
/// @param base   not negative; positive where the exponent is not.
[[nodiscard]] inline double power_of(double base, double exponent) noexcept {
  return std::exp2(exponent * std::log2(base));
}

}  // namespace hybridtest
