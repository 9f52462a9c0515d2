#pragma once

#include "diagnosis/tuning.hpp"

namespace hybridtest {

/// What a user may decide of a verdict. The rest follows from the recordings.
struct VerdictPolicy {
  /// Share of the repeatable gap [variance] up to which its cause is named though more than the floor is left, 0 to 1.
  double named_leaves = 0.0;
  /// Share up to which it is named in part; above, the gap is unknown. 0 to 1, at least named_leaves.
  double partial_leaves = tuning::kPartialLeaves;
  /// Probability of a set of effects, above 0.5 and below 1.
  double credible = tuning::kCredible;
  /// Numbers of the model that are off and change the output by at most this share [rms over rms] are corrected, but
  /// are no cause: two standard deviations. A delay or a bandwidth: half of it. 0: each is a cause.
  double numbers_within = 2.0 * tuning::kNumbersWithin;

  /// @param left         share of the gap that is left [variance].
  /// @param over_floor   the residual over the floor and what no model is expected to reproduce [rms over rms].
  [[nodiscard]] constexpr bool names(double left, double over_floor) const noexcept {
    return over_floor <= tuning::kNearFloor || left <= named_leaves;
  }
};

}  // namespace hybridtest
