#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "coordinator/integrators/integrator.hpp"

namespace hybridtest {

/// The force of a site that arrives late: K_e u(t - delay), over all degrees of freedom of the structure.
struct DelayedForce {
  Eigen::SparseMatrix<double> stiffness_n_per_m;  // n x n
  double delay_steps = 0.0;                       // in steps of the test; negative: ahead
};

/// Whether a free vibration grows with another stiffness than the integrator knows, or with late forces: steps the
/// integrator after a blow on all degrees of freedom and compares the peaks of two spans of steps, late in the
/// vibration. Growth by less than a ten-thousandth in a step goes unnoticed. Between two steps the motion is taken to
/// be linear.
/// @param integrator          new, at rest.
/// @param stiffness_n_per_m   n x n, of all forces that are in time.
[[nodiscard]] bool free_vibration_grows(Integrator& integrator, const Eigen::SparseMatrix<double>& stiffness_n_per_m,
                                        const std::vector<DelayedForce>& delayed = {});

}  // namespace hybridtest
