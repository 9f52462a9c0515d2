#include "diagnosis/identification/effect_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "diagnosis/identification/held_out_blocks.hpp"
#include "diagnosis/identification/linearisation.hpp"
#include "diagnosis/identification/parameter_doubt.hpp"
#include "diagnosis/identification/search.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {
namespace {

/// For segments that the effects do not change: the residual of the baseline.
SegmentResult untouched(const FitSegment& fit) {
  SegmentResult result;
  const Eigen::VectorXd residual = fit.measured - fit.baseline;
  result.mean_square = residual.squaredNorm() / static_cast<double>(residual.size());
  for (std::size_t b = 0; b + 1 < fit.block_begins.size(); ++b) {
    result.held_out_squares.push_back(
        residual.segment(fit.block_begins[b], fit.block_begins[b + 1] - fit.block_begins[b]).squaredNorm());
  }
  return result;
}

/// See SegmentResult::more_noise. Where the numbers of the model suit every prediction, they suit its noise, too. What
/// noise does by what the specimen went through, as cycles that it adds, is no noise: nothing with degradation.
/// @param numbers   coefficients of the segment's nuisances, the first of them; empty: not free.
double more_noise_of(const IdentificationProblem& problem, const FitSegment& fit, std::vector<EffectSetting> effects,
                     std::span<const double> numbers) {
  const auto has_history = [](const EffectSetting& effect) { return degrades(*effect.type); };
  if (effects.empty() || fit.numbers.directions.cols() > 0 || std::ranges::any_of(effects, has_history)) return 0.0;
  for (std::size_t i = 0; i < fit.nuisance_types.size() && !numbers.empty(); ++i) {
    const EffectType& type = *fit.nuisance_types[i];
    // What the model has is moved along a direction, and not by its parameter.
    if (place_of(problem.model, type) != nullptr) continue;
    const std::size_t position = searched_number(problem, type);
    const EffectParameter& parameter = type.parameters[position];
    effects.push_back(absent(type));
    effects.back().values[position] = std::clamp(numbers[i], parameter.low, parameter.high);
  }
  return noise_of_input(problem, fit, effects) - fit.noise_of_input;
}

std::vector<const EffectType*> types_of(const std::vector<EffectSetting>& effects) {
  std::vector<const EffectType*> types;
  std::ranges::transform(effects, std::back_inserter(types), &EffectSetting::type);
  return types;
}

enum class Look { from_start, around_start, everywhere };

/// Of effects that are known, in the search.
Eigen::VectorXd places_of(const SearchPlan& plan, const std::vector<EffectSetting>& effects) {
  Eigen::VectorXd places(static_cast<Eigen::Index>(plan.searched.size()));
  for (Eigen::Index i = 0; i < places.size(); ++i) {
    const SearchedParameter& searched = plan.searched[static_cast<std::size_t>(i)];
    places[i] = searched.place_of(effects[searched.effect].values[searched.parameter]);
  }
  return places;
}

/// Where a search of all parameters begins: at the best of those alone that a scenario has to give, where there are
/// others. The size of an effect that is not solved for lies in a narrow valley, which a few points along it meet, and
/// hardly any in a plane. Empty where nothing is gained.
Eigen::VectorXd simplest_first(const IdentificationProblem& problem, const std::vector<const EffectType*>& effects,
                               const SearchPlan& plan, bool with_nuisance) {
  if (!plan.linear.empty()) return {};
  const VariableProjection projection{
      problem, plan_search(problem, effects, std::vector<Freedom>(effects.size(), Freedom::required)), with_nuisance};
  const std::size_t count = projection.plan().searched.size();
  if (count == 0 || count == plan.searched.size()) return {};
  const Eigen::VectorXd places = search_best(projection, {}, starts_for(static_cast<Eigen::Index>(count)));
  const std::vector<EffectSetting> found = projection.settings(places, projection.solve(places).coefficients);
  return places_of(plan, found);
}

/// @param start   first point of the search; empty: none.
FitOutcome fit_free(const IdentificationProblem& problem, const std::vector<const EffectType*>& effects,
                    const std::vector<EffectSetting>& start, Look look, bool with_nuisance,
                    const std::vector<Freedom>& freedoms) {
  const VariableProjection projection{problem, plan_search(problem, effects, freedoms), with_nuisance};
  const SearchPlan& plan = projection.plan();
  Eigen::VectorXd first;
  if (!start.empty()) {
    first = places_of(plan, start);
  } else if (look == Look::everywhere && std::ranges::find(freedoms, Freedom::required) == freedoms.end()) {
    first = simplest_first(problem, effects, plan, with_nuisance);
  }
  const int starts = look == Look::everywhere ? starts_for(static_cast<Eigen::Index>(plan.searched.size())) : 0;
  const Eigen::VectorXd places =
      look == Look::around_start ? search_around(projection, first) : search_best(projection, first, starts);
  const Projected solution = projection.solve(places);
  const Linearisation linear = linearise(projection, places, solution);

  FitOutcome outcome;
  outcome.effects = projection.settings(places, solution.coefficients);
  outcome.with_nuisance = with_nuisance;
  outcome.cost_of_numbers = cost_of_numbers(problem, outcome.effects);
  for (auto i = static_cast<Eigen::Index>(plan.linear.size()); i < solution.coefficients.size(); ++i) {
    outcome.nuisance.push_back(solution.coefficients[i]);
  }
  std::ranges::transform(problem.segments, std::back_inserter(outcome.segments), untouched);
  hold_out(projection, problem, linear, places, solution, outcome);
  std::span<const double> numbers = outcome.nuisance;  // of the segments that are left
  for (std::size_t t = 0; t < projection.touched().size(); ++t) {
    const FitSegment& fit = problem.segments[projection.touched()[t]];
    SegmentResult& result = outcome.segments[projection.touched()[t]];
    result.touched = true;
    result.change = fit.measured - fit.baseline -
                    solution.residual.segment(projection.first_row(t), fit.measured.size()) / fit.weight;
    result.more_noise = more_noise_of(problem, fit, outcome.effects, numbers);
    if (with_nuisance) numbers = numbers.subspan(static_cast<std::size_t>(fit.nuisance.cols()));
  }
  estimate_parameters(projection, problem, linear, places, solution, outcome);
  return outcome;
}

/// Whether an effect that the model has may as well be of no size; then its shape means nothing.
bool may_have_no_size(const IdentificationProblem& problem, const FitOutcome& fit, std::size_t position) {
  const EffectType& type = *fit.effects[position].type;
  if (place_of(problem.model, type) == nullptr) return false;
  for (std::size_t i = 0; i < type.parameters.size(); ++i) {
    const ParameterEstimate& estimate = fit.parameters[position][i];
    if (type.parameters[i].is_linear && estimate.value <= half_width_95(estimate)) return true;
  }
  return false;
}

/// Whether a parameter that a scenario may leave out is at a limit of its range while it or another one of its effect
/// is not left out: a ratio of closed joints of one says that there are none, whatever the force that closes them.
bool has_optional_at_limit(const FitOutcome& fit) {
  for (std::size_t i = 0; i < fit.effects.size(); ++i) {
    const std::span<const EffectParameter> parameters = fit.effects[i].type->parameters;
    bool is_at_limit = false;
    bool is_left_out = true;
    for (std::size_t j = 0; j < parameters.size(); ++j) {
      if (std::isnan(parameters[j].fallback)) continue;
      is_at_limit = is_at_limit || fit.parameters[i][j].at_bound;
      is_left_out = is_left_out && fit.parameters[i][j].value == parameters[j].fallback;
    }
    if (is_at_limit && !is_left_out) return true;
  }
  return false;
}

/// Whether an effect has parameters that a scenario may leave out, and each of them may as well be what it then is.
bool may_be_simpler(const IdentificationProblem& problem, const FitOutcome& fit, std::size_t position) {
  const EffectType& type = *fit.effects[position].type;
  bool is_free = false;
  for (std::size_t j = 0; j < type.parameters.size(); ++j) {
    const ParameterEstimate& estimate = fit.parameters[position][j];
    const double without = left_out(problem, type, j);
    if (std::isnan(without) || type.parameters[j].is_linear || estimate.value == without) continue;
    if (!(std::abs(estimate.value - without) <= half_interval_95(estimate))) return false;
    is_free = true;
  }
  return is_free;
}

/// Held-out log predictive density that the one fit has over the other [nats].
double lost_without(const IdentificationProblem& problem, const FitOutcome& all, const FitOutcome& required) {
  double lost = 0.0;
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    if (!all.segments[i].touched) continue;
    const FitSegment& fit = problem.segments[i];
    const double left = required.segments[i].held_out_mean_square(fit) / all.segments[i].held_out_mean_square(fit);
    lost += 0.5 * fit.predicted_samples() * std::log(left);
  }
  return lost;
}

