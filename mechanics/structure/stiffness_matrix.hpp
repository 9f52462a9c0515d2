#pragma once

#include <Eigen/Core>

#include "core/interface_vector.hpp"

namespace hybridtest {

/// Of the largest entry. Matrices assembled in different orders differ by rounding; more than this is a mistake.
inline constexpr double kSymmetryTolerance = 1e-9;

/// Hands a full stiffness on once it can be that of an elastic body: square with 1 to
/// kMaxInterfaceDofs rows, finite, and symmetric to 1e-9 of its largest entry; what asymmetry
/// the digits of a file leave is averaged out, so that the forces conserve energy.
/// @throws ConfigError naming the rows and columns (counted from 1) and what was expected.
[[nodiscard]] InterfaceMatrix checked_stiffness(const Eigen::MatrixXd& stiffness_n_per_m);

}  // namespace hybridtest
