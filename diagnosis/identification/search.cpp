#include "diagnosis/identification/search.hpp"

#include <ceres/ceres.h>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/config_error.hpp"
#include "diagnosis/identification/law_candidates.hpp"
#include "diagnosis/tuning.hpp"
#include "plant/effects/recorded_input.hpp"

namespace hybridtest {

namespace {

bool touches_several(const IdentificationProblem& problem, const EffectType& effect) {
  bool displacement = false;
  bool force = false;
  for (const FitSegment& fit : problem.segments) {
    if (!fit.segment.touched_by(effect)) continue;
    (fit.segment.to == Channel::measured_force ? force : displacement) = true;
  }
  return force && effect.interface == EffectInterface::displacement_sensor;
}

/// Damping of a specimen's law at zero displacement, which an effect may remove.
double damping_of_law(const IdentificationProblem& problem) {
  if (!problem.model.make_law) return 0.0;
  const double velocity_m_per_s = problem.scales.of(ParameterScale::velocity_m_per_s);
  return problem.model.make_law()->trial(0.0, velocity_m_per_s) / velocity_m_per_s;
}

/// Lower limit of a linear parameter: zero if it is searched above zero only; for an amount, the value at which the
/// real site has none of it, the model's own part included.
double least_of(const IdentificationProblem& problem, const EffectType& effect, std::size_t index,
                const SearchRange& range) {
  const EffectParameter& parameter = effect.parameters[index];
  if (range.low >= 0.0) return std::max(0.0, parameter.low);
  if (!range.restriction.is_amount) return parameter.low;
  double has = range.scale == ParameterScale::damping_n_s_per_m ? damping_of_law(problem) : 0.0;
  const bool is_whole = place_of(problem.model, effect) != nullptr;  // it takes the place of what the model has of it
  for (const EffectSetting& known : problem.model.effects) {
    if (known.type == &effect && !is_whole) has += known.values[index];
  }
  return std::max(parameter.low, -std::max(0.0, has));
}

SearchedParameter searched(const IdentificationProblem& problem, const EffectType& effect, std::size_t position,
                           std::size_t index, const SearchRange& range) {
  const EffectParameter& parameter = effect.parameters[index];
  const double scale = problem.scales.of(range.scale);
  SearchedParameter result{.effect = position, .parameter = index};
  result.low = std::clamp(range.low * scale, parameter.low, parameter.high);
  result.high = std::clamp(range.high * scale, parameter.low, parameter.high);
  const DelaySetting& setting = problem.model.compensator_delay;
  switch (range.restriction.limit) {
    case SearchLimit::none:
    case SearchLimit::own_bandwidth: break;
    case SearchLimit::removable_delay: result.low = std::max(result.low, -problem.model.removable_delay_s); break;
    case SearchLimit::within_motion:
      if (problem.scales.velocity_m_per_s <= 0.0) break;
      result.low =
          std::clamp(tuning::kRelaxationOfSwing * problem.scales.displacement_m / problem.scales.velocity_m_per_s,
                     result.low, result.high / tuning::kLogarithmicFactor);
      break;
    case SearchLimit::secant_stiffness:
      if (!problem.law_is_spring) break;
      result.high = std::max(result.high, range.high * problem.scales.of(ParameterScale::stiffness_n_per_m) /
                                              problem.model.make_law()->initial_stiffness_n_per_m());
      break;
    case SearchLimit::compensator_setting:
      if (setting.most_s <= 0.0) break;
      result.low = std::max(result.low, -setting.set_s);
      result.high = std::min(result.high, setting.most_s - setting.set_s);
      break;
  }
  result.is_instant = range.is_instant();
  result.is_time_from_none = range.scale == ParameterScale::time_s && result.low == 0.0;
  result.logarithmic = result.low > 0.0 && result.high > tuning::kLogarithmicFactor * result.low;
  return result;
}

}  // namespace

bool is_fixed(const IdentificationProblem& problem, const EffectType& effect, const EffectParameter& parameter) {
  const std::optional<SearchRange> range = range_of(effect, parameter);
  if (!range) return true;
  if (range->restriction.limit == SearchLimit::own_bandwidth && !problem.model.has_bandwidth) return true;
  switch (range->restriction.beside) {
    case LawUse::any: return false;
    case LawUse::spring_or_none: return problem.law_has_strength;
    case LawUse::with_strength: return !problem.law_has_strength;
    case LawUse::at_strength: return problem.law_is_spring;
  }
  return false;
}

namespace {

/// An effect is absent at the input's reference. Where none is recorded, a rig takes what it was on average.
std::optional<double> number_of_input(const IdentificationProblem& problem, const EffectType& effect,
                                      std::string_view parameter) {
  const auto range = std::ranges::find(problem.inputs, effect.input, &InputRange::name);
  if (range == problem.inputs.end()) return {};
  if (parameter == kReferenceInput.name) return range->reference;
  if (parameter == kNominalInput.name) return range->mean;
  return {};
}

/// The scale of a search range, per unit of the input where the range is.
double scale_of(const IdentificationProblem& problem, const EffectType& effect, const SearchRange& range) {
  const double scale = problem.scales.of(range.scale);
  const auto input = std::ranges::find(problem.inputs, effect.input, &InputRange::name);
  const bool is_per_input = range.restriction.per_input && input != problem.inputs.end() && input->span > 0.0;
  return is_per_input ? scale / input->span : scale;
}

}  // namespace

double left_out(const IdentificationProblem& problem, const EffectType& effect, std::size_t parameter) {
  if (const auto number = number_of_input(problem, effect, effect.parameters[parameter].name)) return *number;
  const EffectSetting* const own = place_of(problem.model, effect);
  return own == nullptr ? effect.parameters[parameter].fallback : own->values[parameter];
}

EffectSetting absent(const EffectType& effect) {
  EffectSetting setting{.type = &effect, .values = {}};
  for (const EffectParameter& parameter : effect.parameters) {
    setting.values.push_back(std::isnan(parameter.fallback) ? parameter.neutral : parameter.fallback);
  }
  return setting;
}

std::size_t searched_number(const IdentificationProblem& problem, const EffectType& number) {
  const auto searched = std::ranges::find_if(
      number.parameters, [&](const EffectParameter& parameter) { return !is_fixed(problem, number, parameter); });
  return static_cast<std::size_t>(searched - number.parameters.begin());
}

double SearchedParameter::at(double place) const noexcept {
  return logarithmic ? low * std::pow(high / low, place) : low + (high - low) * place;
}

double SearchedParameter::place_of(double value) const noexcept {
  const double inside = std::clamp(value, low, high);
  return logarithmic ? std::log(inside / low) / std::log(high / low) : (inside - low) / (high - low);
}

bool SearchedParameter::is_low_end(double place) const noexcept {
  return place < (is_time_from_none ? tuning::kResolution * tuning::kResolution : tuning::kResolution);
}

bool SearchedParameter::is_high_end(double place) const noexcept { return place > 1.0 - tuning::kResolution; }

double SearchedParameter::slope_at(double place) const noexcept {
  const double before = std::max(0.0, place - tuning::kResolution);
  const double after = std::min(1.0, place + tuning::kResolution);
  return (at(after) - at(before)) / (after - before);
}

SearchPlan plan_search(const IdentificationProblem& problem, const std::vector<const EffectType*>& effects,
                       const std::vector<Freedom>& freedoms) {
  SearchPlan plan;
  plan.linear_ones_remove_all = true;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const EffectType& effect = *effects[i];
    const bool all_searched = touches_several(problem, effect);
    EffectSetting neutral{.type = &effect, .values = {}};
    bool removed_by_linear = false;
    const bool is_of_model = place_of(problem.model, effect) != nullptr;
    const Freedom freedom = freedoms.empty() ? Freedom::all : freedoms[i];
    for (std::size_t j = 0; j < effect.parameters.size(); ++j) {
      const EffectParameter& parameter = effect.parameters[j];
      const bool is_left_out =
          freedom == Freedom::required && !std::isnan(left_out(problem, effect, j)) && !parameter.is_linear;
      const std::optional<SearchRange> range = range_of(effect, parameter);
      const bool is_too_early = freedom == Freedom::without_last && range && range->restriction.is_freed_last;
      if (is_left_out || is_too_early || is_fixed(problem, effect, parameter)) {
        neutral.values.push_back(left_out(problem, effect, j));
        continue;
      }
      if (parameter.is_linear && !all_searched) {
        neutral.values.push_back(parameter.neutral);
        const double unit = 0.5 * std::max(range->high, -range->low) * scale_of(problem, effect, *range);
        const double low = least_of(problem, effect, j, *range);
        plan.linear.push_back({i, j, unit, low - parameter.neutral, parameter.high - parameter.neutral, is_of_model});
        // Without its stiffness a law has no force, nor has a model without what it has: neither is the baseline.
        removed_by_linear = effect.replacement == nullptr && !is_of_model;
      } else {
        plan.searched.push_back(searched(problem, effect, i, j, *range));
        neutral.values.push_back(plan.searched.back().at(0.5));
      }
    }
    plan.linear_ones_remove_all = plan.linear_ones_remove_all && removed_by_linear;
    plan.neutral.push_back(std::move(neutral));
  }
  return plan;
}