/// Whether a search with that freedom of each has fewer parameters than one of all.
bool has_fewer(const IdentificationProblem& problem, const std::vector<const EffectType*>& effects,
               const std::vector<Freedom>& freedoms) {
  return plan_search(problem, effects, freedoms).searched.size() < plan_search(problem, effects).searched.size();
}

/// All parameters free; those that are freed last, from where the others are the best without them, and only where they
/// take off most of what is left there. Where they do not, its form is another one, which a shape would bend to.
FitOutcome fit_all(const IdentificationProblem& problem, const std::vector<const EffectType*>& effects,
                   const std::vector<EffectSetting>& start, Look look, bool with_nuisance) {
  const std::vector<Freedom> without_last(effects.size(), Freedom::without_last);
  if (!has_fewer(problem, effects, without_last)) {
    return fit_free(problem, effects, start, look, with_nuisance, {});
  }
  FitOutcome without = fit_free(problem, effects, start, look, with_nuisance, without_last);
  FitOutcome all = fit_free(problem, effects, without.effects, Look::from_start, with_nuisance, {});
  const double left = squares_of(problem, all).fitted / squares_of(problem, without).fitted;
  return left < tuning::kMainShare ? all : without;
}

/// Only the parameters of an effect that a scenario has to give, where the others are not worth their place in the
/// score: a second stop whose stiffness may be none says nothing, and makes the first one doubtful.
FitOutcome without_needless_parameters(const IdentificationProblem& problem,
                                       const std::vector<const EffectType*>& effects, FitOutcome fit) {
  std::vector<Freedom> freedoms(effects.size(), Freedom::all);
  for (std::size_t i = 0; i < effects.size(); ++i) {
    if (may_be_simpler(problem, fit, i)) freedoms[i] = Freedom::required;
  }
  if (std::ranges::find(freedoms, Freedom::required) == freedoms.end()) return fit;
  FitOutcome simpler = fit_free(problem, effects, fit.effects, Look::from_start, fit.with_nuisance, freedoms);
  return lost_without(problem, fit, simpler) < tuning::kParameterPrior ? simpler : fit;
}

