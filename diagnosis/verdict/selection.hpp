#pragma once

#include <vector>

#include "diagnosis/scoring/library_fits.hpp"

namespace hybridtest {

/// The effects that the evidence asks for.
struct Selection {
  FitOutcome baseline;                // the model as the user gave it
  std::vector<Candidate> library;     // every effect by itself, best first
  FitOutcome chosen;                  // effects together; none in `effects` when the gap asks for none
  std::vector<double> probabilities;  // one per entry of `library`: that it is the first cause
};

/// Fits the library, takes the best effect and adds others for as long as each removes a good part of
/// what is left, on held-out blocks.
/// @param coarse   the same problem at a lower rate, for the searches.
[[nodiscard]] Selection select_effects(const IdentificationProblem& problem, const IdentificationProblem& coarse,
                                       std::size_t threads, const FitProgress& progress);

}  // namespace hybridtest