namespace {

using Bounds = VariableProjection::Bounds;

Eigen::VectorXd least_squares(const Eigen::MatrixXd& normal, const Eigen::VectorXd& right,
                              const std::vector<bool>& held, const Eigen::VectorXd& fixed) {
  Eigen::MatrixXd matrix = normal;
  Eigen::VectorXd vector = right;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    if (held[static_cast<std::size_t>(i)]) {
      matrix.row(i).setZero();
      matrix(i, i) = 1.0;
      vector[i] = fixed[i];
    } else {
      matrix(i, i) = matrix(i, i) * (1.0 + tuning::kProjectionRidge) + std::numeric_limits<double>::min();
    }
  }
  return matrix.partialPivLu().solve(vector);
}

/// Least squares within bounds: parameters that leave their bounds are held there, one after the other.
Eigen::VectorXd bounded_least_squares(const Eigen::MatrixXd& columns, const Eigen::VectorXd& right,
                                      const std::vector<Bounds>& bounds, std::vector<bool>& held) {
  Eigen::VectorXd scale = columns.colwise().norm().transpose();
  for (double& value : scale) value = value > 0.0 ? value : 1.0;
  const Eigen::MatrixXd scaled = columns * scale.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd normal = scaled.transpose() * scaled;
  const Eigen::VectorXd projected = scaled.transpose() * right;
  Eigen::VectorXd fixed = Eigen::VectorXd::Zero(scale.size());
  Eigen::VectorXd solution(scale.size());
  held.assign(bounds.size(), false);
  for (std::size_t pass = 0; pass <= bounds.size(); ++pass) {
    solution = least_squares(normal, projected, held, fixed);
    bool inside = true;
    for (std::size_t i = 0; i < bounds.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      const double value = solution[row] / scale[row];
      if (held[i] || (value >= bounds[i].low && value <= bounds[i].high)) continue;
      held[i] = true;
      fixed[row] = std::clamp(value, bounds[i].low, bounds[i].high) * scale[row];
      inside = false;
    }
    if (inside) break;
  }
  return solution.cwiseQuotient(scale);
}

}  // namespace

