#pragma once

#include <Eigen/SparseCore>
#include <utility>
#include <vector>

#include "mechanics/structure/linear_structure.hpp"

namespace hybridtest {

/// u_dof = sum of factor u_other: a degree of freedom that others carry along, such as a floor that is rigid.
struct RigidConstraint {
  Eigen::Index dof = 0;
  std::vector<std::pair<Eigen::Index, double>> follows;  // degree of freedom and factor, at least one
};

/// A structure of fewer degrees of freedom that moves as the given one.
struct ReducedStructure {
  LinearStructure structure;       // of the kept degrees of freedom, in order; influence of the given one at those
  std::vector<Eigen::Index> kept;  // their rows in the given structure
};

/// u = T q: the motion of all degrees of freedom by that of those without a constraint (Cook, Malkus, Plesha and Witt,
/// Concepts and Applications of Finite Element Analysis, 2002, section 13.2). M, C and K become T^T M T and so on.
/// @throws ConfigError naming a degree of freedom with two constraints, or that follows itself or another one with a
///         constraint.
[[nodiscard]] ReducedStructure with_constraints(const LinearStructure& given,
                                                const std::vector<RigidConstraint>& constraints);

/// Most entries that the stiffness may get: 160 MB, and 10 ms a step.
inline constexpr Eigen::Index kCondensedEntriesMax = 10'000'000;

/// Static condensation of the degrees of freedom without mass, u_s = -K_ss^-1 K_sr u_r, which is exact for them
/// (Guyan, AIAA Journal, 1965): K* = K_rr - K_rs K_ss^-1 K_sr, over the rest. K* is full where the rest is connected
/// by them. A structure that has mass everywhere is returned as it is.
/// @throws ConfigError naming what is wrong: a degree of freedom without mass that has mass coupled to others or
///         damping of its own, or that nothing holds; matrices that are not symmetric; more entries than
///         kCondensedEntriesMax.
[[nodiscard]] ReducedStructure without_massless(const LinearStructure& given);

}  // namespace hybridtest
