#include "diagnosis/identification/parameter_doubt.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "diagnosis/identification/coloured_noise.hpp"
#include "diagnosis/identification/discrepancy.hpp"
#include "diagnosis/identification/law_candidates.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {
namespace {

/// What is not known of the free parameters.
struct Doubt {
  Eigen::VectorXd variances;   // beside a model whose numbers are right
  Eigen::MatrixXd covariance;  // beside one whose numbers are slightly wrong
  Eigen::MatrixXd predicting;  // of what they predict beside the model's numbers as they are
  double freedom = 1.0;        // degrees of freedom of all
};

/// What a block pulls at the parameters, as if it had not pulled the fit towards itself: its residual over one minus
/// its leverage (CR3 of Bell and McCaffrey, Survey Methodology 28, 2002), brought to the parameters' size by
/// X' f(X M X') = f(X'X M) X', with M = root root' the inverse of the normal matrix. What this block alone tells, as an
/// instant that lies in it, has no other fit to be compared with: the block pulls nothing there.
Eigen::VectorXd pull_of_block(const Eigen::MatrixXd& columns, const Eigen::VectorXd& residual,
                              const Eigen::MatrixXd& root) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> leverage{root.transpose() * (columns.transpose() * columns) *
                                                                root};
  const Eigen::ArrayXd told_by_others = 1.0 - leverage.eigenvalues().array();
  const Eigen::VectorXd scale = (told_by_others > tuning::kToldByOthers).select(told_by_others.inverse(), 0.0).matrix();
  const Eigen::VectorXd own =
      leverage.eigenvectors().transpose() * (root.transpose() * (columns.transpose() * residual));
  return root * (leverage.eigenvectors() * scale.cwiseProduct(own));
}

/// How the residual moves parameters that are fitted by least squares, and slightly wrong numbers beside them that
/// are known to some precision before the test.
class Sandwich {
 public:
  /// @param precision   of each column's coefficient, in units of the squared residual of one sample; 0: not known.
  Sandwich(const Eigen::MatrixXd& columns, const Eigen::VectorXd& precision)
      : columns_{columns}, inverse_{inverse_of(columns, precision)} {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> parts{inverse_};
    root_ = parts.eigenvectors() * parts.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
    covariance_ = Eigen::MatrixXd::Zero(inverse_.rows(), inverse_.cols());
  }

  [[nodiscard]] Eigen::MatrixXd weights(Eigen::Index first, Eigen::Index size) const {
    return columns_.middleRows(first, size) * inverse_;
  }
  [[nodiscard]] const Eigen::MatrixXd& covariance() const noexcept { return covariance_; }

  /// Widens what is known so far of the first parameters to at least these variances; how they go together stays.
  void widen_to(const Eigen::VectorXd& variances) {
    for (Eigen::Index i = 0; i < variances.size(); ++i) {
      const double known = covariance_(i, i);
      if (known >= variances[i]) continue;
      const double factor = known > 0.0 ? std::sqrt(variances[i] / known) : 0.0;
      covariance_.row(i) *= factor;
      covariance_.col(i) *= factor;
      covariance_(i, i) = variances[i];
    }
  }
  /// Where parameters stand for each other exactly, no residual moves them, and nothing is known of them. The columns
  /// are of length one.
  /// @param noise   of one sample.
  void add_untold(double noise) {
    for (Eigen::Index i = 0; i < root_.cols(); ++i) {
      const double untold = root_.col(i).squaredNorm();
      if (untold > tuning::kMainShare / tuning::kCovarianceRidge) {
        covariance_ += noise * root_.col(i) * root_.col(i).transpose();
      }
    }
  }
  void add_block(const Eigen::VectorXd& residual, Eigen::Index first, Eigen::Index size) {
    const Eigen::VectorXd pull = pull_of_block(columns_.middleRows(first, size), residual.segment(first, size), root_);
    covariance_ += pull * pull.transpose();
  }
  /// @param pull   one column per parameter; see Discrepancy::pull().
  void add_pull(const Eigen::MatrixXd& pull) { covariance_ += pull.transpose() * pull; }
  /// What is not known of the numbers before the test. @param meat   its part between the two inverses.
  void add_prior(const Eigen::VectorXd& meat) { covariance_ += inverse_ * meat.asDiagonal() * inverse_; }

