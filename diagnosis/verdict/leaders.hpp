#pragma once

#include "diagnosis/verdict/growth.hpp"

namespace hybridtest {

/// The numbers of the model in the library, where none of them shows by itself that it is off.
void add_numbers(Selection& selection);

/// The numbers of the model that are needed where nothing else is looked for; nothing if they do not explain anything.
[[nodiscard]] std::optional<FitOutcome> needed_numbers(const IdentificationProblem& problem,
                                                       const Selection& selection);

/// The best of the leading candidates; of a sensor only if none of a stage changes the prediction alike. The
/// probabilities become those of what was found with them.
[[nodiscard]] Growth best_start(const IdentificationProblem& problem, const IdentificationProblem& coarse,
                                Selection& selection, const PartProgress& progress);

}  // namespace hybridtest
