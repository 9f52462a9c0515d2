#include "diagnosis/identification/held_out_blocks.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/config_error.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {
namespace {

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
      // A nuisance changes the same everywhere.
      if (position < simulated) columns.col(i) = projection_.slope(at.places, at.coefficients, position, here);
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
  /// The Gauss-Newton step of the fit to the rest. @param normal, gradient   of the fit to all.
  [[nodiscard]] Eigen::VectorXd step_of_the_rest(const Eigen::MatrixXd& normal, const Eigen::VectorXd& gradient,
                                                 const Eigen::MatrixXd& columns,
                                                 const Eigen::VectorXd& residual) const {
    const Eigen::MatrixXd inside = columns.middleRows(first, size);
    const Eigen::MatrixXd rest = regularised(normal - inside.transpose() * inside);
    return rest.ldlt().solve(gradient - inside.transpose() * residual.segment(first, size));
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
    step = block.step_of_the_rest(columns.transpose() * columns + knowledge, columns.transpose() * residual, columns,
                                  residual);
  }
  return residual.segment(block.first, block.size);
}

}  // namespace

void hold_out(const VariableProjection& projection, const IdentificationProblem& problem, const Linearisation& linear,
              const Eigen::VectorXd& places, const Projected& solution, FitOutcome& outcome) {
  const MovedFit fit_of_all{projection, linear, places, solution};
  const Eigen::VectorXd& residual = solution.residual;
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
      const Eigen::VectorXd step = block.step_of_the_rest(normal, gradient, columns, residual) - to_optimum;
      result.held_out_squares[b] =
          unweighted * left_out(fit_of_all, block, residual, columns, knowledge, step).squaredNorm();
    });
  }
}

}  // namespace hybridtest
