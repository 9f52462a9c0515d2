#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
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

/// Free displacements after a unit start: with a displacement, a velocity or a force in the first step alone.
inline Eigen::VectorXd free_displacements(const MakeIntegrator& make, int commands_per_step, const MeasuredMode& mode,
                                          int start, Eigen::Index samples) {
  const auto one = [](double value) { return Eigen::VectorXd::Constant(1, value); };
  const double step_s = mode.omega_dt;
  const auto integrator = make(oscillator(1.0, 2.0 * mode.damping_ratio, 1.0), step_s,
                               {one(start == 0 ? 1.0 : 0.0), one(start == 1 ? 1.0 / step_s : 0.0)});
  Eigen::VectorXd displacements{samples};
  for (Eigen::Index step = 0; step < samples * commands_per_step; ++step) {
    const double force = start == 2 && step == 0 ? 1.0 / (step_s * step_s) : 0.0;
    complete_step(
        *integrator,
        [&](const MotionState& command) -> Eigen::VectorXd { return mode.stiffness_ratio * command.displacement_m; },
        one(force));
    if (step % commands_per_step == 0) {
      displacements[step / commands_per_step] = integrator->completed().displacement_m[0];
    }
  }
  return displacements;
}

/// The roots, largest modulus first. Three starts span the states of every method here; with three displacements in a
/// row as the state, each step multiplies by a matrix with the same roots as the amplification matrix.
inline Eigen::VectorXcd amplification_roots(const MakeIntegrator& make, int commands_per_step,
                                            const MeasuredMode& mode) {
  constexpr Eigen::Index kStates = 3;
  constexpr Eigen::Index kFirst = 2;  // of the samples used: the first step of a method may differ from the others
  constexpr double kNoState = 1e-9;   // methods of two states leave the third one to rounding
  Eigen::MatrixXd now{kStates, kStates};
  Eigen::MatrixXd next{kStates, kStates};
  for (int start = 0; start < kStates; ++start) {
    const Eigen::VectorXd u = free_displacements(make, commands_per_step, mode, start, kFirst + kStates + 1);
    const double scale = u.segment(kFirst, kStates).cwiseAbs().maxCoeff();
    now.col(start) = u.segment(kFirst, kStates) / scale;
    next.col(start) = u.segment(kFirst + 1, kStates) / scale;
  }
  Eigen::JacobiSVD<Eigen::MatrixXd> states{now, Eigen::ComputeFullU | Eigen::ComputeFullV};
  states.setThreshold(kNoState);
  const Eigen::Index rank = states.rank();
  const Eigen::MatrixXd basis = states.matrixU().leftCols(rank);
  const Eigen::MatrixXd reduced = basis.transpose() * next * states.matrixV().leftCols(rank) *
                                  states.singularValues().head(rank).cwiseInverse().asDiagonal();
  Eigen::VectorXcd roots = Eigen::EigenSolver<Eigen::MatrixXd>{reduced, false}.eigenvalues();
  std::sort(roots.begin(), roots.end(), [](auto a, auto b) { return std::norm(a) > std::norm(b); });
  return roots;
}

inline double spectral_radius(const MakeIntegrator& make, int commands_per_step, const MeasuredMode& mode) {
  return std::abs(amplification_roots(make, commands_per_step, mode)[0]);
}

/// The pair that vibrates, the root with the positive angle.
inline std::complex<double> principal_root(const Eigen::VectorXcd& roots) {
  return *std::max_element(roots.begin(), roots.end(), [](auto a, auto b) { return a.imag() < b.imag(); });
}

}  // namespace hybridtest::test
