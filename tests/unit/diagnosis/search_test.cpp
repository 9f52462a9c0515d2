#include "diagnosis/identification/search.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "diagnosis/tuning.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

namespace hybridtest {
namespace {

using enum EffectInterface;

/// The force of a damped spring, read a tenth too large.
IdentificationProblem damped_and_too_large() {
  const auto force_n = [](double t) {
    const double velocity_m_per_s = (made_motion_m(t) - made_motion_m(t - 1e-4)) / 1e-4;
    return 1.1 * (kMadeStiffness_n_per_m * made_motion_m(t) + 6.0e4 * velocity_m_per_s);
  };
  return make_problem(made_model(), segments_of(made_recording(made_motion_m, force_n), 0, 0));
}

/// A lag of the load cell is searched, its time constant and its shape; viscous damping and the cell's gain are linear,
/// though not together.
VariableProjection of_lag_damping_and_gain(const IdentificationProblem& problem) {
  return {problem,
          plan_search(problem, {find_effect(force_sensor, "lag"), find_effect(specimen, "viscous_damping"),
                                find_effect(force_sensor, "gain")}),
          false};
}

TEST(VariableProjection, SlopesGiveTheGradientOfTheCost) {
  const IdentificationProblem problem = damped_and_too_large();
  const VariableProjection projection = of_lag_damping_and_gain(problem);
  ASSERT_EQ(projection.plan().searched.size(), 2U);
  const double step = tuning::kResolution;
  for (const Eigen::Vector2d& place : {Eigen::Vector2d{0.2, 0.5}, {0.45, 0.2}, {0.8, 0.7}}) {
    const Eigen::VectorXd places = place;
    const Projected solution = projection.solve(places);
    const Eigen::VectorXd gradient = 2.0 * projection.slopes(places, solution).transpose() * solution.residual;
    for (Eigen::Index i = 0; i < 2; ++i) {
      const auto cost_beside = [&](double by) {
        return projection.solve(places + by * Eigen::VectorXd::Unit(2, i)).residual.squaredNorm();
      };
      const double by_cost = (cost_beside(step) - cost_beside(-step)) / (2.0 * step);
      // The linear parameters are settled to a thousandth of the cost, which is the step of the slopes, too.
      EXPECT_NEAR(gradient[i], by_cost, 5.0 * step * std::abs(by_cost)) << places.transpose();
    }
  }
}

TEST(VariableProjection, SlopesLeaveOutWhatTheLinearParametersFollow) {
  const IdentificationProblem problem = damped_and_too_large();
  const VariableProjection projection = of_lag_damping_and_gain(problem);
  const Eigen::VectorXd places = Eigen::Vector2d{0.3, 0.5};
  const Projected solution = projection.solve(places);
  const Eigen::VectorXd slope = projection.slopes(places, solution).col(0);
  // Control: the change of the prediction alone has a large part along the columns.
  Eigen::VectorXd moved = places;
  moved[0] += tuning::kResolution;
  const Eigen::VectorXd whole = projection.predicted(moved, solution) - projection.predicted(places, solution);
  for (Eigen::Index i = 0; i < solution.columns.cols(); ++i) {
    ASSERT_FALSE(solution.held[static_cast<std::size_t>(i)]);
    const Eigen::VectorXd column = solution.columns.col(i).normalized();
    // The ridge of the projection, 1e-10 of the columns, times how nearly they are multiples of each other.
    EXPECT_LT(std::abs(column.dot(slope)), 1e-6 * slope.norm()) << i;
  }
  EXPECT_GT((solution.columns.colwise().normalized().transpose() * whole).cwiseAbs().maxCoeff(), 0.3 * whole.norm());
}

}  // namespace
}  // namespace hybridtest
