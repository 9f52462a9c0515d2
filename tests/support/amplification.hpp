#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <complex>
#include <functional>
#include <memory>

#include "coordinator/integrators/integrator.hpp"
#include "tests/support/structures.hpp"

/// Roots of an integrator's amplification matrix, measured by stepping it.
namespace hybridtest::test {

/// One mode of mass 1 kg with omega = 1 rad/s, so that the step is omega dt.
struct MeasuredMode {
  double omega_dt = 0.0;  // of a step of the test; a step of the method may have several
  double damping_ratio = 0.0;
  double stiffness_ratio = 1.0;  // that the method meets, over the initial stiffness that it knows
};

using MakeIntegrator = std::function<std::unique_ptr<Integrator>(const LinearStructure& structure, double step_s,
                                                                 const InitialMotion& initial)>;

/// The roots, largest modulus first. Three starts span the states of every method here; with three displacements in a
/// row as the state, each step multiplies by a matrix with the same roots as the amplification matrix.
[[nodiscard]] Eigen::VectorXcd amplification_roots(const MakeIntegrator& make, int commands_per_step,
                                                   const MeasuredMode& mode);

/// The eigenvalues of a matrix, largest modulus first.
[[nodiscard]] Eigen::VectorXcd roots_of(const Eigen::MatrixXd& matrix);

inline double spectral_radius(const MakeIntegrator& make, int commands_per_step, const MeasuredMode& mode) {
  return std::abs(amplification_roots(make, commands_per_step, mode)[0]);
}

/// The pair that vibrates, the root with the positive angle.
inline std::complex<double> principal_root(const Eigen::VectorXcd& roots) {
  return *std::max_element(roots.begin(), roots.end(), [](auto a, auto b) { return a.imag() < b.imag(); });
}

}  // namespace hybridtest::test
