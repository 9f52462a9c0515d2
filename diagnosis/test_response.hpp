#pragma once

#include <Eigen/Core>

namespace hybridtest {

/// Response of the structure in a whole hybrid test: one row per degree of freedom, one column per step.
/// Displacements, velocities and forces are positive the same way, velocities per second of model time.
struct TestResponse {
  double step_s = 0.0;
  Eigen::MatrixXd displacement_m;
  Eigen::MatrixXd velocity_m_per_s;
  Eigen::MatrixXd restoring_force_n;  // of all substructures and of the elastic part
  Eigen::MatrixXd applied_force_n;    // of the ground motion, -M iota a_g

  [[nodiscard]] Eigen::Index steps() const noexcept { return displacement_m.cols(); }
};

/// Difference between two responses, over the steps that both have.
struct ResponseError {
  double nrmse = 0.0;         // of displacement, all degrees of freedom, over that of the recorded one
  double peak_error = 0.0;    // largest of any degree of freedom: |peak - recorded peak| over the recorded peak
  double energy_error = 0.0;  // of the energy in the substructures, over the energy input of the ground motion
};

/// Peaks are of |displacement|. Energies are of velocity times force, by the trapezoidal rule up to the last common
/// step: what the substructures have taken (dissipated, or still hold) against the most that the ground motion of
/// the recorded test had put in (Uang and Bertero, 1990, relative energy). An error over nothing is 0.
/// @param recorded, simulated   of the same degrees of freedom and step.
[[nodiscard]] ResponseError response_error(const TestResponse& recorded, const TestResponse& simulated);

/// Largest |displacement| of each degree of freedom over the first so many steps, at most all [m].
[[nodiscard]] Eigen::VectorXd peaks_m(const TestResponse& response, Eigen::Index steps);
/// What the substructures have taken by the last of these steps [J].
[[nodiscard]] double energy_taken_j(const TestResponse& response, Eigen::Index steps);

}  // namespace hybridtest
