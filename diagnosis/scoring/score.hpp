#pragma once

#include "diagnosis/identification/effect_fit.hpp"

namespace hybridtest {

/// Held-out log predictive density of a fit, up to a constant that all fits share [nats].
///
/// Gaussian residuals whose variance is that of the held-out blocks, over as many independent samples
/// as the tuning grants a second of recording: neighbouring samples of a structured
/// residual say the same thing.
[[nodiscard]] double held_out_score(const IdentificationProblem& problem, const FitOutcome& outcome);

/// Energy of the residual over all suspect segments, each relative to the variance of its output, held out.
struct GapEnergy {
  double total = 0.0;
  double floor = 0.0;

  /// What is left above the floor.
  [[nodiscard]] double excess() const noexcept { return total > floor ? total - floor : 0.0; }
};
[[nodiscard]] GapEnergy gap_energy(const IdentificationProblem& problem, const FitOutcome& outcome);
/// Of one segment.
[[nodiscard]] GapEnergy gap_energy(const FitSegment& segment, const SegmentResult& result);

}  // namespace hybridtest
