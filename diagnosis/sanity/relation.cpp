#include "diagnosis/sanity/relation.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "diagnosis/signals/signals.hpp"
#include "diagnosis/tuning.hpp"
#include "mechanics/laws/presliding_element.hpp"

namespace hybridtest {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd as_vector(std::span<const double> values) {
  return Eigen::Map<const VectorXd>{values.data(), std::ssize(values)};
}

/// Central differences per sample.
VectorXd change_of(const VectorXd& values) {
  const Index last = values.size() - 1;
  VectorXd change = VectorXd::Zero(values.size());
  for (Index i = 1; i < last; ++i) change[i] = 0.5 * (values[i + 1] - values[i - 1]);
  return change;
}

VectorXd shifted(const VectorXd& values, Index by) {
  VectorXd result(values.size());
  for (Index i = 0; i < values.size(); ++i) result[i] = values[std::clamp<Index>(i - by, 0, values.size() - 1)];
  return result;
}

VectorXd with_play(const VectorXd& values, double presliding) {
  PreslidingElement element{presliding};
  VectorXd share(values.size());
  for (Index i = 0; i < values.size(); ++i) share[i] = element.share(values[i]);
  return share;
}

/// Shapes of output that some stage could make of the input.
MatrixXd shapes_of(const VectorXd& input_m, Index shift) {
  const double span_m = input_m.maxCoeff() - input_m.minCoeff();
  const double half = 0.5 * input_m.cwiseAbs().maxCoeff();
  std::vector<VectorXd> shapes{input_m,
                               change_of(input_m),
                               change_of(change_of(input_m)),
                               input_m.array().cube(),
                               (input_m.array() - half).cwiseMax(0.0),
                               (input_m.array() + half).cwiseMin(0.0),
                               shifted(input_m, shift),
                               shifted(input_m, -shift)};
  for (const double share : tuning::kPlayShares) shapes.push_back(with_play(input_m, share * span_m));
  MatrixXd columns(input_m.size(), std::ssize(shapes));
  for (Index i = 0; i < columns.cols(); ++i) columns.col(i) = shapes[static_cast<std::size_t>(i)];
  return columns;
}

/// Least squares of columns that may be almost multiples of each other.
VectorXd coefficients(const MatrixXd& columns, const VectorXd& right) {
  MatrixXd normal = columns.transpose() * columns;
  normal.diagonal() *= 1.0 + tuning::kShapeRidge;
  normal.diagonal().array() += std::numeric_limits<double>::min();
  return normal.ldlt().solve(columns.transpose() * right);
}

/// A stretch of rows, means left out.
struct Rows {
  MatrixXd columns;
  VectorXd output;
};

Rows rows_between(const MatrixXd& columns, const VectorXd& output, Index begin, Index end) {
  Rows rows{columns.middleRows(begin, end - begin), output.segment(begin, end - begin)};
  rows.columns.rowwise() -= rows.columns.colwise().mean().eval();
  rows.output.array() -= rows.output.mean();
  return rows;
}

std::vector<Rows> blocks_of_rows(const MatrixXd& columns, const VectorXd& output, Index count) {
  std::vector<Rows> blocks;
  for (Index b = 0; b < count; ++b) {
    blocks.push_back(rows_between(columns, output, output.size() * b / count, output.size() * (b + 1) / count));
  }
  return blocks;
}

double share_left(double left, double all) { return all > 0.0 ? left / all : 1.0; }

/// Each block predicted by all others.
double held_out_share(const std::vector<Rows>& blocks) {
  const Index width = blocks.front().columns.cols();
  MatrixXd normal = MatrixXd::Zero(width, width);
  VectorXd right = VectorXd::Zero(width);
  for (const Rows& block : blocks) {
    normal += block.columns.transpose() * block.columns;
    right += block.columns.transpose() * block.output;
  }
  double left = 0.0;
  double all = 0.0;
  for (const Rows& block : blocks) {
    MatrixXd others = normal - block.columns.transpose() * block.columns;
    others.diagonal() *= 1.0 + tuning::kShapeRidge;
    others.diagonal().array() += std::numeric_limits<double>::min();
    const VectorXd found = others.ldlt().solve(right - block.columns.transpose() * block.output);
    left += (block.output - block.columns * found).squaredNorm();
    all += block.output.squaredNorm();
  }
  return 1.0 - share_left(left, all);
}

/// Each half of a block predicted by its other half: a specimen that has changed meanwhile still follows the motion.
double neighbour_share(const MatrixXd& columns, const VectorXd& output, Index blocks) {
  double left = 0.0;
  double all = 0.0;
  const std::vector<Rows> halves = blocks_of_rows(columns, output, 2 * blocks);
  for (std::size_t i = 0; i < halves.size(); ++i) {
    const Rows& other = halves[i ^ 1U];
    left += (halves[i].output - halves[i].columns * coefficients(other.columns, other.output)).squaredNorm();
    all += halves[i].output.squaredNorm();
  }
  return 1.0 - share_left(left, all);
}

}  // namespace

