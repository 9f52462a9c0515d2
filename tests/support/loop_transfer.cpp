#include "tests/support/loop_transfer.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace hybridtest {
namespace {

using Complex = std::complex<double>;

/// First-order form with the states (reference * u, v), both with the magnitude of a velocity.
Eigen::MatrixXd state_matrix(const DenseSystem& system, const Eigen::LLT<Eigen::MatrixXd>& mass, double reference) {
  const Eigen::Index size = system.mass_kg.rows();
  Eigen::MatrixXd state = Eigen::MatrixXd::Zero(2 * size, 2 * size);
  state.topRightCorner(size, size).diagonal().setConstant(reference);
  state.bottomLeftCorner(size, size) = mass.solve(system.stiffness_n_per_m) / -reference;
  state.bottomRightCorner(size, size) = -mass.solve(system.damping_n_s_per_m);
  return state;
}

double reference_frequency(const DenseSystem& system) {
  const double ratio = system.stiffness_n_per_m.cwiseAbs().maxCoeff() / system.mass_kg.cwiseAbs().maxCoeff();
  return ratio > 0.0 ? std::sqrt(ratio) : 1.0;
}

/// One solver for real and complex matrices: each kind of Eigen's solvers takes ten seconds to compile.
Eigen::VectorXcd eigenvalues_of(const Eigen::MatrixXcd& matrix) {
  return Eigen::ComplexSchur<Eigen::MatrixXcd>{matrix, false}.matrixT().diagonal();
}

}  // namespace

Eigen::VectorXcd poles_rad_per_s(const DenseSystem& system) {
  const Eigen::LLT<Eigen::MatrixXd> mass{system.mass_kg};
  return eigenvalues_of(state_matrix(system, mass, reference_frequency(system)).cast<Complex>());
}

LoopTransfer::LoopTransfer(const DenseSystem& structure, DenseSystem substructure, const InterfaceMap& interface)
    : substructure_{std::move(substructure)}, reference_rad_per_s_{reference_frequency(structure)} {
  const Eigen::Index size = structure.mass_kg.rows();
  const Eigen::LLT<Eigen::MatrixXd> mass{structure.mass_kg};
  const Eigen::ComplexSchur<Eigen::MatrixXcd> schur{
      state_matrix(structure, mass, reference_rad_per_s_).cast<Complex>()};
  triangular_ = schur.matrixT();
  poles_ = triangular_.diagonal();
  const Eigen::MatrixXd to_structure = interface.matrix().transpose();
  const Eigen::MatrixXd accelerance = mass.solve(to_structure);
  input_ = schur.matrixU().bottomRows(size).adjoint() * accelerance.cast<Complex>();
  output_ = to_structure.transpose().cast<Complex>() * schur.matrixU().topRows(size) / reference_rad_per_s_;
  flexibility_at_infinity_ = to_structure.transpose() * accelerance;
}

Eigen::VectorXcd LoopTransfer::eigenvalues(double frequency_rad_per_s) const {
  const Complex root{0.0, frequency_rad_per_s};
  Eigen::MatrixXcd shifted = -triangular_;
  shifted.diagonal().array() += root;
  const Eigen::MatrixXcd compliance = output_ * shifted.triangularView<Eigen::Upper>().solve(input_);
  const Eigen::MatrixXcd dynamic_stiffness = substructure_.stiffness_n_per_m.cast<Complex>() +
                                             root * substructure_.damping_n_s_per_m.cast<Complex>() +
                                             root * root * substructure_.mass_kg.cast<Complex>();
  if (!compliance.allFinite()) {  // on an undamped resonance
    return Eigen::VectorXcd::Constant(compliance.rows(), Complex{std::numeric_limits<double>::max(), 0.0});
  }
  Eigen::VectorXcd values = eigenvalues_of(dynamic_stiffness * compliance);
  std::sort(values.begin(), values.end(), [](Complex a, Complex b) { return std::norm(a) > std::norm(b); });
  return values;
}

double LoopTransfer::modulus_at_infinity_max() const {
  const Eigen::MatrixXd limit = substructure_.mass_kg * flexibility_at_infinity_;
  return eigenvalues_of(limit.cast<Complex>()).cwiseAbs().maxCoeff();
}

}  // namespace hybridtest
