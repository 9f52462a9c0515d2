#pragma once

#include "diagnosis/tuning.hpp"

namespace hybridtest {

/// Whether a cause leaves so little that it is named: near the floor, or a small share and not well above the floor.
/// @param left         share of the gap that is left [variance].
/// @param over_floor   the residual over the floor and what no model is expected to reproduce [rms over rms].
/// @param allowed      share up to which a cause is named.
[[nodiscard]] constexpr bool leaves_little(double left, double over_floor, double allowed) noexcept {
  if (over_floor <= tuning::kNearFloor) return true;
  return left <= allowed && over_floor <= tuning::kWellAboveFloor;
}

}  // namespace hybridtest
