#include "mechanics/structure/vibration_modes.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "core/config_error.hpp"

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

}  // namespace

double VibrationModes::period_s(Eigen::Index mode) const noexcept {
  const double omega = frequency_rad_per_s[mode];
  return omega > 0.0 ? 2.0 * std::numbers::pi / omega : std::numeric_limits<double>::infinity();
}

double VibrationModes::highest_frequency_rad_per_s() const noexcept { return frequency_rad_per_s[count() - 1]; }

VibrationModes vibration_modes(const LinearStructure& structure) {
  require_consistent(structure);
  const Eigen::MatrixXd mass{structure.mass_kg};
  const Eigen::MatrixXd stiffness{structure.initial_stiffness_n_per_m};
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solution{stiffness, mass};
  if (solution.info() != Eigen::Success) throw ConfigError{"the vibration modes of the structure do not converge"};

  VibrationModes modes;
  modes.frequency_rad_per_s.resize(structure.size());
  modes.shapes = solution.eigenvectors();
  const double largest = solution.eigenvalues().cwiseAbs().maxCoeff();
  for (Eigen::Index mode = 0; mode < modes.count(); ++mode) {
    modes.frequency_rad_per_s[mode] = frequency(solution.eigenvalues()[mode], largest);
    Eigen::Index peak = 0;
    modes.shapes.col(mode).cwiseAbs().maxCoeff(&peak);
    if (modes.shapes(peak, mode) < 0.0) modes.shapes.col(mode) *= -1.0;
  }
  modes.participation_factor = modes.shapes.transpose() * (mass * structure.influence);
  modes.effective_mass_kg = modes.participation_factor.cwiseAbs2();
  return modes;
}

}  // namespace hybridtest
