#pragma once

#include <span>
#include <vector>

#include "diagnosis/verdict/library_fits.hpp"
#include "diagnosis/verdict/policy.hpp"

namespace hybridtest {

/// A leading candidate with the further effects that it needs, where these recordings cannot tell it from another one.
struct AlikeLeader {
  const EffectType* type = nullptr;
  FitOutcome fit;  // the candidate and what was found with it
};

/// The selected effects.
struct Selection {
  FitOutcome baseline;             // the model as the user gave it
  FitOutcome by_numbers;           // the model with its numbers free, and damping
  std::vector<Candidate> library;  // every effect and law by itself, best first
  FitOutcome chosen;               // effects together; `effects` is empty if no effect is needed
  std::vector<AlikeLeader> alike;  // the chosen one included; empty if there was one leader only
  // One per chosen effect: against the others that were tried in its place.
  std::vector<double> chosen_probabilities;
  // Likewise of the gap that they explain together (Shapley, 1953): an effect's gain on held-out blocks, averaged over
  // all orders in which the effects can be added. Adds up to one.
  std::vector<double> shares;
};

/// Fits the numbers of the model together, and the library; starts from these numbers or from the best effects, and
/// adds others as long as each removes a large part of the remaining gap on held-out blocks. Then drops each effect
/// that the others can do without.
///
/// A wrong number of the model that an effect needs beside it becomes a selected effect of its own. So the answer does
/// not depend on the numbers that the user gave.
/// @param problem   its suspect segments are the gap to explain.
/// @param coarse    the same problem at a lower rate, for the searches.
/// Both problems take their noise from the best candidate (settle_noise()).
[[nodiscard]] Selection select_effects(IdentificationProblem& problem, IdentificationProblem& coarse,
                                       const VerdictPolicy& policy, const PartProgress& progress);

/// Of several effects that the model does not have, drops those that a fit left nothing of, and those that may be
/// absent by their intervals where the others predict as well without them.
void drop_gone(const IdentificationProblem& problem, FitOutcome& fit);

/// Whether the gap of a suspect segment exceeds this multiple of its floor.
[[nodiscard]] bool stands_above_floor(const IdentificationProblem& problem, const FitOutcome& baseline,
                                      double multiple);

}  // namespace hybridtest