/// Parameters that a scenario may leave out are left out where the blocks cannot hold them: when they are fitted, but
/// predict a block that was left out much worse than the others alone do; where one of them goes to a limit of its
/// range but is not worth its place in the score; and where none of an effect's is. The shape of an effect that the
/// model has is the model's where nothing is left of it.
FitOutcome fit_from(const IdentificationProblem& problem, const std::vector<const EffectType*>& effects,
                    const std::vector<EffectSetting>& start, Look look, bool with_nuisance) {
  FitOutcome all = fit_all(problem, effects, start, look, with_nuisance);
  std::vector<Freedom> freedoms(effects.size(), Freedom::all);
  for (std::size_t i = 0; i < effects.size(); ++i) {
    if (may_have_no_size(problem, all, i)) freedoms[i] = Freedom::required;
  }
  if (std::ranges::find(freedoms, Freedom::required) != freedoms.end()) {
    return fit_free(problem, effects, start, look, with_nuisance, freedoms);
  }
  const Squares squares = squares_of(problem, all);
  freedoms.assign(effects.size(), Freedom::required);
  if (!has_fewer(problem, effects, freedoms)) return all;
  const bool is_held = squares.held_out < tuning::kHeldOutBeyondFitted * squares.fitted;
  const bool is_at_limit = has_optional_at_limit(all);
  if (!is_held || is_at_limit) {
    FitOutcome required = fit_free(problem, effects, start, look, with_nuisance, freedoms);
    const bool is_as_good = is_at_limit && lost_without(problem, all, required) < tuning::kParameterPrior;
    if (is_as_good || squares_of(problem, required).held_out < squares.held_out) return required;
  }
  return without_needless_parameters(problem, effects, std::move(all));
}

}  // namespace

