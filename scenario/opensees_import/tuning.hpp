#pragma once

#include <Eigen/Core>

namespace hybridtest {

/// Free degrees of freedom of a model that is imported: OpenSees gives its matrices in full, as text.
inline constexpr int kImportedDofsMax = 3000;
/// Modes that are compared.
inline constexpr Eigen::Index kImportedModes = 10;
/// Between an entry and its mirror image, relative to the largest one: OpenSees writes 11 digits.
inline constexpr double kAsymmetryMax = 1e-8;
/// Of the damping that a M + b K does not explain, relative to it: likewise.
inline constexpr double kDampingRest = 1e-8;
/// Lines of the output of OpenSees that an error shows.
inline constexpr std::size_t kImportLines = 8;

}  // namespace hybridtest
