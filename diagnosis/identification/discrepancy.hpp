#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace hybridtest {

struct FitSegment;

/// A residual in two parts, told apart on samples that were left out of the regression.
struct ResidualParts {
  Eigen::VectorXd remainder;    // of every sample when it is left out: no function of these features explains it
  double repeatable = 0.0;      // mean square that the features explain there, in squares of the residual's unit
  double standard_error = 0.0;  // of `repeatable`, of noise with the autocovariance of the remainder
  double total = 0.0;           // mean square of the residual
  [[nodiscard]] double share() const noexcept { return total > 0.0 ? repeatable / total : 0.0; }
};

/// What of a residual follows from the motion at all, whatever the effect: a ridge regression on features of the
/// segment's input that repeat when the motion does. Features: polynomials of displacement, velocity and acceleration,
/// the direction of motion, play operators of several widths (Brokate and Sprekels, Hysteresis and Phase Transitions,
/// 1996), earlier and filtered motion, the largest displacement so far, the model's own prediction, and the first of
/// these again in every quarter of the travelled path.
///
/// It is a ceiling for all candidates and never a name. The folds are cycles: each is left out and predicted from the
/// others (exactly, by the normal equations), so that noise that is independent of the motion is not explained, up to
/// the standard error. Of three sets of features and several penalties the one counts whose explained energy, minus its
/// standard error, is largest; with none above zero nothing is repeatable.
class Discrepancy {
 public:
  explicit Discrepancy(const FitSegment& fit);

  /// @param residual   in the averaged samples of the segment, unweighted.
  [[nodiscard]] ResidualParts parts(const Eigen::VectorXd& residual) const;

  /// Mean square of a residual that repeats, by all features and the middle penalty; 0: nothing is seen to.
  [[nodiscard]] double repeatable(const Eigen::VectorXd& residual) const;

  /// How a misfit that repeats may pull at numbers that are weighted sums of the residual: each feature may hold as
  /// much of its energy as all do on average, and pulls by its product with their weights.
  /// @param energy    mean square of the misfit.
  /// @param weights   one column per number, one row per averaged sample.
  /// @return one row per feature, one column per number: R' R is their covariance.
  [[nodiscard]] Eigen::MatrixXd pull(double energy, const Eigen::MatrixXd& weights) const;

 private:
  /// Of several remainders the one whose gain, minus its error, is largest; the residual itself if none counts.
  [[nodiscard]] static ResidualParts best_of(const Eigen::VectorXd& residual, std::vector<Eigen::VectorXd> remainders);
  /// The residual minus what the features explain of it, every fold left out once.
  [[nodiscard]] Eigen::VectorXd left_out(const Eigen::VectorXd& residual, Eigen::Index columns, double ridge) const;

  Eigen::MatrixXd features_;                // scaled to a mean square of one
  std::vector<Eigen::Index> sets_;          // sizes of the nested sets
  std::vector<Eigen::Index> piece_begins_;  // pieces of about a cycle; piece i belongs to fold i mod folds_
  std::size_t folds_ = 0;
  std::vector<Eigen::MatrixXd> fold_normals_;
  Eigen::MatrixXd normal_;
};

}  // namespace hybridtest
