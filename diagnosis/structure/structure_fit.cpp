#include "diagnosis/structure/structure_fit.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "core/assert.hpp"
#include "diagnosis/identification/search_table.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {
namespace {

constexpr int kIterations = 12;
constexpr int kHalvings = 8;
constexpr double kDifference = 1e-6;
/// Ratios that change by less are found.
constexpr double kSettled = 1e-12;

const SearchRange& range_of(const FittedRatio& ratio) {
  const EffectType& type = ratio.effect->type();
  HYBRIDTEST_ASSERT(type.parameters.size() == 1);
  const SearchRange* const range = search_range(type, type.parameters.front());
  HYBRIDTEST_ASSERT(range != nullptr);
  return *range;
}

/// The record and what the ratios make of it.
class RatioProblem {
 public:
  RatioProblem(const ComputedStructure& model, const StructureRecording& recording)
      : model_{model}, recording_{recording} {}

  [[nodiscard]] Eigen::VectorXd residual(const StructureFit& at) const {
    return (recomputed_displacement_m(model_, recording_, at.errors()) - recording_.displacement_m).reshaped();
  }
  [[nodiscard]] Eigen::MatrixXd slopes(const StructureFit& at, const Eigen::VectorXd& residual_m) const {
    Eigen::MatrixXd slopes(residual_m.size(), std::ssize(at.ratios));
    for (std::size_t i = 0; i < at.ratios.size(); ++i) {
      StructureFit beside = at;
      beside.ratios[i].value += kDifference;
      slopes.col(static_cast<Eigen::Index>(i)) = (residual(beside) - residual_m) / kDifference;
    }
    return slopes;
  }
  [[nodiscard]] double nrmse_of(const Eigen::VectorXd& residual_m) const {
    const double whole = recording_.displacement_m.norm();
    return whole > 0.0 ? residual_m.norm() / whole : 0.0;
  }
  /// Of the samples of a remainder, how many are worth one: it does not change from step to step.
  [[nodiscard]] double samples_per_independent(Eigen::Index samples) const {
    const double duration_s = recording_.step_s * static_cast<double>(recording_.steps());
    const double independent = tuning::kIndependentPerSecond * duration_s;
    return std::max(1.0, static_cast<double>(samples) / std::max(1.0, independent));
  }

 private:
  const ComputedStructure& model_;
  const StructureRecording& recording_;
};

StructureFit moved(const StructureFit& from, const Eigen::VectorXd& change) {
  StructureFit fit = from;
  for (std::size_t i = 0; i < fit.ratios.size(); ++i) {
    const SearchRange& range = range_of(fit.ratios[i]);
    const double wanted = fit.ratios[i].value + change[static_cast<Eigen::Index>(i)];
    fit.ratios[i].value = std::clamp(wanted, range.low, range.high);
    fit.ratios[i].at_bound = fit.ratios[i].value != wanted;
  }
  return fit;
}

}  // namespace

StructureErrors StructureFit::errors() const {
  StructureErrors errors;
  for (const FittedRatio& ratio : ratios) errors.*(ratio.effect->ratio) = ratio.value;
  return errors;
}

StructureFit fit_structure(const ComputedStructure& model, const StructureRecording& recording,
                           std::vector<FittedRatio> start) {
  const RatioProblem problem{model, recording};
  StructureFit fit{std::move(start), 0.0};
  Eigen::VectorXd residual_m = problem.residual(fit);
  Eigen::MatrixXd slopes;
  for (int i = 0; i < kIterations && !fit.ratios.empty(); ++i) {
    slopes = problem.slopes(fit, residual_m);
    Eigen::VectorXd change = -slopes.colPivHouseholderQr().solve(residual_m);
    bool descends = false;
    for (int halving = 0; halving < kHalvings && !descends; ++halving, change *= 0.5) {
      const StructureFit next = moved(fit, change);
      const Eigen::VectorXd left_m = problem.residual(next);
      descends = left_m.squaredNorm() < residual_m.squaredNorm();
      if (!descends) continue;
      fit = next;
      residual_m = left_m;
    }
    if (!descends || change.cwiseAbs().maxCoeff() < kSettled) break;
  }
  fit.nrmse = problem.nrmse_of(residual_m);
  if (fit.ratios.empty()) return fit;
  const Eigen::MatrixXd normal = slopes.transpose() * slopes;
  const double variance = residual_m.squaredNorm() / static_cast<double>(residual_m.size()) *
                          problem.samples_per_independent(residual_m.size());
  const Eigen::MatrixXd covariance = variance * normal.completeOrthogonalDecomposition().pseudoInverse();
  for (std::size_t i = 0; i < fit.ratios.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    fit.ratios[i].standard_error = std::sqrt(std::max(0.0, covariance(at, at)));
  }
  return fit;
}

}  // namespace hybridtest
