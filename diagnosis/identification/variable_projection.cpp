#include "diagnosis/identification/variable_projection.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace hybridtest {
namespace {

/// Keeps columns that are almost multiples of each other from cancelling in huge numbers.
constexpr double kRidge = 1e-10;

/// Several effects are linear together when their prediction is what their columns say, to this share of the
/// residual; else they are linearised again where they are, so many times and by that step (in units of the parameter).
constexpr double kAsGoodAsLinear = 1e-3;
constexpr int kRelinearisations = 3;
constexpr double kCoefficientStep = 1e-2;

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
      matrix(i, i) = matrix(i, i) * (1.0 + kRidge) + std::numeric_limits<double>::min();
    }
  }
  return matrix.partialPivLu().solve(vector);
}

/// Least squares within bounds: what leaves its bounds is held there, one after the other.
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
    : problem_{problem}, plan_{std::move(plan)}, first_rows_{0} {
  Eigen::Index nuisances = 0;
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    const FitSegment& fit = problem.segments[i];
    const bool touches = plan_.neutral.empty() || std::ranges::any_of(plan_.neutral, [&](const EffectSetting& effect) {
                           return fit.segment.touched_by(*effect.type);
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
    values.segment(first_rows_[i], fit.measured.size()) = fit.weight * predict(problem_, fit, effects);
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
  for (Eigen::Index i = 0; i < linear; ++i) {
    const LinearParameter& parameter = plan_.linear[static_cast<std::size_t>(i)];
    std::vector<EffectSetting> present = absent;
    present[parameter.effect].values[parameter.parameter] += parameter.unit;
    result.columns.col(i) = stacked(present) - base;
    bounds.push_back({parameter.low / parameter.unit, parameter.high / parameter.unit});
  }
  result.columns.rightCols(nuisance_.cols()) = nuisance_;
  bounds.resize(static_cast<std::size_t>(result.columns.cols()));
  const Eigen::VectorXd right = measured_ - base;
  result.coefficients = bounded_least_squares(result.columns, right, bounds, result.held);
  result.residual = right - result.columns * result.coefficients;
  // An effect by itself is linear in what it says it is; several may not be together.
  return linear > 0 && plan_.neutral.size() > 1 ? relinearised(places, std::move(result), bounds) : result;
}

Projected VariableProjection::relinearised(const Eigen::VectorXd& places, Projected solution,
                                           const std::vector<Bounds>& bounds) const {
  const auto linear = static_cast<Eigen::Index>(plan_.linear.size());
  Eigen::VectorXd here = predicted(places, solution);
  const Eigen::VectorXd off = measured_ - here - solution.residual;
  if (off.norm() <= kAsGoodAsLinear * solution.residual.norm()) return solution;
  solution.residual = measured_ - here;
  Projected best = solution;
  for (int pass = 0; pass < kRelinearisations; ++pass) {
    for (Eigen::Index i = 0; i < linear; ++i) {
      Projected moved = solution;
      const double step = moved.coefficients[i] > 0.0 ? -kCoefficientStep : kCoefficientStep;
      moved.coefficients[i] += step;
      solution.columns.col(i) = (predicted(places, moved) - here) / step;
    }
    solution.coefficients = bounded_least_squares(
        solution.columns, solution.residual + solution.columns * solution.coefficients, bounds, solution.held);
    here = predicted(places, solution);
    solution.residual = measured_ - here;
    const double before = best.residual.squaredNorm();
    const double after = solution.residual.squaredNorm();
    if (after < before) best = solution;
    if (after > (1.0 - kAsGoodAsLinear) * before) break;
  }
  return best;
}

Eigen::VectorXd VariableProjection::predicted(const Eigen::VectorXd& places, const Projected& solution) const {
  return stacked(settings(places, solution)) + nuisance_ * solution.coefficients.tail(nuisance_.cols());
}

std::vector<EffectSetting> VariableProjection::settings(const Eigen::VectorXd& places,
                                                        const Projected& solution) const {
  std::vector<EffectSetting> effects = searched_at(places);
  for (std::size_t i = 0; i < plan_.linear.size(); ++i) {
    const LinearParameter& linear = plan_.linear[i];
    const EffectParameter& parameter = effects[linear.effect].type->parameters[linear.parameter];
    double& value = effects[linear.effect].values[linear.parameter];
    value += linear.unit * solution.coefficients[static_cast<Eigen::Index>(i)];
    value = std::clamp(value, parameter.low, parameter.high);
  }
  return effects;
}

}  // namespace hybridtest
