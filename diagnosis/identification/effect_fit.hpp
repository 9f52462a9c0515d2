#pragma once

#include <limits>
#include <vector>

#include "diagnosis/identification/problem.hpp"

namespace hybridtest {

/// A parameter of a fitted effect.
struct ParameterEstimate {
  double value = 0.0;
  double standard_error = 0.0;  // from the differences between blocks, and from what repeats of the residual
  bool at_bound = false;        // of its search range
  bool at_least = false;        // at the upper one, where it does not show any more: as large or larger
  double freedom = std::numeric_limits<double>::infinity();  // degrees of freedom of the standard error: blocks - 1
  // The standard error when every number of the model may be slightly wrong beside; what an interval is made of.
  double beside_wrong_numbers = 0.0;
};

/// Student's quantile of 95 %, two-sided, expanded in the inverse of the degrees of freedom (Abramowitz and Stegun,
/// 1964, 26.7.5; within 0.3 % from 4 on).
[[nodiscard]] double quantile_95(double freedom) noexcept;

/// Half of the 95 % interval beside a model whose numbers are right.
[[nodiscard]] double half_width_95(const ParameterEstimate& estimate) noexcept;

/// Half of the 95 % interval that is reported: every number of the model may be slightly wrong beside.
[[nodiscard]] double half_interval_95(const ParameterEstimate& estimate) noexcept;

/// Residuals of a fit on one segment, in its averaged samples.
struct SegmentResult {
  bool touched = false;
  double mean_square = 0.0;              // of the residual, parameters fitted to it
  std::vector<double> held_out_squares;  // per block: sum over a block that was not fitted
  Eigen::VectorXd change;                // change of the baseline by the effects; empty if they do not act here
  double more_noise = 0.0;               // that they make of the input's noise than the baseline does [mean square]

  [[nodiscard]] double held_out_mean_square(const FitSegment& segment) const;
  /// The same less what the effects make more of the input's noise: what they leave by themselves.
  [[nodiscard]] double left(const FitSegment& segment) const;
};

/// What it leaves of the segment: measured less predicted, averaged.
[[nodiscard]] Eigen::VectorXd left_by(const SegmentResult& result, const FitSegment& segment);

/// Effects fitted together.
struct FitOutcome {
  std::vector<EffectSetting> effects;
  std::vector<std::vector<ParameterEstimate>> parameters;  // per effect
  std::vector<Eigen::MatrixXd> covariances;                // per effect, of its parameters; the root of a diagonal is
                                                           // ParameterEstimate::beside_wrong_numbers
  // Of all parameters together, effect by effect, for what they predict: beside the numbers of the model as they are.
  // A wrong gain of a load cell makes a stiffness doubtful, but not the force that the two predict together.
  Eigen::MatrixXd predicting;
  double freedom = std::numeric_limits<double>::infinity();  // as ParameterEstimate::freedom
  bool with_nuisance = false;
  std::vector<double> nuisance;         // coefficients of the touched segments' columns, one behind the other
  double cost_of_numbers = 0.0;         // of the free ones, beside these effects [nats]
  std::vector<SegmentResult> segments;  // as in the problem
};

/// What a fit leaves of the segments that its effects act on: sums of the weighted squares, of blocks that were fitted
/// and of the same when each was left out.
struct Squares {
  double fitted = 0.0;
  double held_out = 0.0;
};
[[nodiscard]] Squares squares_of(const IdentificationProblem& problem, const FitOutcome& outcome);

/// FitOutcome::predicting, widened for normal draws: the normal quantile times a deviation is half of a 95 % interval.
[[nodiscard]] Eigen::MatrixXd covariance_for_draws(const FitOutcome& fit);

/// Fits `effects` together to every segment they change, in free simulation. Linear parameters are solved by
/// least squares (variable projection; Golub and Pereyra, 1973), the others by a bounded
/// trust-region search (Ceres) from the best of several starts, where the size is searched one of them the best of the
/// parameters alone that a scenario has to give. Deterministic.
///
/// What each block leaves when it is not fitted: see hold_out().
/// @param with_nuisance   leave the segments' slightly wrong model parameters free as well.
[[nodiscard]] FitOutcome fit_effects(const IdentificationProblem& problem,
                                     const std::vector<const EffectType*>& effects, bool with_nuisance);

/// The same from known values, for example when a second effect is added to a first.
/// @param start   one setting per effect; the search begins at its parameters.
[[nodiscard]] FitOutcome refit_effects(const IdentificationProblem& problem, const std::vector<EffectSetting>& start,
                                       bool with_nuisance);

/// The same from known values and from several starts, in case a second effect changes the first one much.
/// @param start   one setting per effect.
[[nodiscard]] FitOutcome search_effects(const IdentificationProblem& problem, const std::vector<EffectSetting>& start,
                                        bool with_nuisance);

/// The same from points around known values, in case that search ended in a side valley.
/// @param found   one setting per effect.
[[nodiscard]] FitOutcome search_around(const IdentificationProblem& problem, const std::vector<EffectSetting>& found,
                                       bool with_nuisance);

/// No effect at all.
[[nodiscard]] FitOutcome fit_nothing(const IdentificationProblem& problem, bool with_nuisance);

}  // namespace hybridtest
