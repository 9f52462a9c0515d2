#pragma once

#include "diagnosis/tuning.hpp"

namespace hybridtest {

/// What a user may decide of a verdict. The rest follows from the recordings.
struct VerdictPolicy {
  /// Share of the repeatable gap [variance] up to which its cause is named, 0 to 1.
  double named_leaves = tuning::kNamedLeaves;
  /// Likewise up to which it is named in part; above, the gap is unknown. 0 to 1, at least named_leaves.
  double partial_leaves = tuning::kPartialLeaves;
  /// Probability of a set of effects, above 0.5 and below 1.
  double credible = tuning::kCredible;
  /// Numbers of the model that are off and change the output by at most this share [rms over rms] are corrected, but
  /// are no cause. 0: each is a cause.
  double numbers_within = tuning::kNumbersWithin;
};

}  // namespace hybridtest
