#pragma once

#include <Eigen/Core>

#include "diagnosis/identification/variable_projection.hpp"

namespace hybridtest {

/// Places of the searched parameters with the least squared residual: from the best few of several
/// starts spread evenly over the range (Halton, 1960), by Ceres' trust region between 0 and 1.
/// @param first   where to look first; empty: nowhere in particular.
/// @param starts  how many of the spread ones to try besides.
[[nodiscard]] Eigen::VectorXd search_best(const VariableProjection& projection, const Eigen::VectorXd& first,
                                          int starts);

/// Starts that fill a range of so many parameters; none for none.
[[nodiscard]] int starts_for(Eigen::Index searched) noexcept;

}  // namespace hybridtest
