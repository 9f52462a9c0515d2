#include "diagnosis/identification/discrepancy.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "diagnosis/identification/coloured_noise.hpp"
#include "diagnosis/identification/problem.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {
namespace {

using Column = Eigen::ArrayXd;

double level_of(const Column& values) { return std::sqrt(values.square().mean()); }

/// Motion of a segment in averaged samples, each over its own level; a signal that is zero stays so.
struct ScaledMotion {
  Column displacement;
  Column velocity;
  Column acceleration;
};

Column averaged_of(const FitSegment& fit, const std::vector<Motion>& motion, double Motion::*channel) {
  std::vector<double> values(motion.size());
  std::ranges::transform(motion, values.begin(), [channel](const Motion& at) { return at.*channel; });
  return fit.average(values).array();
}

/// A play operator: follows the displacement behind a clearance of `half_width` each way.
Column play(const Column& displacement, double half_width) {
  Column result(displacement.size());
  double place = displacement.size() > 0 ? displacement[0] : 0.0;
  for (Eigen::Index i = 0; i < displacement.size(); ++i) {
    place = std::clamp(place, displacement[i] - half_width, displacement[i] + half_width);
    result[i] = place;
  }
  return result;
}

Column delayed(const Column& values, Eigen::Index samples) {
  Column result(values.size());
  for (Eigen::Index i = 0; i < values.size(); ++i) result[i] = values[std::max<Eigen::Index>(0, i - samples)];
  return result;
}

Column filtered(const Column& values, double samples) {
  Column result(values.size());
  double state = 0.0;
  for (Eigen::Index i = 0; i < values.size(); ++i) result[i] = state += (values[i] - state) / (1.0 + samples);
  return result;
}

/// Sum of the motion either way, from 0 to 1 over the record.
Column travelled(const Column& displacement) {
  Column path = Column::Zero(displacement.size());
  for (Eigen::Index i = 1; i < path.size(); ++i)
    path[i] = path[i - 1] + std::abs(displacement[i] - displacement[i - 1]);
  const double whole = path.size() > 0 ? path[path.size() - 1] : 0.0;
  return whole > 0.0 ? Column{path / whole} : path;
}

Column largest_so_far(const Column& values) {
  Column result(values.size());
  double largest = 0.0;
  for (Eigen::Index i = 0; i < values.size(); ++i) result[i] = largest = std::max(largest, std::abs(values[i]));
  return result;
}

/// Hats side by side over the range of values, of which the two outermost are left out: with a constant and the values
/// themselves these add up to them.
std::vector<Column> hats_over(const Column& values, std::size_t knots) {
  const double low = values.minCoeff();
  const double spacing = (values.maxCoeff() - low) / static_cast<double>(knots - 1);
  std::vector<Column> hats;
  for (std::size_t knot = 1; knot + 1 < knots && spacing > 0.0; ++knot) {
    hats.emplace_back((1.0 - ((values - low) / spacing - static_cast<double>(knot)).abs()).max(0.0));
  }
  return hats;
}

/// Inputs beside the motion in averaged samples, each from its mean and over its own level; those that never change
/// left out.
std::vector<Column> scaled_inputs(const FitSegment& fit) {
  const InputTable& inputs = fit.segment.inputs;
  std::vector<Column> scaled;
  for (std::size_t column = 0; column < inputs.names.size(); ++column) {
    std::vector<double> values(fit.segment.input.size());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = inputs.at(i)[column];
    if (std::ranges::count(values, values.front()) == static_cast<std::ptrdiff_t>(values.size())) continue;
    Column input = fit.average(values).array();
    input -= input.mean();
    const double level = level_of(input);
    if (level > 0.0) scaled.emplace_back(input / level);
  }
  return scaled;
}

/// The features in three nested sets.
struct FeatureSets {
  std::vector<Column> columns;
  std::vector<std::size_t> ends;
};

FeatureSets features_of(const ScaledMotion& motion, const std::vector<Column>& of_model,
                        const std::vector<Column>& inputs) {
  const Column& x = motion.displacement;
  const Column& v = motion.velocity;
  const Column direction = v / (v.square() + tuning::kDirectionWidth * tuning::kDirectionWidth).sqrt();
  const Column path = travelled(x);
  FeatureSets sets;
  std::vector<Column>& all = sets.columns;
  all = of_model;
  for (const Column& column : {x, v, motion.acceleration, direction}) all.push_back(column);
  all.push_back(Column::Ones(x.size()));
  const std::vector<Column> first{x, v, direction, of_model.empty() ? x : of_model.front()};
  sets.ends.push_back(all.size());
  const double span = x.size() > 0 ? x.abs().maxCoeff() : 0.0;
  std::vector<Column> plays;
  for (const double width : tuning::kPlayWidths) plays.push_back(play(x, width * span));
  for (const Column& column : plays) all.push_back(column);
  for (const Column& column :
       {Column{x.square()}, Column{x.cube()}, Column{x * x.abs()}, Column{v * v.abs()}, Column{v.abs()}, Column{x * v},
        Column{x.abs() * v}, Column{x.abs() * direction}, Column{x * direction}, Column{x.square() * v}}) {
    all.push_back(column);
  }
  const double samples = static_cast<double>(x.size());
  for (const double lag : tuning::kLags_samples) {
    if (4.0 * lag > samples) break;
    all.push_back(delayed(x, static_cast<Eigen::Index>(lag)) - x);
    all.push_back(delayed(direction, static_cast<Eigen::Index>(lag)) - direction);
    all.push_back(filtered(v, 4.0 * lag));
  }
  for (const Column* const values : {&x, &v}) {
    const std::vector<Column> hats = hats_over(*values, tuning::kMotionKnots);
    all.insert(all.end(), hats.begin(), hats.end());
  }
  const Column largest = largest_so_far(x);
  all.push_back(largest);
  all.push_back(x * largest);
  for (const Column& input : inputs) {
    for (const Column& column : first) all.push_back(input * column);
  }
  sets.ends.push_back(all.size());
  for (const Column& hat : hats_over(path, tuning::kPathKnots)) {
    for (const Column& column : first) all.push_back(hat * column);
    all.push_back(hat * plays[plays.size() / 2]);
  }
  for (const Column& column : first) all.push_back(path * column);
  all.push_back(Column::LinSpaced(x.size(), 0.0, 1.0));
  sets.ends.push_back(all.size());
  return sets;
}

std::vector<Eigen::Index> pieces_of(const Column& displacement, std::size_t most) {
  const double mean = displacement.size() > 0 ? displacement.mean() : 0.0;
  std::size_t cycles = 0;
  for (Eigen::Index i = 1; i < displacement.size(); ++i) {
    if (displacement[i - 1] < mean && displacement[i] >= mean) ++cycles;
  }
  const auto pieces = static_cast<Eigen::Index>(std::clamp(cycles, static_cast<std::size_t>(tuning::kBlocksMin), most));
  std::vector<Eigen::Index> begins;
  for (Eigen::Index piece = 0; piece <= pieces; ++piece) begins.push_back(displacement.size() * piece / pieces);
  return begins;
}

}  // namespace

