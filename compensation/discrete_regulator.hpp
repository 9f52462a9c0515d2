#pragma once

#include <Eigen/Core>

namespace hybridtest {

/// The stabilising solution X of the discrete algebraic Riccati equation
///
///     X = A' X A - A' X B (r + B' X B)^-1 B' X A + Q,
///
/// by the structure-preserving doubling algorithm (Chu, Fan, Lin and Wang, Int. J. Control 77, 2004),
/// which converges quadratically. Allocates; for construction.
/// @param a   n x n.
/// @param b   n.
/// @param q   n x n, positive semidefinite.
/// @param r   positive.
/// @throws ConfigError where it does not converge: no regulator stabilises the system.
[[nodiscard]] Eigen::MatrixXd solve_riccati(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                                            const Eigen::MatrixXd& q, double r);

/// Steady gain K of the linear-quadratic regulator u = -K s of s(k+1) = A s + B u, minimising the
/// sum of s' Q s + r u^2. @throws ConfigError as solve_riccati.
[[nodiscard]] Eigen::RowVectorXd regulator_gain(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                                                const Eigen::MatrixXd& q, double r);

/// Steady gain L of the Kalman filter that corrects s by L (y - c s), y = c s + v of variance r, before it
/// predicts s(k+1) = A s + w, w of covariance Q. @throws ConfigError as solve_riccati.
[[nodiscard]] Eigen::VectorXd estimator_gain(const Eigen::MatrixXd& a, const Eigen::RowVectorXd& c,
                                             const Eigen::MatrixXd& q, double r);

}  // namespace hybridtest
