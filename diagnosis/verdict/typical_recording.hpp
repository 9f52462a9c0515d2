#pragma once

#include "diagnosis/verdict/library_fits.hpp"

namespace hybridtest {

/// What a further effect changes in a typical (median) recording, so that a single unusual recording does not
/// decide.
struct Typical {
  double leaves = 1.0;    // share of the gap that remained before it
  double explains = 0.0;  // of the whole gap where it acts
};

/// @param by_numbers   the fit of the numbers of the model, from which the whole gap is counted.
/// @param without      the fit without the further effect.
[[nodiscard]] Typical typical(const IdentificationProblem& problem, const FitOutcome& by_numbers,
                              const FitOutcome& without, const Candidate& further);

}  // namespace hybridtest
