#include "diagnosis/identification/effect_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "core/config_error.hpp"
#include "diagnosis/identification/discrepancy.hpp"
#include "diagnosis/identification/search.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {
namespace {

/// The linearisation at the optimum from which fitted and held-out residuals are computed.
struct Linearisation {
  Eigen::MatrixXd columns;        // change of the prediction per searched, linear, nuisance parameter
  std::vector<std::size_t> free;  // of them, those not held at a bound
  // Positions in `columns` of the parameters that can be fitted without a block; an instant lies in one block only.
  std::vector<Eigen::Index> held_out_with;
};

Linearisation linearise(const VariableProjection& projection, const Eigen::VectorXd& places,
                        const Projected& solution) {
  const auto searched = places.size();
  Linearisation result;
  result.columns.resize(projection.rows(), searched + solution.columns.cols());
  const Eigen::VectorXd& coefficients = solution.coefficients;
  const Eigen::VectorXd here = searched > 0 ? projection.predicted(places, coefficients) : Eigen::VectorXd{};
  projection.workers().for_each(static_cast<std::size_t>(searched), [&](std::size_t parameter) {
    const auto i = static_cast<Eigen::Index>(parameter);
    Eigen::VectorXd moved = places;
    const double step = places[i] < 0.5 ? tuning::kResolution : -tuning::kResolution;
    moved[i] += step;
    result.columns.col(i) = (projection.predicted(moved, coefficients) - here) / step;
  });
  for (Eigen::Index i = 0; i < searched; ++i) {
    const bool at_bound = places[i] < tuning::kResolution || places[i] > 1.0 - tuning::kResolution;
    if (!at_bound) result.free.push_back(static_cast<std::size_t>(i));
  }
  result.columns.rightCols(solution.columns.cols()) = solution.columns;
  const std::vector<LinearParameter>& linear = projection.plan().linear;
  for (std::size_t i = 0; i < solution.held.size(); ++i) {
    // Nothing left of what the model has is as uncertain as a little of it.
    const bool is_of_model = i < linear.size() && linear[i].is_of_model;
    if (!solution.held[i] || is_of_model) result.free.push_back(static_cast<std::size_t>(searched) + i);
  }
  const std::vector<SearchedParameter>& parameters = projection.plan().searched;
  for (std::size_t i = 0; i < result.free.size(); ++i) {
    const bool is_instant = result.free[i] < parameters.size() && parameters[result.free[i]].is_instant;
    if (!is_instant) result.held_out_with.push_back(static_cast<Eigen::Index>(i));
  }
  result.columns = Eigen::MatrixXd{result.columns(Eigen::all, result.free)};
  return result;
}

Eigen::MatrixXd regularised(Eigen::MatrixXd normal) {
  normal.diagonal() *= 1.0 + tuning::kCovarianceRidge;
  normal.diagonal().array() += std::numeric_limits<double>::min();
  return normal;
}

/// What is known of searched parameters without any data: they lie in their range, 0 to 1, with the variance of an even
/// distribution, 1 / 12. Without it, two that a block alone tells apart would take any value when it is left out.
Eigen::MatrixXd knowledge_of_ranges(const VariableProjection& projection, const Linearisation& linear,
                                    const Eigen::VectorXd& residual) {
  const auto count = static_cast<Eigen::Index>(linear.held_out_with.size());
  Eigen::VectorXd precision = Eigen::VectorXd::Zero(count);
  const double variance = residual.squaredNorm() / static_cast<double>(std::max<Eigen::Index>(1, residual.size()));
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto free = static_cast<std::size_t>(linear.held_out_with[static_cast<std::size_t>(i)]);
    if (linear.free[free] < projection.plan().searched.size()) precision[i] = 12.0 * variance;
  }
  return precision.asDiagonal();
}

/// Where a fit stands.
struct Standing {
  Eigen::VectorXd places;        // of the searched parameters
  Eigen::VectorXd coefficients;  // of the linear ones and the nuisances
};

