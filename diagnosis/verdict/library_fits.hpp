#pragma once

#include <functional>
#include <span>
#include <vector>

#include "diagnosis/identification/effect_fit.hpp"
#include "diagnosis/progress.hpp"

namespace hybridtest {

/// Held-out log predictive density of a fit, up to a constant that all fits share [nats].
///
/// Gaussian residuals with the variance of the held-out blocks. Neighbouring samples of a structured residual contain
/// the same information: the number of independent ones is that of the segment's noise (FitSegment::independent), the
/// same for all candidates.
[[nodiscard]] double held_out_score(const IdentificationProblem& problem, const FitOutcome& outcome);

/// Energy of the residual over all suspect segments, each relative to the variance of its output, held out.
struct GapEnergy {
  double total = 0.0;
  double floor = 0.0;

  /// The remaining gap above the floor.
  [[nodiscard]] double excess() const noexcept { return total > floor ? total - floor : 0.0; }
};
[[nodiscard]] GapEnergy gap_energy(const IdentificationProblem& problem, const FitOutcome& outcome);
/// Of one segment.
[[nodiscard]] GapEnergy gap_energy(const FitSegment& segment, const SegmentResult& result);

/// An effect of the library, fitted.
struct Candidate {
  const EffectType* type = nullptr;
  FitOutcome fit;      // alone or, if needed, together with slightly wrong parameters of the model
  double score = 0.0;  // on held-out blocks, minus the penalty for free nuisance parameters
};

/// Receives the number of finished fits and of all fits; called from any thread, one call at a time.
using FitProgress = std::function<void(std::size_t done, std::size_t all)>;

/// Runs `work(i)` for every i below `count` on `threads` threads; the result does not depend on the threads.
void for_each_in_parallel(std::size_t count, std::size_t threads, const std::function<void(std::size_t)>& work,
                          const FitProgress& progress);

/// The effects that a diagnosis can judge on these segments.
[[nodiscard]] std::vector<const EffectType*> judged_effects(const IdentificationProblem& problem);

/// Every judged effect fitted, best score first; effects that cannot be fitted are omitted, and those that the
/// recordings refute by themselves (refutation()).
/// @param coarse   the same problem at a lower rate, where every effect is searched over its whole range; those
///                 that come near the best are fitted again to `problem` from there.
[[nodiscard]] std::vector<Candidate> fit_library(const IdentificationProblem& problem,
                                                 const IdentificationProblem& coarse, std::size_t threads,
                                                 const PartProgress& progress);

/// Every judged effect but those in `base` fitted together with them, best score first. All are screened
/// on `coarse` with `base` as it is; the most promising ones, and the numbers of the model that may be wrong, are
/// searched there with everything free, as a second effect may move the first one far; those that come near the best
/// are fitted to `problem` from there.
[[nodiscard]] std::vector<Candidate> fit_beside(const IdentificationProblem& problem,
                                                const IdentificationProblem& coarse,
                                                const std::vector<EffectSetting>& base, std::size_t threads,
                                                const PartProgress& progress);

}  // namespace hybridtest
