#pragma once

#include <Eigen/Core>

#include "mechanics/structure/linear_structure.hpp"

namespace hybridtest {

/// Undamped free vibration of a structure with its initial stiffness, lowest frequency first.
struct VibrationModes {
  Eigen::VectorXd frequency_rad_per_s;   // of each mode; 0 for a motion without stiffness
  Eigen::MatrixXd shapes;                // one column per mode, phi^T M phi = 1, largest entry positive [1/sqrt(kg)]
  Eigen::VectorXd participation_factor;  // phi^T M iota [sqrt(kg)]
  Eigen::VectorXd effective_mass_kg;     // participation factor squared; sums to iota^T M iota

  [[nodiscard]] Eigen::Index count() const noexcept { return frequency_rad_per_s.size(); }
  /// Infinite for a motion without stiffness.
  [[nodiscard]] double period_s(Eigen::Index mode) const noexcept;
  [[nodiscard]] double highest_frequency_rad_per_s() const noexcept;
};

/// Solves K phi = omega^2 M phi densely (Cholesky of M, then tridiagonal QL; Golub and Van Loan,
/// Matrix Computations, section 8.7): milliseconds for tens of degrees of freedom, seconds for
/// a thousand.
/// @throws ConfigError as require_consistent(), and when the stiffness is negative in some motion.
[[nodiscard]] VibrationModes vibration_modes(const LinearStructure& structure);

}  // namespace hybridtest