VariableProjection::VariableProjection(const IdentificationProblem& problem, SearchPlan plan, bool with_nuisance)
    : problem_{problem},
      plan_{std::move(plan)},
      first_rows_{0},
      // The shape at a point, and those at its neighbours for the slopes.
      laws_{problem.segments.size() * (plan_.searched.size() + 2)} {
  Eigen::Index nuisances = 0;
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    const FitSegment& fit = problem.segments[i];
    const bool touches = plan_.neutral.empty() || std::ranges::any_of(plan_.neutral, [&](const EffectSetting& effect) {
                           // What is wrong at the reference of an input is not what follows the input.
                           return fit.segment.touched_by(*effect.type) || fit.segment.is_reference_of(*effect.type);
                         });
    if (!touches) continue;
    touched_.push_back(i);
    first_rows_.push_back(first_rows_.back() + fit.measured.size());
    nuisances += fit.nuisance.cols();
  }
  measured_.resize(rows());
  baseline_.resize(rows());
  nuisance_ = Eigen::MatrixXd::Zero(rows(), with_nuisance ? nuisances : 0);
  Eigen::Index column = 0;
  for (std::size_t i = 0; i < touched_.size(); ++i) {
    const FitSegment& fit = problem.segments[touched_[i]];
    const Eigen::Index first = first_rows_[i];
    measured_.segment(first, fit.measured.size()) = fit.weight * fit.measured;
    baseline_.segment(first, fit.measured.size()) = fit.weight * fit.baseline;
    if (!with_nuisance) continue;
    nuisance_.block(first, column, fit.measured.size(), fit.nuisance.cols()) = fit.weight * fit.nuisance;
    column += fit.nuisance.cols();
  }
}