Discrepancy::Discrepancy(const FitSegment& fit) {
  const auto motion_of = [&](const std::vector<Motion>& motion) {
    return ScaledMotion{averaged_of(fit, motion, &Motion::displacement_m),
                        averaged_of(fit, motion, &Motion::velocity_m_per_s),
                        averaged_of(fit, motion, &Motion::acceleration_m_per_s2)};
  };
  ScaledMotion motion = motion_of(fit.segment.input);
  ScaledMotion noise;
  if (!fit.segment.noise.empty()) noise = motion_of(fit.segment.noise);
  const double middle = motion.displacement.size() > 0 ? motion.displacement[0] : 0.0;
  motion.displacement -= middle;
  for (Column ScaledMotion::*channel :
       {&ScaledMotion::displacement, &ScaledMotion::velocity, &ScaledMotion::acceleration}) {
    const double level = level_of(motion.*channel);
    if (level <= 0.0) continue;
    motion.*channel /= level;
    if ((noise.*channel).size() > 0) noise.*channel = motion.*channel + noise.*channel / level;
  }
  std::vector<Column> of_model{fit.baseline.array()};
  for (Eigen::Index i = 0; i < fit.nuisance.cols(); ++i) of_model.emplace_back(fit.nuisance.col(i).array());
  const std::vector<Column> inputs = scaled_inputs(fit);
  const FeatureSets clean = features_of(motion, of_model, inputs);
  const FeatureSets noisy = noise.displacement.size() > 0 ? features_of(noise, of_model, inputs) : FeatureSets{};
  std::vector<Column> kept;
  std::size_t set = 0;
  for (std::size_t i = 0; i < clean.columns.size(); ++i) {
    while (i == clean.ends[set]) {
      sets_.push_back(static_cast<Eigen::Index>(kept.size()));
      ++set;
    }
    const double level = level_of(clean.columns[i]);
    const bool is_noise =
        !noisy.columns.empty() && level_of(noisy.columns[i] - clean.columns[i]) > tuning::kFeatureNoiseMax * level;
    if (level <= 0.0 || !std::isfinite(level) || is_noise) continue;
    kept.push_back(clean.columns[i] / level);
  }
  sets_.push_back(static_cast<Eigen::Index>(kept.size()));
  features_.resize(fit.measured.size(), static_cast<Eigen::Index>(kept.size()));
  for (std::size_t i = 0; i < kept.size(); ++i) features_.col(static_cast<Eigen::Index>(i)) = kept[i].matrix();

  piece_begins_ = pieces_of(motion.displacement, static_cast<std::size_t>(motion.displacement.size()));
  folds_ = std::min(piece_begins_.size() - 1, static_cast<std::size_t>(tuning::kBlocksMax));
  fold_normals_.assign(folds_, Eigen::MatrixXd::Zero(features_.cols(), features_.cols()));
  for (std::size_t piece = 0; piece + 1 < piece_begins_.size(); ++piece) {
    const auto rows = features_.middleRows(piece_begins_[piece], piece_begins_[piece + 1] - piece_begins_[piece]);
    fold_normals_[piece % folds_].selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
  }
  normal_ = std::accumulate(fold_normals_.begin(), fold_normals_.end(),
                            Eigen::MatrixXd{Eigen::MatrixXd::Zero(features_.cols(), features_.cols())});
}