/// A fit that moves away from its optimum by the parameters that can be fitted without a block.
class MovedFit {
 public:
  MovedFit(const VariableProjection& projection, const Linearisation& linear, const Eigen::VectorXd& places,
           const Projected& solution)
      : projection_{projection}, linear_{linear}, optimum_{places, solution.coefficients} {
    if (!is_linear()) measured_ = projection.predicted(places, solution.coefficients) + solution.residual;
  }

  /// The prediction is a sum of columns: nothing moves but their coefficients.
  [[nodiscard]] bool is_linear() const noexcept { return optimum_.places.size() == 0; }
  [[nodiscard]] const Standing& optimum() const noexcept { return optimum_; }
  [[nodiscard]] Standing moved(Standing from, const Eigen::VectorXd& step) const {
    for (Eigen::Index i = 0; i < step.size(); ++i) {
      const Eigen::Index position = position_of(i);
      if (position < from.places.size()) {
        from.places[position] = std::clamp(from.places[position] + step[i], 0.0, 1.0);
      } else {
        from.coefficients[position - from.places.size()] += step[i];
      }
    }
    return from;
  }
  /// The residual in free simulation.
  [[nodiscard]] Eigen::VectorXd residual(const Standing& at) const {
    return measured_ - projection_.predicted(at.places, at.coefficients);
  }
  /// What each parameter changes there, by numeric derivatives. @param columns   those at the optimum.
  [[nodiscard]] Eigen::MatrixXd columns_at(const Standing& at, Eigen::MatrixXd columns) const {
    const Eigen::VectorXd here = projection_.predicted(at.places, at.coefficients);
    const auto simulated = at.places.size() + std::ssize(projection_.plan().linear);
    for (Eigen::Index i = 0; i < columns.cols(); ++i) {
      const Eigen::Index position = position_of(i);
      if (position >= simulated) continue;  // a nuisance: the same everywhere
      const bool is_searched = position < at.places.size();
      Standing there = at;
      double& value = is_searched ? there.places[position] : there.coefficients[position - at.places.size()];
      const double size = is_searched ? tuning::kResolution : tuning::kCoefficientStep;
      const double step = value < (is_searched ? 0.5 : 0.0) ? size : -size;
      value += step;
      columns.col(i) = (projection_.predicted(there.places, there.coefficients) - here) / step;
    }
    return columns;
  }

 private:
  [[nodiscard]] Eigen::Index position_of(Eigen::Index parameter) const {
    return static_cast<Eigen::Index>(
        linear_.free[static_cast<std::size_t>(linear_.held_out_with[static_cast<std::size_t>(parameter)])]);
  }

  const VariableProjection& projection_;
  const Linearisation& linear_;
  Standing optimum_;
  Eigen::VectorXd measured_;
};

/// A block of samples that is left out of a fit.
struct Block {
  Eigen::Index first = 0;
  Eigen::Index size = 0;

  [[nodiscard]] double squares_of_the_rest(const Eigen::VectorXd& residual) const {
    return residual.squaredNorm() - residual.segment(first, size).squaredNorm();
  }
  /// Of the normal equations of the rest.
  [[nodiscard]] Eigen::MatrixXd normal_of_the_rest(const Eigen::MatrixXd& columns) const {
    const auto inside = columns.middleRows(first, size);
    return columns.transpose() * columns - inside.transpose() * inside;
  }
  [[nodiscard]] Eigen::VectorXd gradient_of_the_rest(const Eigen::MatrixXd& columns,
                                                     const Eigen::VectorXd& residual) const {
    return columns.transpose() * residual - columns.middleRows(first, size).transpose() * residual.segment(first, size);
  }
};

/// The fit to the other blocks from where it stands: the step, or the largest share of it, halved a few times, that
/// does not make it worse. Nothing where none does. @param residual   moves along.
std::optional<Standing> step_without(const MovedFit& fit, const Block& block, const Standing& from,
                                     const Eigen::VectorXd& step, Eigen::VectorXd& residual) {
  const double before = block.squares_of_the_rest(residual);
  double share = 1.0;
  for (int halvings = 0; halvings < tuning::kRelinearisations; ++halvings, share *= 0.5) try {
      Standing moved = fit.moved(from, share * step);
      Eigen::VectorXd left = fit.residual(moved);
      if (!(block.squares_of_the_rest(left) <= before)) continue;
      residual = std::move(left);
      return moved;
    } catch (const ConfigError&) {
      continue;  // parameters that the effect does not accept
    }
  return {};
}

