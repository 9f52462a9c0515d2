#include "compensation/discrete_regulator.hpp"

#include <Eigen/LU>

#include "core/config_error.hpp"

namespace hybridtest {

Eigen::MatrixXd solve_riccati(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, const Eigen::MatrixXd& q, double r) {
  const Eigen::Index n = a.rows();
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd transition = a;
  Eigen::MatrixXd g = b * b.transpose() / r;
  Eigen::MatrixXd x = q;
  constexpr int kDoublings = 60;  // 2^60 steps of the recursion
  for (int i = 0; i < kDoublings; ++i) {
    const Eigen::PartialPivLU<Eigen::MatrixXd> lu{identity + g * x};
    const Eigen::MatrixXd w = lu.solve(transition);
    const Eigen::MatrixXd next_x = x + transition.transpose() * x * w;
    g += transition * lu.solve(g) * transition.transpose();
    g = (0.5 * (g + g.transpose())).eval();
    transition = (transition * w).eval();
    const double change = (next_x - x).cwiseAbs().maxCoeff();
    x = 0.5 * (next_x + next_x.transpose());
    if (!x.allFinite()) break;
    if (change <= 1e-15 * x.cwiseAbs().maxCoeff()) return x;
  }
  throw ConfigError{"no regulator stabilises this model; expected a controllable one, with weights in proportion"};
}

Eigen::RowVectorXd regulator_gain(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, const Eigen::MatrixXd& q,
                                  double r) {
  const Eigen::MatrixXd x = solve_riccati(a, b, q, r);
  const Eigen::RowVectorXd bx = b.transpose() * x;
  return bx * a / (r + bx * b);
}

Eigen::VectorXd estimator_gain(const Eigen::MatrixXd& a, const Eigen::RowVectorXd& c, const Eigen::MatrixXd& q,
                               double r) {
  // The covariance before the correction solves the dual equation.
  const Eigen::MatrixXd covariance = solve_riccati(a.transpose(), c.transpose(), q, r);
  const Eigen::VectorXd pc = covariance * c.transpose();
  return pc / (r + c * pc);
}

}  // namespace hybridtest
