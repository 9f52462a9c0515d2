#pragma once

#include "diagnosis/identification/effect_fit.hpp"
#include "diagnosis/identification/problem.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {

/// By how much the held-out log density is larger with one fit than with another, and what is not known of that, from
/// the differences between blocks [nats].
struct Loss {
  double nats = 0.0;
  double standard_error = 0.0;             // to first order of the logarithm of what either leaves
  double standard_error_of_squares = 0.0;  // of what the rival leaves more, over what the chosen fit leaves

  /// Whether it is more than nothing for certain (95 %).
  [[nodiscard]] bool is_certain() const noexcept { return nats > tuning::kTwoSided95 * standard_error; }
};

/// @return what is lost with the rival instead of the chosen fit; negative where the rival predicts better.
[[nodiscard]] Loss loss_by(const IdentificationProblem& problem, const FitOutcome& rival, const FitOutcome& chosen);

}  // namespace hybridtest