/// The block's residual when it is not fitted. A Gauss-Newton step of the fit to the other blocks, which is the whole
/// way for linear parameters, and for others where it is no longer than the step of their numeric derivatives.
/// Otherwise the fit is moved by it, and linearised again where it does not leave what the linear one would.
/// @param of_all, at_optimum   residual and columns of the fit to all blocks.
/// @param knowledge            see knowledge_of_ranges().
Eigen::VectorXd left_out(const MovedFit& fit, const Block& block, const Eigen::VectorXd& of_all,
                         const Eigen::MatrixXd& at_optimum, const Eigen::MatrixXd& knowledge, Eigen::VectorXd step) {
  if (fit.is_linear() || step.cwiseAbs().maxCoeff() <= tuning::kResolution) {
    return of_all.segment(block.first, block.size) - at_optimum.middleRows(block.first, block.size) * step;
  }
  Standing here = fit.optimum();
  Eigen::VectorXd residual = of_all;
  Eigen::MatrixXd columns = at_optimum;
  for (int pass = 0;; ++pass) {
    const double expected = block.squares_of_the_rest(residual - columns * step);
    std::optional<Standing> moved = step_without(fit, block, here, step, residual);
    const double left = block.squares_of_the_rest(residual);
    const bool is_settled = std::abs(left - expected) <= tuning::kResolution * left;
    if (!moved || is_settled || pass == tuning::kRelinearisations) break;
    here = std::move(*moved);
    try {
      columns = fit.columns_at(here, std::move(columns));
    } catch (const ConfigError&) {
      break;
    }
    step = regularised(block.normal_of_the_rest(columns) + knowledge)
               .ldlt()
               .solve(block.gradient_of_the_rest(columns, residual));
  }
  return residual.segment(block.first, block.size);
}

void hold_out(const VariableProjection& projection, const IdentificationProblem& problem, const Linearisation& linear,
              const MovedFit& fit_of_all, const Eigen::VectorXd& residual, FitOutcome& outcome) {
  const Eigen::MatrixXd columns = linear.columns(Eigen::all, linear.held_out_with);
  const Eigen::MatrixXd knowledge = knowledge_of_ranges(projection, linear, residual);
  const Eigen::MatrixXd normal = columns.transpose() * columns + knowledge;
  // A search ends beside the optimum. The way there is no matter of the block, and a parameter that the block alone
  // tells has no gradient in the others: it stays when the block is left out.
  const Eigen::VectorXd gradient = columns.transpose() * residual;
  const Eigen::VectorXd to_optimum =
      columns.cols() > 0 ? Eigen::VectorXd{regularised(normal).ldlt().solve(gradient)} : gradient;
  for (std::size_t t = 0; t < projection.touched().size(); ++t) {
    const std::size_t position = projection.touched()[t];
    const FitSegment& fit = problem.segments[position];
    const double unweighted = 1.0 / (fit.weight * fit.weight);
    SegmentResult& result = outcome.segments[position];
    result.mean_square = unweighted * residual.segment(projection.first_row(t), fit.measured.size()).squaredNorm() /
                         static_cast<double>(fit.measured.size());
    projection.workers().for_each(result.held_out_squares.size(), [&](std::size_t b) {
      const Block block{.first = projection.first_row(t) + fit.block_begins[b],
                        .size = fit.block_begins[b + 1] - fit.block_begins[b]};
      if (columns.cols() == 0) {
        result.held_out_squares[b] = unweighted * residual.segment(block.first, block.size).squaredNorm();
        return;
      }
      const Eigen::MatrixXd inside = columns.middleRows(block.first, block.size);
      const Eigen::MatrixXd rest = regularised(normal - inside.transpose() * inside);
      const Eigen::VectorXd step =
          rest.ldlt().solve(gradient - inside.transpose() * residual.segment(block.first, block.size)) - to_optimum;
      result.held_out_squares[b] =
          unweighted * left_out(fit_of_all, block, residual, columns, knowledge, step).squaredNorm();
    });
  }
}

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
    by_noise += variances_of_sums(residual.segment(begin, rows), wrong.weights(begin, rows).leftCols(count));
    by_noise_alone += variances_of_sums(residual.segment(begin, rows), right.weights(begin, rows));
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
    const double per_place = (searched.at(std::min(1.0, place + tuning::kResolution)) -
                              searched.at(std::max(0.0, place - tuning::kResolution))) /
                             (2.0 * tuning::kResolution);
    return FreeParameter{searched.effect, searched.parameter, std::abs(per_place)};
  }
  if (index - plan.searched.size() >= plan.linear.size()) return {};
  const LinearParameter& parameter = plan.linear[index - plan.searched.size()];
  return FreeParameter{parameter.effect, parameter.parameter, parameter.unit};
}

