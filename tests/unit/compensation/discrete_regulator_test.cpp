#include "compensation/discrete_regulator.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "compensation/transfer_system_model.hpp"
#include "core/config_error.hpp"

namespace hybridtest {
namespace {

TEST(DiscreteRegulator, SolvesTheScalarEquationInClosedForm) {
  // b^2 x^2 + (r - a^2 r - b^2 q) x - q r = 0, its positive root.
  for (const double a : {0.5, 0.99, 1.0, 1.3}) {
    const double b = 0.2;
    const double q = 3.0;
    const double r = 0.7;
    const double p = r - a * a * r - b * b * q;
    const double expected = (-p + std::sqrt(p * p + 4.0 * b * b * q * r)) / (2.0 * b * b);
    const Eigen::MatrixXd scalar_a = Eigen::MatrixXd::Constant(1, 1, a);
    const Eigen::VectorXd scalar_b = Eigen::VectorXd::Constant(1, b);
    const Eigen::MatrixXd scalar_q = Eigen::MatrixXd::Constant(1, 1, q);
    EXPECT_NEAR(solve_riccati(scalar_a, scalar_b, scalar_q, r)(0, 0), expected, 1e-13 * expected);
    EXPECT_NEAR(regulator_gain(scalar_a, scalar_b, scalar_q, r)(0), a * b * expected / (r + b * b * expected), 1e-13);
  }
}

TEST(DiscreteRegulator, LeavesNoResidualForTheTransferSystem) {
  const DiscreteTransferSystem system = discretised({}, 1.0 / 4096.0);
  const Eigen::MatrixXd a = system.transition;
  const Eigen::VectorXd b = system.input;
  Eigen::MatrixXd q = Eigen::MatrixXd::Zero(5, 5);
  q(3, 3) = 10.0;
  const Eigen::MatrixXd x = solve_riccati(a, b, q, 1.0);
  const Eigen::RowVectorXd k = regulator_gain(a, b, q, 1.0);
  const Eigen::MatrixXd residual = a.transpose() * x * (a - b * k) + q - x;
  EXPECT_LT(residual.norm(), 1e-12 * x.norm());  // rounding
  // Stabilising: the closed loop forgets.
  Eigen::MatrixXd power = a - b * k;
  for (int i = 0; i < 14; ++i) power = (power * power).eval();
  EXPECT_LT(power.norm(), 1e-6);
}

TEST(DiscreteRegulator, EstimatesAConstantAsTheMeanDoes) {
  // A random walk of variance q seen with noise r: L = p / (p + r), p^2 = q (p + r).
  const double q = 0.01;
  const double r = 1.0;
  const double p = 0.5 * (q + std::sqrt(q * q + 4.0 * q * r));
  const Eigen::VectorXd gain = estimator_gain(Eigen::MatrixXd::Identity(1, 1), Eigen::RowVectorXd::Ones(1),
                                              Eigen::MatrixXd::Constant(1, 1, q), r);
  EXPECT_NEAR(gain(0), p / (p + r), 1e-14);
}

TEST(DiscreteRegulator, RejectsSystemThatCannotBeStabilised) {
  const Eigen::MatrixXd growing = Eigen::MatrixXd::Constant(1, 1, 1.5);
  EXPECT_THROW(static_cast<void>(solve_riccati(growing, Eigen::VectorXd::Zero(1), Eigen::MatrixXd::Ones(1, 1), 1.0)),
               ConfigError);
}

}  // namespace
}  // namespace hybridtest