 private:
  static Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& columns, const Eigen::VectorXd& precision) {
    Eigen::MatrixXd normal = columns.transpose() * columns;
    normal.diagonal() += precision;
    return regularised(std::move(normal)).ldlt().solve(Eigen::MatrixXd::Identity(columns.cols(), columns.cols()));
  }

  const Eigen::MatrixXd& columns_;
  Eigen::MatrixXd inverse_;
  Eigen::MatrixXd root_;
  Eigen::MatrixXd covariance_;
};

/// The weighted changes by numbers of the model that may be slightly wrong beside these effects, one column for each,
/// and by how much each may be off [standard deviation].
struct WrongNumbers {
  Eigen::MatrixXd columns;
  std::vector<double> deviations;
};

/// What was found at a channel before is known as well as it could be told there.
void add_found_before(const VariableProjection& projection, const IdentificationProblem& problem,
                      WrongNumbers& numbers) {
  const Eigen::Index count = problem.segments.front().found_changes.cols();
  if (count == 0) return;
  Eigen::MatrixXd changes = Eigen::MatrixXd::Zero(projection.rows(), count);
  for (std::size_t t = 0; t < projection.touched().size(); ++t) {
    const FitSegment& fit = problem.segments[projection.touched()[t]];
    changes.middleRows(projection.first_row(t), fit.measured.size()) = fit.weight * fit.found_changes;
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    if (changes.col(i).squaredNorm() == 0.0) continue;
    numbers.columns.conservativeResize(projection.rows(), numbers.columns.cols() + 1);
    numbers.columns.rightCols(1) = changes.col(i);
    numbers.deviations.push_back(1.0);
  }
}

WrongNumbers numbers_beside(const VariableProjection& projection, const IdentificationProblem& problem,
                            const FitOutcome& outcome) {
  WrongNumbers numbers;
  std::vector<const EffectType*> types;
  double output = 0.0;
  for (std::size_t t = 0; t < projection.touched().size(); ++t) {
    const FitSegment& fit = problem.segments[projection.touched()[t]];
    output += fit.weight * fit.weight * fit.measured.squaredNorm();
    for (std::size_t i = 0; i < fit.number_types.size(); ++i) {
      const EffectType* const type = fit.number_types[i];
      const bool is_fitted =
          std::ranges::find(outcome.effects, type, &EffectSetting::type) != outcome.effects.end() ||
          (outcome.with_nuisance && std::ranges::find(fit.nuisance_types, type) != fit.nuisance_types.end());
      // A zero is known exactly before a test.
      if (is_fitted || type->traits.number == ModelNumber::offset) continue;
      auto place = std::ranges::find(types, type) - types.begin();
      if (place == static_cast<std::ptrdiff_t>(types.size())) {
        types.push_back(type);
        numbers.columns.conservativeResize(projection.rows(), place + 1);
        numbers.columns.col(place).setZero();
      }
      numbers.columns.col(place).segment(projection.first_row(t), fit.measured.size()) +=
          fit.weight * fit.number_slopes.col(static_cast<Eigen::Index>(i));
    }
  }
  Eigen::Index kept = 0;
  for (std::size_t i = 0; i < types.size(); ++i) {
    const Eigen::VectorXd column = numbers.columns.col(static_cast<Eigen::Index>(i));
    if (column.squaredNorm() == 0.0) continue;
    numbers.columns.col(kept++) = column;
    // A bandwidth is known by itself; the others by what they change of the output.
    const double size = types[i]->traits.number == ModelNumber::bandwidth ? 1.0 : column.norm() / std::sqrt(output);
    numbers.deviations.push_back(tuning::kNumbersWithin / size);
  }
  numbers.columns.conservativeResize(projection.rows(), kept);
  add_found_before(projection, problem, numbers);
  return numbers;
}