/// Fills in the parameters of an outcome whose effects are known.
void estimate(const VariableProjection& projection, const IdentificationProblem& problem, const Eigen::VectorXd& places,
              const Projected& solution, const Linearisation& linear, FitOutcome& outcome) {
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
    result[plan.searched[i].effect][plan.searched[i].parameter].at_bound =
        place < tuning::kResolution || place > 1.0 - tuning::kResolution;
  }
  for (std::size_t i = 0; i < plan.linear.size(); ++i) {
    result[plan.linear[i].effect][plan.linear[i].parameter].at_bound = solution.held[i];
  }
}

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
  const auto degrades = [](const EffectSetting& e) { return e.type->traits.family == EffectFamily::degradation; };
  if (effects.empty() || fit.numbers.directions.cols() > 0 || std::ranges::any_of(effects, degrades)) return 0.0;
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

enum class Look { from_start, everywhere };

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
  } else if (look == Look::everywhere && freedoms.empty()) {
    first = simplest_first(problem, effects, plan, with_nuisance);
  }
  const int starts = look == Look::everywhere ? starts_for(static_cast<Eigen::Index>(plan.searched.size())) : 0;
  const Eigen::VectorXd places = search_best(projection, first, starts);
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
  hold_out(projection, problem, linear, {projection, linear, places, solution}, solution.residual, outcome);
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
  estimate(projection, problem, places, solution, linear, outcome);
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

/// Parameters that a scenario may leave out are left out where the blocks cannot hold them: when they are fitted, but
/// predict a block that was left out much worse than the others alone do; and where one of them goes to a limit of its
/// range but is not worth its place in the score. The shape of an effect that the model has is the model's where
/// nothing is left of it.
FitOutcome fit_from(const IdentificationProblem& problem, const std::vector<const EffectType*>& effects,
                    const std::vector<EffectSetting>& start, Look look, bool with_nuisance) {
  FitOutcome all = fit_free(problem, effects, start, look, with_nuisance, {});
  std::vector<Freedom> freedoms(effects.size(), Freedom::all);
  for (std::size_t i = 0; i < effects.size(); ++i) {
    if (may_have_no_size(problem, all, i)) freedoms[i] = Freedom::required;
  }
  if (std::ranges::find(freedoms, Freedom::required) != freedoms.end()) {
    return fit_free(problem, effects, start, look, with_nuisance, freedoms);
  }
  const Squares squares = squares_of(problem, all);
  freedoms.assign(effects.size(), Freedom::required);
  const bool has_optional =
      plan_search(problem, effects, freedoms).searched.size() < plan_search(problem, effects).searched.size();
  if (!has_optional) return all;
  const bool is_held = squares.held_out < tuning::kHeldOutBeyondFitted * squares.fitted;
  const bool is_at_limit = has_optional_at_limit(all);
  if (is_held && !is_at_limit) return all;
  FitOutcome required = fit_free(problem, effects, start, look, with_nuisance, freedoms);
  const bool is_as_good = is_at_limit && lost_without(problem, all, required) < tuning::kParameterPrior;
  return is_as_good || squares_of(problem, required).held_out < squares.held_out ? required : all;
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

FitOutcome fit_nothing(const IdentificationProblem& problem, bool with_nuisance) {
  return fit_from(problem, {}, {}, Look::from_start, with_nuisance);
}

}  // namespace hybridtest
