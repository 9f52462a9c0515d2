#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "mechanics/structure/linear_structure.hpp"
#include "mechanics/structure/vibration_modes.hpp"

namespace hybridtest {

/// C = a0 M + a1 K, K the initial stiffness.
struct RayleighCoefficients {
  double mass_per_s = 0.0;   // a0
  double stiffness_s = 0.0;  // a1
};

/// Coefficients that give two modes the damping ratio (Chopra, Dynamics of Structures, section
/// 11.4): a0 = ratio 2 wi wj/(wi + wj), a1 = ratio 2/(wi + wj).
/// @param mode_a, mode_b   numbers from 1, lowest frequency first; two different frequencies
///                         greater than 0.
/// @throws ConfigError for modes that the structure does not have or that are no such pair, and
///         for a ratio outside [0, 1).
[[nodiscard]] RayleighCoefficients rayleigh_coefficients(double ratio, int mode_a, int mode_b,
                                                         const VibrationModes& modes);

/// @throws ConfigError for a coefficient that is negative or not finite.
[[nodiscard]] Eigen::SparseMatrix<double> rayleigh_damping(const LinearStructure& structure,
                                                           const RayleighCoefficients& coefficients);

/// Modal damping of a larger structure would take the memory and the time of a full matrix.
inline constexpr Eigen::Index kFullDampingSizeMax = 2000;

/// C = M (sum over modes of 2 ratio omega phi phi^T) M: that ratio in each mode, in general full
/// (Chopra, section 11.4).
/// @param ratios   one per mode from the lowest on, in [0, 1); modes beyond the last are undamped.
/// @throws ConfigError for ratios out of range, none, or more of them than modes, and for a structure of more than
///         kFullDampingSizeMax degrees of freedom.
[[nodiscard]] Eigen::SparseMatrix<double> modal_damping(const LinearStructure& structure, const VibrationModes& modes,
                                                        const Eigen::VectorXd& ratios);

/// Of each mode, phi^T C phi / (2 omega), which for damping that couples the modes is the
/// diagonal part; 0 for a motion without stiffness.
[[nodiscard]] Eigen::VectorXd damping_ratios(const LinearStructure& structure, const VibrationModes& modes);

}  // namespace hybridtest