Eigen::VectorXd Discrepancy::left_out(const Eigen::VectorXd& residual, Eigen::Index columns, double ridge) const {
  Eigen::VectorXd remainder = residual;
  const auto used = features_.leftCols(columns);
  const Eigen::VectorXd pull = used.transpose() * residual;
  for (std::size_t fold = 0; fold < folds_; ++fold) {
    Eigen::VectorXd own = Eigen::VectorXd::Zero(columns);
    for (std::size_t piece = fold; piece + 1 < piece_begins_.size(); piece += folds_) {
      const Eigen::Index size = piece_begins_[piece + 1] - piece_begins_[piece];
      own += used.middleRows(piece_begins_[piece], size).transpose() * residual.segment(piece_begins_[piece], size);
    }
    Eigen::MatrixXd rest = (normal_ - fold_normals_[fold]).topLeftCorner(columns, columns);
    rest.diagonal().array() += ridge * static_cast<double>(residual.size());
    const Eigen::VectorXd coefficients = rest.selfadjointView<Eigen::Lower>().llt().solve(pull - own);
    for (std::size_t piece = fold; piece + 1 < piece_begins_.size(); piece += folds_) {
      const Eigen::Index size = piece_begins_[piece + 1] - piece_begins_[piece];
      remainder.segment(piece_begins_[piece], size) -= used.middleRows(piece_begins_[piece], size) * coefficients;
    }
  }
  return remainder;
}

ResidualParts Discrepancy::best_of(const Eigen::VectorXd& residual, std::vector<Eigen::VectorXd> remainders) {
  const auto samples = static_cast<double>(std::max<Eigen::Index>(1, residual.size()));
  const double total = residual.squaredNorm();
  ResidualParts best{.remainder = residual, .total = total / samples};
  // Those that gain most come first: what gains less than the highest so far, without its error, is not asked for it.
  std::ranges::sort(remainders, {}, [](const Eigen::VectorXd& values) { return values.squaredNorm(); });
  const ColouredNoise noise{remainders.front().squaredNorm() < total ? remainders.front() : residual};
  double highest = 0.0;
  for (Eigen::VectorXd& remainder : remainders) {
    const double gain = total - remainder.squaredNorm();
    if (gain <= highest) break;
    const double error = 2.0 * std::sqrt(noise.variances_along(residual - remainder)[0]);
    if (gain - tuning::kTwoSided99 * error <= highest) continue;
    highest = gain - tuning::kTwoSided99 * error;
    best.repeatable = gain / samples;
    best.standard_error = error / samples;
    best.remainder = std::move(remainder);
  }
  return best;
}

ResidualParts Discrepancy::parts(const Eigen::VectorXd& residual) const {
  std::vector<Eigen::VectorXd> remainders;
  for (const Eigen::Index columns : sets_) {
    for (const double ridge : tuning::kRidges) remainders.push_back(left_out(residual, columns, ridge));
  }
  return best_of(residual, std::move(remainders));
}

double Discrepancy::repeatable(const Eigen::VectorXd& residual) const {
  return best_of(residual, {left_out(residual, features_.cols(), tuning::kRidges[tuning::kRidges.size() / 2])})
      .repeatable;
}

Eigen::MatrixXd Discrepancy::pull(double energy, const Eigen::MatrixXd& weights) const {
  if (energy <= 0.0) return Eigen::MatrixXd::Zero(1, weights.cols());
  const double of_each = energy / static_cast<double>(features_.cols());
  return std::sqrt(of_each) * (features_.transpose() * weights);
}

}  // namespace hybridtest