std::vector<EffectSetting> VariableProjection::searched_at(const Eigen::VectorXd& places) const {
  std::vector<EffectSetting> effects = plan_.neutral;
  for (std::size_t i = 0; i < plan_.searched.size(); ++i) {
    const SearchedParameter& searched = plan_.searched[i];
    effects[searched.effect].values[searched.parameter] = searched.at(places[static_cast<Eigen::Index>(i)]);
  }
  return effects;
}

Eigen::VectorXd VariableProjection::stacked(const std::vector<EffectSetting>& effects) const {
  Eigen::VectorXd values(rows());
  for (std::size_t i = 0; i < touched_.size(); ++i) {
    const FitSegment& fit = problem_.segments[touched_[i]];
    values.segment(first_rows_[i], fit.measured.size()) =
        fit.weight * predict(problem_, fit, effects, touched_[i], laws_);
  }
  return values;
}

Projected VariableProjection::solve(const Eigen::VectorXd& places) const {
  const std::vector<EffectSetting> absent = searched_at(places);
  const Eigen::VectorXd base = plan_.linear_ones_remove_all ? baseline_ : stacked(absent);
  Projected result;
  const auto linear = static_cast<Eigen::Index>(plan_.linear.size());
  result.columns.resize(rows(), linear + nuisance_.cols());
  std::vector<Bounds> bounds;
  problem_.workers.for_each(plan_.linear.size(), [&](std::size_t i) {
    const LinearParameter& parameter = plan_.linear[i];
    std::vector<EffectSetting> present = absent;
    present[parameter.effect].values[parameter.parameter] += parameter.unit;
    result.columns.col(static_cast<Eigen::Index>(i)) = stacked(present) - base;
  });
  for (const LinearParameter& parameter : plan_.linear) {
    bounds.push_back({parameter.low / parameter.unit, parameter.high / parameter.unit});
  }
  result.columns.rightCols(nuisance_.cols()) = nuisance_;
  bounds.resize(static_cast<std::size_t>(result.columns.cols()));
  // A formula may have no value there.
  if (!base.allFinite() || !result.columns.allFinite()) throw ConfigError{"the force is no number"};
  const Eigen::VectorXd right = measured_ - base;
  result.coefficients = bounded_least_squares(result.columns, right, bounds, result.held);
  result.residual = right - result.columns * result.coefficients;
  // One effect is linear in its linear parameters; several effects together may not be.
  return linear > 0 && plan_.neutral.size() > 1 ? relinearised(places, std::move(result), bounds) : result;
}

