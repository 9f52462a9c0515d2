#pragma once

#include <Eigen/Core>

#include "mechanics/structure/linear_structure.hpp"

namespace hybridtest {

/// Undamped free vibration of a structure with its initial stiffness, lowest frequency first.
struct VibrationModes {
  Eigen::VectorXd frequency_rad_per_s;   // of each mode; 0 for a motion without stiffness
  Eigen::MatrixXd shapes;                // one column per mode, phi^T M phi = 1, largest entry positive [1/sqrt(kg)]
  Eigen::VectorXd participation_factor;  // phi^T M iota [sqrt(kg)]
  Eigen::VectorXd effective_mass_kg;     // participation factor squared; of all modes sums to iota^T M iota
  double highest_rad_per_s = 0.0;        // of the whole structure, also when that mode is not among these

  [[nodiscard]] Eigen::Index count() const noexcept { return frequency_rad_per_s.size(); }
  /// Infinite for a motion without stiffness.
  [[nodiscard]] double period_s(Eigen::Index mode) const noexcept;
  [[nodiscard]] double highest_frequency_rad_per_s() const noexcept { return highest_rad_per_s; }
};

/// Up to this size all modes are computed.
inline constexpr Eigen::Index kAllModesSizeMax = 400;
/// Of a larger structure, those asked for, at most so many.
inline constexpr Eigen::Index kLowestModesMax = 200;
/// And when nobody asks for more.
inline constexpr Eigen::Index kLowestModes = 10;

/// Solves K phi = omega^2 M phi. Up to kAllModesSizeMax degrees of freedom for all modes, densely (Cholesky of M, then
/// tridiagonal QL; Golub and Van Loan, Matrix Computations, section 8.7). Of a larger structure for the lowest ones,
/// by Lanczos on the sparse matrices; its highest frequency is then a bound from above, at most 1e-3 too high.
/// @param lowest   modes of a large structure, 0 to kLowestModesMax.
/// @throws ConfigError as require_consistent(), for more modes than that, and when the stiffness is negative in some
///         motion.
[[nodiscard]] VibrationModes vibration_modes(const LinearStructure& structure, Eigen::Index lowest = kLowestModes);

}  // namespace hybridtest
