#include "mechanics/structure/sparse_modes.hpp"

#include <Spectra/MatOp/SparseCholesky.h>
#include <Spectra/MatOp/SparseSymMatProd.h>
#include <Spectra/SymGEigsShiftSolver.h>
#include <Spectra/SymGEigsSolver.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <string>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;

/// Of the estimate of the largest eigenvalue: the first guess of how far it may be exceeded.
constexpr double kEstimateMargin = 1e-4;
constexpr double kEstimateTolerance = 1e-4;
constexpr Eigen::Index kEstimateVectors = 30;
constexpr Eigen::Index kEstimateRestarts = 50;
/// The shift below zero, over the largest eigenvalue: makes a structure without supports regular.
constexpr double kShift = 1e-10;
constexpr double kModeTolerance = 1e-10;
constexpr Eigen::Index kModeRestarts = 1000;

/// K - sigma M, factorised.
class ShiftedStiffness {
 public:
  using Scalar = double;  // for Spectra

  ShiftedStiffness(const SparseMatrix& stiffness, const SparseMatrix& mass) : stiffness_{stiffness}, mass_{mass} {}

  [[nodiscard]] Eigen::Index rows() const { return stiffness_.rows(); }
  [[nodiscard]] Eigen::Index cols() const { return stiffness_.cols(); }
  void set_shift(double sigma) {
    const SparseMatrix shifted = stiffness_ - sigma * mass_;
    if (!is_analysed_) factor_.analyzePattern(shifted);
    is_analysed_ = true;
    factor_.factorize(shifted);
  }
  void perform_op(const double* from, double* to) const {
    Eigen::Map<Eigen::VectorXd>{to, rows()} = factor_.solve(Eigen::Map<const Eigen::VectorXd>{from, rows()});
  }

  [[nodiscard]] bool is_positive_definite() const {
    return factor_.info() == Eigen::Success && factor_.vectorD().minCoeff() > 0.0;
  }
  [[nodiscard]] bool is_negative_definite() const {
    return factor_.info() == Eigen::Success && factor_.vectorD().maxCoeff() < 0.0;
  }

 private:
  const SparseMatrix& stiffness_;
  const SparseMatrix& mass_;
  Eigen::SimplicialLDLT<SparseMatrix> factor_;
  bool is_analysed_ = false;
};

/// Rayleigh quotient of the displacement of one degree of freedom alone, the largest of them: below the largest
/// eigenvalue.
double largest_quotient(const SparseMatrix& stiffness, const SparseMatrix& mass) {
  return Eigen::VectorXd{stiffness.diagonal()}.cwiseQuotient(Eigen::VectorXd{mass.diagonal()}).maxCoeff();
}

/// By Lanczos, from below; the quotient where it does not converge.
double estimated_largest(const SparseMatrix& stiffness, const SparseMatrix& mass) {
  const double quotient = largest_quotient(stiffness, mass);
  Spectra::SparseSymMatProd<double> product{stiffness};
  Spectra::SparseCholesky<double> factor{mass};
  Spectra::SymGEigsSolver<Spectra::SparseSymMatProd<double>, Spectra::SparseCholesky<double>,
                          Spectra::GEigsMode::Cholesky>
      lanczos{product, factor, 1, std::min(kEstimateVectors, stiffness.rows())};
  lanczos.init();
  if (lanczos.compute(Spectra::SortRule::LargestAlge, kEstimateRestarts, kEstimateTolerance) == 0) return quotient;
  return std::max(quotient, lanczos.eigenvalues()[0]);
}

}  // namespace

double largest_eigenvalue(const SparseMatrix& stiffness, const SparseMatrix& mass) {
  const double estimate = estimated_largest(stiffness, mass);
  if (!(estimate > 0.0)) return 0.0;
  ShiftedStiffness shifted{stiffness, mass};
  double margin = kEstimateMargin;
  for (; std::isfinite(estimate * margin); margin *= 2.0) {
    shifted.set_shift(estimate * (1.0 + margin));
    if (shifted.is_negative_definite()) break;
  }
  return estimate * (1.0 + margin);
}

Eigenpairs lowest_eigenpairs(const SparseMatrix& stiffness, const SparseMatrix& mass, Eigen::Index count,
                             double largest) {
  const double sigma = -kShift * std::max(largest, std::abs(largest_quotient(stiffness, mass)));
  ShiftedStiffness shifted{stiffness, mass};
  shifted.set_shift(sigma);
  if (!shifted.is_positive_definite()) {
    throw ConfigError{
        "the structure's initial stiffness is negative in some motion: it falls over by itself; check the signs of the "
        "stiffnesses"};
  }
  Spectra::SparseSymMatProd<double> product{mass};
  const Eigen::Index vectors = std::min(stiffness.rows(), std::max<Eigen::Index>(2 * count + 1, 20));
  Spectra::SymGEigsShiftSolver<ShiftedStiffness, Spectra::SparseSymMatProd<double>, Spectra::GEigsMode::ShiftInvert>
      lanczos{shifted, product, count, vectors, sigma};
  lanczos.init();
  if (lanczos.compute(Spectra::SortRule::LargestMagn, kModeRestarts, kModeTolerance) < count) {
    throw ConfigError{"the lowest " + std::to_string(count) + " vibration modes of the structure do not converge"};
  }
  Eigenpairs pairs{lanczos.eigenvalues().reverse(), lanczos.eigenvectors().rowwise().reverse()};
  for (auto vector : pairs.vectors.colwise()) vector /= std::sqrt(vector.dot(mass * vector));
  return pairs;
}

}  // namespace hybridtest
