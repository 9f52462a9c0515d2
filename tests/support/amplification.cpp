#include "tests/support/amplification.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>

/// A file of its own: these decompositions take a minute to compile.
namespace hybridtest::test {
namespace {

/// Free displacements after a unit start: with a displacement, a velocity or a force in the first step alone.
Eigen::VectorXd free_displacements(const MakeIntegrator& make, int commands_per_step, const MeasuredMode& mode,
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

}  // namespace

Eigen::VectorXcd roots_of(const Eigen::MatrixXd& matrix) {
  Eigen::VectorXcd roots = Eigen::EigenSolver<Eigen::MatrixXd>{matrix, false}.eigenvalues();
  std::sort(roots.begin(), roots.end(), [](auto a, auto b) { return std::norm(a) > std::norm(b); });
  return roots;
}

Eigen::VectorXcd amplification_roots(const MakeIntegrator& make, int commands_per_step, const MeasuredMode& mode) {
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
  return roots_of(reduced);
}

}  // namespace hybridtest::test