double quantile_95(double freedom) noexcept {
  const double z = tuning::kTwoSided95;
  const double n = 1.0 / freedom;
  return z + n * ((std::pow(z, 3) + z) / 4.0 +
                  n * ((5.0 * std::pow(z, 5) + 16.0 * std::pow(z, 3) + 3.0 * z) / 96.0 +
                       n * (3.0 * std::pow(z, 7) + 19.0 * std::pow(z, 5) + 17.0 * std::pow(z, 3) - 15.0 * z) / 384.0));
}

double half_width_95(const ParameterEstimate& estimate) noexcept {
  return quantile_95(estimate.freedom) * estimate.standard_error;
}

double half_interval_95(const ParameterEstimate& estimate) noexcept {
  return quantile_95(estimate.freedom) * estimate.beside_wrong_numbers;
}

Eigen::MatrixXd covariance_for_draws(const FitOutcome& fit) {
  return std::pow(quantile_95(fit.freedom) / tuning::kTwoSided95, 2) * fit.predicting;
}

double SegmentResult::held_out_mean_square(const FitSegment& segment) const {
  return std::accumulate(held_out_squares.begin(), held_out_squares.end(), 0.0) /
         static_cast<double>(segment.measured.size());
}

double SegmentResult::left(const FitSegment& segment) const {
  const double all = held_out_mean_square(segment);
  const double noise = segment.noise_of_input + more_noise;
  // With less left than that noise would be, there is less of it.
  return more_noise > 0.0 && all < noise ? all * segment.noise_of_input / noise : all - more_noise;
}

Eigen::VectorXd left_by(const SegmentResult& result, const FitSegment& segment) {
  Eigen::VectorXd left = segment.measured - segment.baseline;
  if (result.change.size() > 0) left -= result.change;
  return left;
}

Squares squares_of(const IdentificationProblem& problem, const FitOutcome& outcome) {
  Squares sum;
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    if (!outcome.segments[i].touched) continue;
    const FitSegment& fit = problem.segments[i];
    const double weight = fit.weight * fit.weight * static_cast<double>(fit.measured.size());
    sum.fitted += weight * outcome.segments[i].mean_square;
    sum.held_out += weight * outcome.segments[i].held_out_mean_square(fit);
  }
  return sum;
}

FitOutcome fit_effects(const IdentificationProblem& problem, const std::vector<const EffectType*>& effects,
                       bool with_nuisance) {
  return fit_from(problem, effects, {}, Look::everywhere, with_nuisance);
}

FitOutcome refit_effects(const IdentificationProblem& problem, const std::vector<EffectSetting>& start,
                         bool with_nuisance) {
  return fit_from(problem, types_of(start), start, Look::from_start, with_nuisance);
}

FitOutcome search_effects(const IdentificationProblem& problem, const std::vector<EffectSetting>& start,
                          bool with_nuisance) {
  return fit_from(problem, types_of(start), start, Look::everywhere, with_nuisance);
}

FitOutcome search_around(const IdentificationProblem& problem, const std::vector<EffectSetting>& found,
                         bool with_nuisance) {
  return fit_from(problem, types_of(found), found, Look::around_start, with_nuisance);
}

FitOutcome fit_nothing(const IdentificationProblem& problem, bool with_nuisance) {
  return fit_from(problem, {}, {}, Look::from_start, with_nuisance);
}

}  // namespace hybridtest