Projected VariableProjection::relinearised(const Eigen::VectorXd& places, Projected solution,
                                           const std::vector<Bounds>& bounds) const {
  Eigen::VectorXd here = predicted(places, solution.coefficients);
  const Eigen::VectorXd off = measured_ - here - solution.residual;
  if (off.norm() <= tuning::kResolution * solution.residual.norm()) return solution;
  solution.residual = measured_ - here;
  Projected best = solution;
  for (int pass = 0; pass < tuning::kRelinearisations; ++pass) {
    problem_.workers.for_each(plan_.linear.size(), [&](std::size_t parameter) {
      const auto i = static_cast<Eigen::Index>(parameter);
      solution.columns.col(i) = slope(places, solution.coefficients, places.size() + i, here);
    });
    solution.coefficients = bounded_least_squares(
        solution.columns, solution.residual + solution.columns * solution.coefficients, bounds, solution.held);
    here = predicted(places, solution.coefficients);
    solution.residual = measured_ - here;
    const double before = best.residual.squaredNorm();
    const double after = solution.residual.squaredNorm();
    if (after < before) best = solution;
    if (after > (1.0 - tuning::kResolution) * before) break;
  }
  return best;
}

Eigen::VectorXd VariableProjection::predicted(const Eigen::VectorXd& places,
                                              const Eigen::VectorXd& coefficients) const {
  return stacked(settings(places, coefficients)) + nuisance_ * coefficients.tail(nuisance_.cols());
}

Eigen::VectorXd VariableProjection::slope(const Eigen::VectorXd& places, const Eigen::VectorXd& coefficients,
                                          Eigen::Index parameter, const Eigen::VectorXd& here) const {
  Eigen::VectorXd moved_places = places;
  Eigen::VectorXd moved_coefficients = coefficients;
  if (parameter < places.size()) {
    // In the middle as if it were above: a stop at zero is one on the positive side.
    const double step = places[parameter] <= 0.5 ? tuning::kResolution : -tuning::kResolution;
    moved_places[parameter] += step;
    return (predicted(moved_places, moved_coefficients) - here) / step;
  }
  // One that is absent may be at its lower limit.
  const Eigen::Index linear = parameter - places.size();
  const double step = coefficients[linear] > 0.0 ? -tuning::kCoefficientStep : tuning::kCoefficientStep;
  moved_coefficients[linear] += step;
  return (predicted(moved_places, moved_coefficients) - here) / step;
}

std::vector<EffectSetting> VariableProjection::settings(const Eigen::VectorXd& places,
                                                        const Eigen::VectorXd& coefficients) const {
  std::vector<EffectSetting> effects = searched_at(places);
  for (std::size_t i = 0; i < plan_.linear.size(); ++i) {
    const LinearParameter& linear = plan_.linear[i];
    const EffectParameter& parameter = effects[linear.effect].type->parameters[linear.parameter];
    double& value = effects[linear.effect].values[linear.parameter];
    value += linear.unit * coefficients[static_cast<Eigen::Index>(i)];
    value = std::clamp(value, parameter.low, parameter.high);
  }
  return effects;
}

