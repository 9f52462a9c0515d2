#include "coordinator/preflight/structure_response.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <utility>

namespace hybridtest {
namespace {

/// Damping between two modes below this share of theirs is rounding.
constexpr double kCoupling = 1e-6;
/// Of a static deflection, the share beyond the modes below which it adds nothing.
constexpr double kNothingNew = 1e-9;
/// Vectors per interface force. In a chain of masses a force reaches one more of them with each.
constexpr int kLanczosDepth = 24;

Eigen::MatrixXd stacked(const std::vector<InterfaceMap>& interfaces, Eigen::Index structure_size) {
  Eigen::Index rows = 0;
  for (const InterfaceMap& interface : interfaces) rows += interface.size();
  Eigen::MatrixXd matrix{rows, structure_size};
  Eigen::Index at = 0;
  for (const InterfaceMap& interface : interfaces) {
    matrix.middleRows(at, interface.size()) = interface.matrix();
    at += interface.size();
  }
  return matrix;
}

/// Makes `candidate` orthogonal to all of `basis` (M as metric) and of unit mass, and keeps it unless it is none.
void append_new(const Eigen::SparseMatrix<double>& mass, Eigen::VectorXd candidate, Eigen::MatrixXd& basis) {
  const double whole = candidate.dot(mass * candidate);
  for (int pass = 0; pass < 2; ++pass) candidate -= basis * (basis.transpose() * (mass * candidate));
  const double rest = candidate.dot(mass * candidate);
  if (!(rest > kNothingNew * whole)) return;
  basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
  basis.rightCols(1) = candidate / std::sqrt(rest);
}

/// What the modes leave of the answer to forces at the interface: the static deflection, and the accelerations that
/// follow from the force at once and in the steps after it (Lanczos), each orthogonal to the modes, as pseudo-modes.
Eigen::MatrixXd residual_shapes(const LinearStructure& structure, const VibrationModes& modes,
                                const Eigen::MatrixXd& interface) {
  const Eigen::SparseMatrix<double>& mass = structure.mass_kg;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> stiffness_factors{structure.initial_stiffness_n_per_m};
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> mass_factors{mass};
  Eigen::MatrixXd basis = modes.shapes;
  if (stiffness_factors.info() == Eigen::Success) {  // else the structure is free to move
    const Eigen::MatrixXd deflection = stiffness_factors.solve(interface.transpose());
    for (const auto& column : deflection.colwise()) append_new(mass, column, basis);
  }
  Eigen::MatrixXd accelerations = mass_factors.solve(interface.transpose());
  for (int depth = 0; depth < kLanczosDepth; ++depth) {
    const Eigen::Index before = basis.cols();
    for (const auto& column : accelerations.colwise()) append_new(mass, column, basis);
    if (basis.cols() == before) break;
    accelerations = mass_factors.solve(structure.initial_stiffness_n_per_m * basis.rightCols(basis.cols() - before));
  }
  const Eigen::MatrixXd added = basis.rightCols(basis.cols() - modes.count());
  const Eigen::MatrixXd reduced = added.transpose() * (structure.initial_stiffness_n_per_m * added);
  return added * Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>{reduced}.eigenvectors();
}

LinearStructure of_unit_mass(const Eigen::MatrixXd& damping, const Eigen::MatrixXd& stiffness) {
  LinearStructure structure;
  structure.mass_kg = Eigen::MatrixXd::Identity(damping.rows(), damping.rows()).sparseView();
  structure.damping_n_s_per_m = damping.sparseView();
  structure.initial_stiffness_n_per_m = stiffness.sparseView();
  structure.influence = Eigen::VectorXd::Ones(damping.rows());
  return structure;
}

}  // namespace

StructureResponse::StructureResponse(const LinearStructure& structure, const VibrationModes& modes,
                                     const std::vector<InterfaceMap>& interfaces, const MakeIntegrator& make,
                                     double step_s, int commands_per_step)
    : commands_per_step_{commands_per_step}, step_s_{step_s} {
  const Eigen::MatrixXd interface = stacked(interfaces, structure.size());
  interface_size_ = interface.rows();
  Eigen::MatrixXd shapes = modes.shapes;
  if (modes.count() < structure.size()) {
    const Eigen::MatrixXd residual = residual_shapes(structure, modes, interface);
    residual_coordinates_ = residual.cols();
    shapes.conservativeResize(Eigen::NoChange, modes.count() + residual_coordinates_);
    if (residual_coordinates_ > 0) shapes.rightCols(residual_coordinates_) = residual;
  }
  const Eigen::MatrixXd damping = shapes.transpose() * (structure.damping_n_s_per_m * shapes);
  const Eigen::VectorXd stiffness =
      (shapes.transpose() * (structure.initial_stiffness_n_per_m * shapes)).diagonal().cwiseMax(0.0);
  const Eigen::MatrixXd at_interface = interface * shapes;
  Eigen::MatrixXd between = damping;
  between.diagonal().setZero();
  if (between.cwiseAbs().maxCoeff() > kCoupling * damping.cwiseAbs().maxCoeff()) {
    blocks_.push_back({at_interface, {make, of_unit_mass(damping, stiffness.asDiagonal()), step_s, commands_per_step}});
    return;
  }
  for (Eigen::Index i = 0; i < shapes.cols(); ++i) {
    const LinearStructure mode = of_unit_mass(damping.block(i, i, 1, 1), Eigen::MatrixXd::Constant(1, 1, stiffness[i]));
    blocks_.push_back({at_interface.col(i), {make, mode, step_s, commands_per_step}});
  }
}

std::vector<std::complex<double>> StructureResponse::poles() const {
  std::vector<std::complex<double>> poles;
  for (const Block& block : blocks_) {
    poles.insert(poles.end(), block.response.poles().begin(), block.response.poles().end());
  }
  return poles;
}

Eigen::MatrixXcd StructureResponse::at(std::complex<double> z) const {
  const Eigen::Index rows = commands_per_step_ * IntegratorResponse::kChannels;
  const Eigen::Index size = interface_size_;
  Eigen::MatrixXcd sum = Eigen::MatrixXcd::Zero(rows * size, commands_per_step_ * size);
  for (const Block& block : blocks_) {
    const Eigen::MatrixXcd part = block.response.at(z);
    const Eigen::Index q = block.shape.cols();
    for (Eigen::Index i = 0; i < rows; ++i) {
      for (Eigen::Index j = 0; j < commands_per_step_; ++j) {
        sum.block(i * size, j * size, size, size) +=
            block.shape * part.block(i * q, j * q, q, q) * block.shape.transpose();
      }
    }
  }
  return sum;
}

}  // namespace hybridtest