bool Relation::is_none() const noexcept { return held_out <= tuning::kUnrelatedShare && fitted < tuning::kMainShare; }

Relation relation_between(std::span<const double> input_m, std::span<const double> output, std::size_t shift) {
  const auto blocks = static_cast<Index>(tuning::kBlocksMin);
  const VectorXd measured = as_vector(output);
  MatrixXd shapes = shapes_of(as_vector(input_m), static_cast<Index>(shift));
  for (Index i = 0; i < shapes.cols(); ++i)
    shapes.col(i) /= std::max(shapes.col(i).norm(), std::numeric_limits<double>::min());
  const Rows whole = rows_between(shapes, measured, 0, measured.size());
  const double left = (whole.output - whole.columns * coefficients(whole.columns, whole.output)).squaredNorm();
  // Displacement, velocity and the last play are enough for a stretch of few cycles.
  MatrixXd few(shapes.rows(), 3);
  few << shapes.col(0), shapes.col(1), shapes.rightCols(1);
  return {.fitted = 1.0 - share_left(left, whole.output.squaredNorm()),
          .held_out = std::max(held_out_share(blocks_of_rows(shapes, measured, blocks)),
                               neighbour_share(few, measured, blocks))};
}

std::optional<std::ptrdiff_t> far_lag(std::span<const double> input_m, std::span<const double> output) {
  const auto size = std::ssize(input_m);
  std::optional<std::ptrdiff_t> best;
  double most = 1.0 - tuning::kPartialLeaves;
  for (std::ptrdiff_t lag = -size / 4; lag <= size / 4; ++lag) {
    const std::ptrdiff_t count = size - std::abs(lag);
    const VectorXd in = as_vector(input_m).segment(std::max<std::ptrdiff_t>(0, -lag), count);
    const VectorXd out = as_vector(output).segment(std::max<std::ptrdiff_t>(0, lag), count);
    const VectorXd x = in.array() - in.mean();
    const VectorXd y = out.array() - out.mean();
    const double product = x.squaredNorm() * y.squaredNorm();
    const double share = product > 0.0 ? std::pow(x.dot(y), 2) / product : 0.0;
    if (share <= most) continue;
    most = share;
    best = lag;
  }
  return best;
}

Sense sense_of(std::span<const double> predicted, std::span<const double> output,
               std::span<const double> acceleration) {
  const VectorXd model = as_vector(predicted);
  Eigen::Vector2d found = Eigen::Vector2d::Zero();
  const auto left_by = [&](const VectorXd& shape) {
    MatrixXd columns(model.size(), 2);
    columns << shape, change_of(model);
    const Rows rows = rows_between(columns, as_vector(output), 0, columns.rows());
    found = coefficients(rows.columns, rows.output);
    return share_left((rows.output - rows.columns * found).squaredNorm(), rows.output.squaredNorm());
  };
  Sense sense;
  if (!acceleration.empty()) sense.mass_leaves = left_by(as_vector(acceleration));
  sense.leaves = left_by(model);
  sense.slope = found[0];
  sense.shift = found[0] != 0.0 ? -found[1] / found[0] : 0.0;
  const Rows both = rows_between(model, as_vector(output), 0, model.size());
  const double product = both.columns.norm() * both.output.norm();
  sense.correlation = product > 0.0 ? both.columns.col(0).dot(both.output) / product : 0.0;
  return sense;
}

double work_share(std::span<const double> displacement_m, std::span<const double> force_n) {
  double work = 0.0;
  double most = 0.0;
  for (std::size_t i = 1; i < displacement_m.size(); ++i) {
    const double done = 0.5 * (force_n[i] + force_n[i - 1]) * (displacement_m[i] - displacement_m[i - 1]);
    work += done;
    most += std::abs(done);
  }
  return most > 0.0 ? work / most : 0.0;
}

}  // namespace hybridtest
