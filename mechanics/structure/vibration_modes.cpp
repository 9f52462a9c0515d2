#include "mechanics/structure/vibration_modes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "core/config_error.hpp"
#include "mechanics/structure/sparse_modes.hpp"

namespace hybridtest {
namespace {

/// Eigenvalues this far below the largest, relative to it, are rounding of zero.
constexpr double kZeroTolerance = 1e-12;

double frequency(double eigenvalue, double largest) {
  if (eigenvalue < -kZeroTolerance * largest) {
    throw ConfigError{
        "the structure's initial stiffness is negative in some motion (omega^2 = " + std::to_string(eigenvalue) +
        " 1/s^2): it falls over by itself; check the signs of the stiffnesses"};
  }
  return eigenvalue <= kZeroTolerance * largest ? 0.0 : std::sqrt(eigenvalue);
}

/// From eigenvalues and shapes, lowest first.
VibrationModes modes_of(const Eigen::VectorXd& eigenvalues, Eigen::MatrixXd shapes, double largest) {
  VibrationModes modes;
  modes.frequency_rad_per_s.resize(eigenvalues.size());
  modes.shapes = std::move(shapes);
  for (Eigen::Index mode = 0; mode < modes.count(); ++mode) {
    modes.frequency_rad_per_s[mode] = frequency(eigenvalues[mode], largest);
    Eigen::Index peak = 0;
    modes.shapes.col(mode).cwiseAbs().maxCoeff(&peak);
    if (modes.shapes(peak, mode) < 0.0) modes.shapes.col(mode) *= -1.0;
  }
  modes.highest_rad_per_s = std::sqrt(std::max(largest, 0.0));
  return modes;
}

VibrationModes all_modes(const LinearStructure& structure) {
  const Eigen::MatrixXd mass{structure.mass_kg};
  const Eigen::MatrixXd stiffness{structure.initial_stiffness_n_per_m};
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solution{stiffness, mass};
  if (solution.info() != Eigen::Success) throw ConfigError{"the vibration modes of the structure do not converge"};
  const double largest = solution.eigenvalues().cwiseAbs().maxCoeff();
  VibrationModes modes = modes_of(solution.eigenvalues(), solution.eigenvectors(), largest);
  modes.highest_rad_per_s = modes.frequency_rad_per_s[modes.count() - 1];
  modes.participation_factor = modes.shapes.transpose() * (mass * structure.influence);
  modes.effective_mass_kg = modes.participation_factor.cwiseAbs2();
  return modes;
}

VibrationModes lowest_modes(const LinearStructure& structure, Eigen::Index lowest) {
  if (lowest > kLowestModesMax) {
    throw ConfigError{"mode " + std::to_string(lowest) + " of a structure of " + std::to_string(structure.size()) +
                      " degrees of freedom is asked for; expected one of the lowest " +
                      std::to_string(kLowestModesMax) + " of a structure of more than " +
                      std::to_string(kAllModesSizeMax)};
  }
  const double largest = largest_eigenvalue(structure.initial_stiffness_n_per_m, structure.mass_kg);
  // At least one, so that a negative stiffness is found.
  const Eigenpairs pairs = lowest_eigenpairs(structure.initial_stiffness_n_per_m, structure.mass_kg,
                                             std::max<Eigen::Index>(lowest, 1), largest);
  VibrationModes modes = modes_of(pairs.values, pairs.vectors, largest);
  modes.participation_factor = modes.shapes.transpose() * (structure.mass_kg * structure.influence);
  modes.effective_mass_kg = modes.participation_factor.cwiseAbs2();
  return modes;
}

}  // namespace

double VibrationModes::period_s(Eigen::Index mode) const noexcept {
  const double omega = frequency_rad_per_s[mode];
  return omega > 0.0 ? 2.0 * std::numbers::pi / omega : std::numeric_limits<double>::infinity();
}

VibrationModes vibration_modes(const LinearStructure& structure, Eigen::Index lowest) {
  require_consistent(structure);
  return structure.size() <= kAllModesSizeMax ? all_modes(structure) : lowest_modes(structure, lowest);
}

}  // namespace hybridtest
