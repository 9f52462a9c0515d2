#include "mechanics/structure/damping.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

/// Closer frequencies are one: their two equations for a0 and a1 are the same.
constexpr double kEqualFrequencies = 1e-9;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

void require_ratio(double ratio) {
  if (ratio >= 0.0 && ratio < 1.0) return;
  throw ConfigError{"the damping ratio is " + number(ratio) + ", expected a number from 0 to below 1, such as 0.02"};
}

double frequency_of(int mode, const VibrationModes& modes) {
  if (mode < 1 || mode > modes.count()) {
    throw ConfigError{"Rayleigh damping is asked for mode " + std::to_string(mode) + ", expected a mode from 1 to " +
                      std::to_string(modes.count()) + ", as many as the structure has degrees of freedom"};
  }
  const double omega = modes.frequency_rad_per_s[mode - 1];
  if (omega > 0.0) return omega;
  throw ConfigError{"Rayleigh damping is asked for mode " + std::to_string(mode) +
                    ", which has no stiffness; expected a mode with a frequency above 0"};
}

}  // namespace

RayleighCoefficients rayleigh_coefficients(double ratio, int mode_a, int mode_b, const VibrationModes& modes) {
  require_ratio(ratio);
  const double omega_a = frequency_of(mode_a, modes);
  const double omega_b = frequency_of(mode_b, modes);
  if (std::abs(omega_a - omega_b) <= kEqualFrequencies * std::max(omega_a, omega_b)) {
    throw ConfigError{"Rayleigh damping is asked for modes " + std::to_string(mode_a) + " and " +
                      std::to_string(mode_b) + ", both of " + number(omega_a) +
                      " rad/s; expected two modes of different frequency, or give the coefficients themselves"};
  }
  const double factor = 2.0 * ratio / (omega_a + omega_b);
  return {.mass_per_s = factor * omega_a * omega_b, .stiffness_s = factor};
}

Eigen::SparseMatrix<double> rayleigh_damping(const LinearStructure& structure,
                                             const RayleighCoefficients& coefficients) {
  for (const double coefficient : {coefficients.mass_per_s, coefficients.stiffness_s}) {
    if (std::isfinite(coefficient) && coefficient >= 0.0) continue;
    throw ConfigError{"a Rayleigh damping coefficient is " + number(coefficient) + ", expected a number not below 0"};
  }
  Eigen::SparseMatrix<double> damping =
      coefficients.mass_per_s * structure.mass_kg + coefficients.stiffness_s * structure.initial_stiffness_n_per_m;
  damping.makeCompressed();
  return damping;
}

Eigen::SparseMatrix<double> modal_damping(const LinearStructure& structure, const VibrationModes& modes,
                                          const Eigen::VectorXd& ratios) {
  if (ratios.size() == 0 || ratios.size() > modes.count()) {
    throw ConfigError{"modal damping has " + std::to_string(ratios.size()) + " ratios, expected from 1 to " +
                      std::to_string(modes.count()) + ", at most one per mode"};
  }
  if (structure.size() > kFullDampingSizeMax) {
    throw ConfigError{"modal damping makes a full matrix, and the structure has " + std::to_string(structure.size()) +
                      " degrees of freedom; expected at most " + std::to_string(kFullDampingSizeMax) +
                      ", or Rayleigh damping"};
  }
  for (const double ratio : ratios) require_ratio(ratio);
  const auto damped = ratios.size();
  const Eigen::VectorXd weights = 2.0 * ratios.cwiseProduct(modes.frequency_rad_per_s.head(damped));
  const Eigen::MatrixXd inertia = structure.mass_kg * modes.shapes.leftCols(damped);
  const Eigen::MatrixXd damping = inertia * weights.asDiagonal() * inertia.transpose();
  // The product rounds differently on both sides of the diagonal; the factorisation wants them equal.
  return (0.5 * (damping + damping.transpose())).sparseView();
}

Eigen::VectorXd damping_ratios(const LinearStructure& structure, const VibrationModes& modes) {
  Eigen::VectorXd ratios = Eigen::VectorXd::Zero(modes.count());
  for (Eigen::Index mode = 0; mode < modes.count(); ++mode) {
    const double omega = modes.frequency_rad_per_s[mode];
    if (omega <= 0.0) continue;
    ratios[mode] = modes.shapes.col(mode).dot(structure.damping_n_s_per_m * modes.shapes.col(mode)) / (2.0 * omega);
  }
  return ratios;
}

}  // namespace hybridtest
