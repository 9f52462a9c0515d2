#pragma once

#include <optional>

#include "diagnosis/scoring/library_fits.hpp"

namespace hybridtest {

/// Draws its course from a seed: a fit cannot follow it, only its traces can be counted.
[[nodiscard]] bool is_random(const EffectType& effect);

/// `jitter` or `loss`, where the targets that a site received show it: nearly every one equals one that was sent,
/// so many samples before, and that lag goes up and down. With loss, what arrives fresh is always equally late;
/// with jitter it is not. The residual that is scored is that of the lags found, sample by sample.
/// @return nothing where the network was not recorded, or its lags do not fluctuate.
[[nodiscard]] std::optional<Candidate> fit_random_network(const IdentificationProblem& problem,
                                                          const FitOutcome& baseline);

}  // namespace hybridtest