namespace {

class ProjectedResidual final : public ceres::CostFunction {
 public:
  ProjectedResidual(const VariableProjection& projection, Eigen::Index searched) : projection_{projection} {
    set_num_residuals(static_cast<int>(projection.rows()));
    mutable_parameter_block_sizes()->push_back(static_cast<std::int32_t>(searched));
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override try {
    const Eigen::Map<const Eigen::VectorXd> places{parameters[0], parameter_block_sizes()[0]};
    move_to(places);
    if (!residual_.allFinite()) return false;
    Eigen::Map<Eigen::VectorXd>{residuals, residual_.size()} = residual_;
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    if (slopes_.cols() == 0) find_slopes();
    std::copy_n(slopes_.data(), slopes_.size(), jacobians[0]);
    return slopes_.allFinite();
  } catch (const ConfigError&) {
    return false;
  }

 private:
  using Slopes = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;  // as the solver has them

  void move_to(const Eigen::VectorXd& places) const {
    if (places_.size() == places.size() && places_ == places) return;
    places_.resize(0);
    residual_ = projection_.solve(places).residual;
    slopes_.resize(0, 0);
    places_ = places;
  }
  void find_slopes() const {
    Slopes slopes(residual_.size(), places_.size());
    projection_.workers().for_each(static_cast<std::size_t>(places_.size()), [&](std::size_t searched) {
      const auto i = static_cast<Eigen::Index>(searched);
      Eigen::VectorXd moved = places_;
      const double step = places_[i] < 0.5 ? tuning::kResolution : -tuning::kResolution;
      moved[i] += step;
      slopes.col(i) = (projection_.solve(moved).residual - residual_) / step;
    });
    slopes_ = std::move(slopes);
  }

  const VariableProjection& projection_;
  // Of the last point: the solver asks for a point's cost, and again with its slopes once it steps there.
  mutable Eigen::VectorXd places_;
  mutable Eigen::VectorXd residual_;
  mutable Slopes slopes_;
};

struct Start {
  Eigen::VectorXd places;
  double cost = std::numeric_limits<double>::infinity();
};

double cost_at(const VariableProjection& projection, const Eigen::VectorXd& places) try {
  const double cost = projection.solve(places).residual.squaredNorm();
  return std::isfinite(cost) ? cost : std::numeric_limits<double>::infinity();
} catch (const ConfigError&) {
  return std::numeric_limits<double>::infinity();
}

constexpr std::array<int, 8> kPrimes{2, 3, 5, 7, 11, 13, 17, 19};

/// A point of the sequence; from the ninth dimension on, the coordinates are those of the first again.
Eigen::VectorXd halton(int index, Eigen::Index dimensions) {
  Eigen::VectorXd point(dimensions);
  for (Eigen::Index i = 0; i < dimensions; ++i) {
    const int base = kPrimes[static_cast<std::size_t>(i) % kPrimes.size()];
    double value = 0.0;
    double share = 1.0;
    for (int rest = index + 1; rest > 0; rest /= base) {
      share /= base;
      value += share * (rest % base);
    }
    point[i] = value;
  }
  return point;
}

/// Nearly absent, so that an effect that is small against its range is found too; empty: no place of it is so.
Eigen::VectorXd nearly_absent(const SearchPlan& plan) {
  Eigen::VectorXd places = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(plan.searched.size()), 0.5);
  bool is_near = false;
  for (std::size_t i = 0; i < plan.searched.size(); ++i) {
    const SearchedParameter& searched = plan.searched[i];
    const double neutral = plan.neutral[searched.effect].type->parameters[searched.parameter].neutral;
    if (searched.logarithmic || std::isnan(neutral)) continue;
    const double place = searched.place_of(neutral);
    places[static_cast<Eigen::Index>(i)] = place + (place < 0.5 ? tuning::kCoefficientStep : -tuning::kCoefficientStep);
    is_near = true;
  }
  return is_near ? places : Eigen::VectorXd{};
}

Start refine(const VariableProjection& projection, const Start& start) {
  Eigen::VectorXd places = start.places;
  ceres::Problem problem;
  problem.AddResidualBlock(new ProjectedResidual{projection, places.size()}, nullptr, places.data());  // NOLINT: owned
  for (int i = 0; i < static_cast<int>(places.size()); ++i) {
    problem.SetParameterLowerBound(places.data(), i, 0.0);
    problem.SetParameterUpperBound(places.data(), i, 1.0);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  const bool are_several = projection.plan().neutral.size() > 1;
  options.max_num_iterations =
      tuning::kStepsPerParameter[are_several ? 1 : 0] * std::max(3, static_cast<int>(places.size()));
  options.function_tolerance = tuning::kSearchTolerance;
  options.num_threads = 1;
  // A step is cut off at the bounds, and the trust region judges it. A line search before would ask for the slopes of
  // every point that it tries: half of all predictions, and more where a clearance or a friction makes the cost uneven.
  options.max_num_line_search_step_size_iterations = 0;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  const double cost = cost_at(projection, places);
  return cost < start.cost ? Start{places, cost} : start;
}

/// The error of the prediction decreases as an instant comes nearer to the correct one.
Start settle_instants(const VariableProjection& projection, Start best) {
  const std::vector<SearchedParameter>& searched = projection.plan().searched;
  const auto improves = [&](Eigen::Index i, double step) {
    Start moved = best;
    moved.places[i] = std::clamp(moved.places[i] + step, 0.0, 1.0);
    moved.cost = cost_at(projection, moved.places);
    if (!(moved.cost < best.cost)) return false;
    best = std::move(moved);
    return true;
  };
  for (Eigen::Index i = 0; i < best.places.size(); ++i) {
    if (!searched[static_cast<std::size_t>(i)].is_instant) continue;
    for (double step = tuning::kInstantStepMax; step > tuning::kInstantStepMin; step *= 0.5) {
      if (!improves(i, step)) improves(i, -step);
    }
  }
  return best;
}

}  // namespace

int starts_for(Eigen::Index searched) noexcept {
  return tuning::kStarts[static_cast<std::size_t>(std::min<Eigen::Index>(searched, 3))];
}

namespace {

/// The best of the best few starts, continued; or else of the starts.
Start continued(const VariableProjection& projection, std::vector<Start> tried) {
  const Workers& workers = projection.workers();
  workers.for_each(tried.size(), [&](std::size_t i) { tried[i].cost = cost_at(projection, tried[i].places); });
  std::ranges::stable_sort(tried, {}, &Start::cost);
  std::vector<Start> found{tried.begin(),
                           tried.begin() + std::min(std::ssize(tried), std::ptrdiff_t{tuning::kRefinedStarts})};
  workers.for_each(found.size(), [&](std::size_t i) {
    if (!std::isfinite(found[i].cost)) return;  // from a place without a force no way leads on
    found[i] = settle_instants(projection, refine(projection, settle_instants(projection, found[i])));
  });
  Start& best = *std::ranges::min_element(found, {}, &Start::cost);
  return best.cost < tried.front().cost ? std::move(best) : std::move(tried.front());
}

}  // namespace

Eigen::VectorXd search_best(const VariableProjection& projection, const Eigen::VectorXd& first, int starts) {
  const auto searched = static_cast<Eigen::Index>(projection.plan().searched.size());
  if (searched == 0) return Eigen::VectorXd{};
  const bool has_instant = std::ranges::any_of(projection.plan().searched, &SearchedParameter::is_instant);
  if (has_instant) starts *= tuning::kInstantStarts;
  std::vector<Start> tried;
  if (first.size() == searched) tried.push_back({first});
  // A few points tell nothing of so many dimensions.
  if (!tried.empty() && searched > std::ssize(kPrimes)) return continued(projection, std::move(tried)).places;
  const Eigen::VectorXd small = nearly_absent(projection.plan());
  if (small.size() > 0) tried.push_back({small});
  for (int i = 0; i < starts; ++i) tried.push_back({halton(i, searched)});
  return continued(projection, std::move(tried)).places;
}

Eigen::VectorXd search_around(const VariableProjection& projection, const Eigen::VectorXd& found) {
  std::vector<Start> tried;
  const int starts = starts_for(found.size());
  for (int i = 0; i < starts; ++i) tried.push_back({0.75 * found + 0.25 * halton(i, found.size())});
  if (tried.empty()) return found;
  const Start around = continued(projection, std::move(tried));
  return around.cost < cost_at(projection, found) ? around.places : found;
}

}  // namespace hybridtest
