#pragma once

#include <vector>

#include "diagnosis/identification/problem.hpp"

namespace hybridtest {

/// A parameter of a fitted effect.
struct ParameterEstimate {
  double value = 0.0;
  double standard_error = 0.0;  // corrected for the residual's autocorrelation
  bool at_bound = false;        // of its search range
};

/// How well a fit does on one segment, in its averaged samples.
struct SegmentResult {
  bool touched = false;
  double mean_square = 0.0;              // of the residual, parameters fitted to it
  std::vector<double> held_out_squares;  // per block: sum over a block that was not fitted
  Eigen::VectorXd change;                // what the effects change of the baseline; empty when not touched

  [[nodiscard]] double held_out_mean_square(const FitSegment& segment) const;
};

/// Effects fitted together.
struct FitOutcome {
  std::vector<EffectSetting> effects;
  std::vector<std::vector<ParameterEstimate>> parameters;  // per effect
  bool with_nuisance = false;
  std::vector<double> nuisance;         // coefficients of the touched segments' columns, one behind the other
  std::vector<SegmentResult> segments;  // as in the problem
};

/// Fits `effects` together to every segment they touch, in free simulation: what is linear by least
/// squares inside (variable projection; Golub and Pereyra, 1973), the rest by a bounded
/// trust-region search outside (Ceres) from the best of several starts. Deterministic.
///
/// Held-out blocks: the fit's linearisation gives what each block's residual is when that block is left
/// out, exact where parameters are linear.
/// @param with_nuisance   leave the segments' slightly wrong model parameters free as well.
[[nodiscard]] FitOutcome fit_effects(const IdentificationProblem& problem,
                                     const std::vector<const EffectType*>& effects, bool with_nuisance);

/// The same from known values, as where a second effect is added to a first.
/// @param start   one setting per effect; its searched parameters are where the search begins.
[[nodiscard]] FitOutcome refit_effects(const IdentificationProblem& problem, const std::vector<EffectSetting>& start,
                                       bool with_nuisance);

/// The same from known values and from several starts, as where a second effect may move a first one far.
/// @param start   one setting per effect.
[[nodiscard]] FitOutcome search_effects(const IdentificationProblem& problem, const std::vector<EffectSetting>& start,
                                        bool with_nuisance);

/// No effect at all.
[[nodiscard]] FitOutcome fit_nothing(const IdentificationProblem& problem, bool with_nuisance);

}  // namespace hybridtest