/// Of what no model is expected to reproduce: its energy, in weighted squares.
double allowed_energy(const FitSegment& fit) {
  const double allowed = tuning::kModelAllowance * fit.weight;
  return allowed * allowed * fit.measured.squaredNorm() / static_cast<double>(fit.measured.size());
}

/// Adds how noise of the input and smoothing move the parameters, one row per kind of error: a law that is not linear
/// answers noise that rides on the motion with less force, and a part of it looks like another number of the law. The
/// shift is known to first order only, so that it counts as doubt and nothing is taken off (Cook and Stefanski, Journal
/// of the American Statistical Association 89, 1994, extrapolate it).
void add_pull_of_input(const FitSegment& fit, const Eigen::MatrixXd& weights, Eigen::MatrixXd& pull) {
  const auto kinds = static_cast<Eigen::Index>(fit.input_errors.size());
  if (kinds > pull.rows()) pull.conservativeResizeLike(Eigen::MatrixXd::Zero(kinds, weights.cols()));
  for (Eigen::Index kind = 0; kind < kinds; ++kind) {
    pull.row(kind) += fit.weight * fit.input_errors[static_cast<std::size_t>(kind)].transpose() * weights;
  }
}

/// Three parts. One is how much blocks disagree (Liang and Zeger, Biometrika 73, 1986, blocks as clusters, corrected
/// for their small number): noise of any colour and distribution. Another is what repeats of the residual and that no
/// difference between blocks shows: the discrepancy term, of which each feature may take as much as all take here on
/// average, also along the columns of the parameters (random effects). The third is what the error of the input does
/// to a law that is not linear.
///
/// Beside wrong numbers both have a lower limit. So few blocks may agree by chance: noise that is the same throughout
/// would move the parameters at least as much. And a misfit that fits the parameters leaves nothing to be seen: it is
/// as large as what no model is expected to reproduce.
Doubt doubt_of(const VariableProjection& projection, const IdentificationProblem& problem, const Linearisation& linear,
               const Eigen::VectorXd& residual, const FitOutcome& outcome) {
  const Eigen::Index count = linear.columns.cols();
  if (count == 0) return {};
  const WrongNumbers numbers = numbers_beside(projection, problem, outcome);
  const auto beside = static_cast<Eigen::Index>(numbers.deviations.size());
  Eigen::MatrixXd all(linear.columns.rows(), count + beside);
  all.leftCols(count) = linear.columns;
  if (beside > 0) all.rightCols(beside) = numbers.columns;
  // Columns in metres and in newtons differ by ten orders of magnitude, which would cost their inverses all digits.
  const Eigen::VectorXd size = all.colwise().norm().transpose().array().max(std::numeric_limits<double>::min());
  all *= size.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd own = all.leftCols(count);
  // Noise of one sample, as if all were independent of each other.
  double independent = 0.0;
  for (const std::size_t position : projection.touched()) independent += problem.segments[position].independent;
  const double noise = residual.squaredNorm() / std::max(1.0, independent);
  Eigen::VectorXd precision = Eigen::VectorXd::Zero(count + beside);
  for (Eigen::Index i = 0; i < beside; ++i) {
    const double deviation = numbers.deviations[static_cast<std::size_t>(i)] * size[count + i];
    precision[count + i] = noise / (deviation * deviation);
  }
  Sandwich right{own, Eigen::VectorXd::Zero(count)};
  Sandwich wrong{all, precision};
  Sandwich predicting = right;
  right.add_untold(noise);
  wrong.add_untold(noise);
  Eigen::VectorXd by_noise = Eigen::VectorXd::Zero(count);
  Eigen::VectorXd by_noise_alone = by_noise;
  double blocks = 0.0;
  for (std::size_t t = 0; t < projection.touched().size(); ++t) {
    const FitSegment& fit = problem.segments[projection.touched()[t]];
    const Eigen::Index begin = projection.first_row(t);
    for (std::size_t b = 0; b + 1 < fit.block_begins.size(); ++b, blocks += 1.0) {
      const Eigen::Index rows = fit.block_begins[b + 1] - fit.block_begins[b];
      right.add_block(residual, begin + fit.block_begins[b], rows);
      predicting.add_block(residual, begin + fit.block_begins[b], rows);
      wrong.add_block(residual, begin + fit.block_begins[b], rows);
    }
    const Eigen::Index rows = fit.measured.size();
    const ColouredNoise disturbance{residual.segment(begin, rows)};
    by_noise += disturbance.variances_along(wrong.weights(begin, rows).leftCols(count));
    by_noise_alone += disturbance.variances_along(right.weights(begin, rows));
  }
  wrong.widen_to(by_noise);
  predicting.widen_to(by_noise_alone);
  wrong.add_prior(noise * precision);
  Eigen::MatrixXd by_input(0, count + beside);
  for (std::size_t t = 0; t < projection.touched().size(); ++t) {
    const FitSegment& fit = problem.segments[projection.touched()[t]];
    const Eigen::Index begin = projection.first_row(t);
    const Eigen::Index rows = fit.measured.size();
    const double repeatable = fit.discrepancy->repeatable(residual.segment(begin, rows));
    right.add_pull(fit.discrepancy->pull(repeatable, right.weights(begin, rows)));
    const double at_least = std::max(repeatable, allowed_energy(fit));
    const Eigen::MatrixXd weights = wrong.weights(begin, rows);
    wrong.add_pull(fit.discrepancy->pull(at_least, weights));
    add_pull_of_input(fit, weights, by_input);
    predicting.add_pull(fit.discrepancy->pull(at_least, predicting.weights(begin, rows)));
  }
  wrong.add_pull(by_input);
  const auto unit = size.head(count).cwiseInverse().asDiagonal();
  const double scale = tuning::kIntervalScale * tuning::kIntervalScale;
  return {.variances = (unit * right.covariance() * unit).diagonal(),
          .covariance = scale * (unit * wrong.covariance().topLeftCorner(count, count) * unit),
          .predicting = scale * (unit * predicting.covariance() * unit),
          .freedom = std::max(1.0, blocks - 1.0)};
}

