#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "diagnosis/identification/problem.hpp"
#include "diagnosis/identification/search_range.hpp"

namespace hybridtest {

/// Residual of effects at given places of their searched parameters, what is linear solved for.
/// Rows: the averaged samples of the touched segments, one segment behind the other, weighted.
struct Projected {
  Eigen::VectorXd residual;
  Eigen::MatrixXd columns;       // of the linear parameters, then of the nuisances
  Eigen::VectorXd coefficients;  // likewise; linear ones in their `unit`
  std::vector<bool> held;        // likewise: at the end of what the parameter may be
};

class VariableProjection {
 public:
  /// Of a coefficient.
  struct Bounds {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
  };

  VariableProjection(const IdentificationProblem& problem, SearchPlan plan, bool with_nuisance);

  /// @param places   of the searched parameters, 0 to 1.
  /// @throws ConfigError for parameters that an effect refuses.
  [[nodiscard]] Projected solve(const Eigen::VectorXd& places) const;
  /// The weighted prediction with the linear parameters fixed.
  [[nodiscard]] Eigen::VectorXd predicted(const Eigen::VectorXd& places, const Projected& solution) const;
  /// The effects at a solution, in their own units.
  [[nodiscard]] std::vector<EffectSetting> settings(const Eigen::VectorXd& places, const Projected& solution) const;

  [[nodiscard]] const SearchPlan& plan() const noexcept { return plan_; }
  /// Positions in the problem of the segments that the rows stand for, and where each one's rows begin.
  [[nodiscard]] const std::vector<std::size_t>& touched() const noexcept { return touched_; }
  [[nodiscard]] Eigen::Index first_row(std::size_t touched) const noexcept { return first_rows_[touched]; }
  [[nodiscard]] Eigen::Index rows() const noexcept { return first_rows_.back(); }

 private:
  /// For effects that are not linear together, as a force gain behind a friction or a play that the force opens:
  /// Gauss-Newton steps from a solution that took them to be, the residual that of their prediction.
  [[nodiscard]] Projected relinearised(const Eigen::VectorXd& places, Projected solution,
                                       const std::vector<Bounds>& bounds) const;
  [[nodiscard]] std::vector<EffectSetting> searched_at(const Eigen::VectorXd& places) const;
  [[nodiscard]] Eigen::VectorXd stacked(const std::vector<EffectSetting>& effects) const;

  const IdentificationProblem& problem_;
  SearchPlan plan_;
  std::vector<std::size_t> touched_;
  std::vector<Eigen::Index> first_rows_;  // one more than touched segments
  Eigen::VectorXd measured_;
  Eigen::VectorXd baseline_;
  Eigen::MatrixXd nuisance_;
};

}  // namespace hybridtest
