#include "diagnosis/test_response.hpp"

#include <algorithm>
#include <cmath>

#include "core/assert.hpp"

namespace hybridtest {

namespace {

struct Work {
  double last_j = 0.0;     // at the last step
  double largest_j = 0.0;  // that it ever reached
};

/// Of forces along velocities, over the first so many steps.
Work work_of(const Eigen::MatrixXd& force_n, const Eigen::MatrixXd& velocity_m_per_s, Eigen::Index steps,
             double step_s) {
  const Eigen::VectorXd power_w =
      (force_n.leftCols(steps).array() * velocity_m_per_s.leftCols(steps).array()).colwise().sum();
  Work work;
  for (Eigen::Index i = 1; i < steps; ++i) {
    work.last_j += 0.5 * step_s * (power_w[i - 1] + power_w[i]);
    work.largest_j = std::max(work.largest_j, work.last_j);
  }
  return work;
}

double over(double error, double whole) noexcept { return whole > 0.0 ? error / whole : 0.0; }

}  // namespace

Eigen::VectorXd peaks_m(const TestResponse& response, Eigen::Index steps) {
  const Eigen::Index kept = std::min(steps, response.steps());
  if (kept == 0) return Eigen::VectorXd::Zero(response.displacement_m.rows());
  return response.displacement_m.leftCols(kept).cwiseAbs().rowwise().maxCoeff();
}

double energy_taken_j(const TestResponse& response, Eigen::Index steps) {
  return work_of(response.restoring_force_n, response.velocity_m_per_s, std::min(steps, response.steps()),
                 response.step_s)
      .last_j;
}

ResponseError response_error(const TestResponse& recorded, const TestResponse& simulated) {
  HYBRIDTEST_ASSERT(recorded.displacement_m.rows() == simulated.displacement_m.rows());
  const Eigen::Index steps = std::min(recorded.steps(), simulated.steps());
  const auto real_m = recorded.displacement_m.leftCols(steps);
  const auto model_m = simulated.displacement_m.leftCols(steps);
  ResponseError error;
  error.nrmse = over((model_m - real_m).norm(), real_m.norm());
  const Eigen::VectorXd real_peaks_m = peaks_m(recorded, steps);
  const Eigen::VectorXd model_peaks_m = peaks_m(simulated, steps);
  for (Eigen::Index dof = 0; dof < real_peaks_m.size(); ++dof) {
    const double off_m = std::abs(model_peaks_m[dof] - real_peaks_m[dof]);
    error.peak_error = std::max(error.peak_error, over(off_m, real_peaks_m[dof]));
  }
  const double put_in_j =
      work_of(recorded.applied_force_n, recorded.velocity_m_per_s, steps, recorded.step_s).largest_j;
  error.energy_error = over(std::abs(energy_taken_j(simulated, steps) - energy_taken_j(recorded, steps)), put_in_j);
  return error;
}

}  // namespace hybridtest