/// Where a free parameter of the linearisation stands among those of the effects, and its unit there.
struct FreeParameter {
  std::size_t effect = 0;
  std::size_t parameter = 0;
  double unit = 0.0;
};

/// Nothing for a nuisance.
std::optional<FreeParameter> free_parameter(const SearchPlan& plan, const Eigen::VectorXd& places, std::size_t index) {
  if (index < plan.searched.size()) {
    const SearchedParameter& searched = plan.searched[index];
    const double place = places[static_cast<Eigen::Index>(index)];
    return FreeParameter{searched.effect, searched.parameter, std::abs(searched.slope_at(place))};
  }
  if (index - plan.searched.size() >= plan.linear.size()) return {};
  const LinearParameter& parameter = plan.linear[index - plan.searched.size()];
  return FreeParameter{parameter.effect, parameter.parameter, parameter.unit};
}

/// Whether the prediction stays the same up to the upper end of a parameter's range, as where a strength is not
/// reached.
bool shows_nothing_above(const VariableProjection& projection, const Eigen::VectorXd& places,
                         const Eigen::VectorXd& coefficients, std::size_t parameter) {
  Eigen::VectorXd at_end = places;
  at_end[static_cast<Eigen::Index>(parameter)] = 1.0;
  const Eigen::VectorXd here = projection.predicted(places, coefficients);
  return (projection.predicted(at_end, coefficients) - here).norm() <= tuning::kModelAllowance * here.norm();
}

}  // namespace

