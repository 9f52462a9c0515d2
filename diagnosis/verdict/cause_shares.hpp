#pragma once

#include <vector>

#include "diagnosis/verdict/library_fits.hpp"

namespace hybridtest {

/// What each of several effects contributes to the gap that they explain together (Shapley, 1953): its
/// gain on held-out blocks, averaged over all orders in which they can be added. Adds up to one.
[[nodiscard]] std::vector<double> cause_shares(const IdentificationProblem& problem,
                                               const std::vector<EffectSetting>& chosen, const PartProgress& progress);

}  // namespace hybridtest