void estimate_parameters(const VariableProjection& projection, const IdentificationProblem& problem,
                         const Linearisation& linear, const Eigen::VectorXd& places, const Projected& solution,
                         FitOutcome& outcome) {
  std::vector<std::vector<ParameterEstimate>>& result = outcome.parameters;
  std::vector<Eigen::Index> begins{0};  // of each effect's parameters among all
  for (const EffectSetting& effect : outcome.effects) {
    begins.push_back(begins.back() + std::ssize(effect.values));
    result.emplace_back();
    for (const double value : effect.values) result.back().push_back({.value = value});
  }
  const Doubt doubt = doubt_of(projection, problem, linear, solution.residual, outcome);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(begins.back(), begins.back());
  outcome.predicting = covariance;
  outcome.freedom = doubt.freedom;
  const auto place_of = [&](const FreeParameter& one) {
    return begins[one.effect] + static_cast<Eigen::Index>(one.parameter);
  };
  const SearchPlan& plan = projection.plan();
  std::vector<std::optional<FreeParameter>> free;
  for (const std::size_t index : linear.free) free.push_back(free_parameter(plan, places, index));
  for (std::size_t i = 0; i < free.size(); ++i) {
    const std::optional<FreeParameter>& here = free[i];
    if (!here) continue;
    const auto row = static_cast<Eigen::Index>(i);
    ParameterEstimate& estimate = result[here->effect][here->parameter];
    estimate.standard_error = std::sqrt(doubt.variances[row]) * std::abs(here->unit);
    estimate.beside_wrong_numbers = std::sqrt(std::max(0.0, doubt.covariance(row, row))) * std::abs(here->unit);
    estimate.freedom = doubt.freedom;
    // Packets are taken up at whole samples: an arrival is known to one sample.
    const EffectType& type = *outcome.effects[here->effect].type;
    if (type.interface == EffectInterface::network && type.parameters[here->parameter].unit == "s") {
      estimate.beside_wrong_numbers = std::max(estimate.beside_wrong_numbers,
                                               problem.segments.front().segment.period_s / quantile_95(doubt.freedom));
    }
    for (std::size_t j = 0; j < free.size(); ++j) {
      const std::optional<FreeParameter>& there = free[j];
      if (!there) continue;
      const auto column = static_cast<Eigen::Index>(j);
      const double unit = here->unit * there->unit;
      covariance(place_of(*here), place_of(*there)) = unit * doubt.covariance(row, column);
      outcome.predicting(place_of(*here), place_of(*there)) = unit * doubt.predicting(row, column);
    }
  }
  for (std::size_t i = 0; i < outcome.effects.size(); ++i) {
    const Eigen::Index size = begins[i + 1] - begins[i];
    outcome.covariances.emplace_back(covariance.block(begins[i], begins[i], size, size));
  }
  for (std::size_t i = 0; i < plan.searched.size(); ++i) {
    const double place = places[static_cast<Eigen::Index>(i)];
    const SearchedParameter& searched = plan.searched[i];
    ParameterEstimate& estimate = result[searched.effect][searched.parameter];
    const EffectType& type = *outcome.effects[searched.effect].type;
    const std::optional<SearchRange> range = range_of(type, type.parameters[searched.parameter]);
    const bool is_high = searched.is_high_end(place);
    estimate.at_bound = is_high || searched.is_low_end(place);
    if (!range || !range->restriction.is_unseen_at_high) continue;
    estimate.at_least = is_high || shows_nothing_above(projection, places, solution.coefficients, i);
    if (!estimate.at_least) continue;
    estimate.at_bound = true;
    estimate.standard_error = estimate.beside_wrong_numbers = 0.0;  // no interval has an upper end
  }
  for (std::size_t i = 0; i < plan.linear.size(); ++i) {
    result[plan.linear[i].effect][plan.linear[i].parameter].at_bound = solution.held[i];
  }
}

}  // namespace hybridtest
