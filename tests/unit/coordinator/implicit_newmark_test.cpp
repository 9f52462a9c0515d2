#include "coordinator/integrators/implicit_newmark.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/config_error.hpp"
#include "tests/support/structures.hpp"

namespace hybridtest {
namespace {

Eigen::VectorXd one(double value) { return Eigen::VectorXd::Constant(1, value); }

/// Corrections of the trials of the first step after a load of 1 N.
std::vector<double> corrections_m(ImplicitNewmark& method, double stiffness_n_per_m, double damping_n_s_per_m) {
  const auto force_n = [&](const MotionState& command) {
    return one(stiffness_n_per_m * command.displacement_m[0] + damping_n_s_per_m * command.velocity_m_per_s[0]);
  };
  method.advance(force_n(method.current()), one(0.0));
  std::vector<double> corrections;
  while (method.is_trial()) {
    const double before = method.current().displacement_m[0];
    method.advance(force_n(method.current()), one(1.0));
    corrections.push_back(std::abs(method.current().displacement_m[0] - before));
  }
  return corrections;
}

TEST(ImplicitNewmark, TriesUntilTheCorrectionIsBelowTheTolerance) {
  constexpr double kStep_s = 0.5;
  ImplicitNewmark method{{.tolerance_m = 1e-6}, test::oscillator(1.0, 0.0, 1.0), kStep_s};
  EXPECT_FALSE(method.is_trial()) << "the initial displacement is given";
  const std::vector<double> corrections = corrections_m(method, 0.5, 0.0);
  ASSERT_GE(corrections.size(), 3U);
  EXPECT_EQ(method.iteration(), static_cast<int>(corrections.size()));
  EXPECT_FALSE(method.is_trial());
  EXPECT_EQ(method.missing_m(), 0.0);
  EXPECT_LE(corrections.back(), 1e-6);
  EXPECT_GT(corrections[corrections.size() - 2], 1e-6);
  // By (K_I - K)/A with A = 4/dt^2 + K_I.
  const double shrinks = 0.5 / (4.0 / (kStep_s * kStep_s) + 1.0);
  for (std::size_t i = 1; i + 1 < corrections.size(); ++i) {
    EXPECT_NEAR(corrections[i] / corrections[i - 1], shrinks, 1e-6);
  }
}

TEST(ImplicitNewmark, DampersCountAsStiffnessInTheIterations) {
  constexpr double kStep_s = 0.5;
  ImplicitNewmark method{{}, test::oscillator(1.0, 0.0, 1.0), kStep_s};
  const std::vector<double> corrections = corrections_m(method, 1.0, 0.3);
  EXPECT_NEAR(corrections[1] / corrections[0], 2.0 / kStep_s * 0.3 / (4.0 / (kStep_s * kStep_s) + 1.0), 1e-9);
}

TEST(ImplicitNewmark, StaysAtTheStepBeforeWhileItTries) {
  ImplicitNewmark method{{}, test::oscillator(1.0, 0.1, 1.0), 0.1, {one(0.2), one(-0.3)}};
  method.advance(one(0.2), one(0.0));
  ASSERT_TRUE(method.is_trial());
  method.advance(one(0.7), one(2.0));
  EXPECT_EQ(method.iteration(), 1);
  EXPECT_EQ(method.completed().displacement_m[0], 0.2);
  EXPECT_EQ(method.completed().velocity_m_per_s[0], -0.3);
}

TEST(ImplicitNewmark, SaysByHowMuchEquilibriumIsMissed) {
  // A stiffness that exceeds the initial one by more than A: each correction is larger than the one before.
  ImplicitNewmark method{{.iterations_max = 7}, test::oscillator(1.0, 0.0, 1.0), 1.0};
  const std::vector<double> corrections = corrections_m(method, 7.0, 0.0);
  EXPECT_EQ(corrections.size(), 7U);
  EXPECT_GT(corrections.back(), corrections.front());
  EXPECT_NEAR(method.missing_m(), corrections.back(), 1e-12);
  EXPECT_FALSE(method.is_trial()) << "the next command is final";
}

TEST(ImplicitNewmark, FindsEquilibriumOfALawWithHistory) {
  // A yielding spring under a slow load: at rest at last, where its force is the load.
  double plastic_m = 0.0;
  double trial_plastic_m = 0.0;
  const auto force_n = [&](const MotionState& command) -> Eigen::VectorXd {
    const double u = command.displacement_m[0];
    const double spring_n = std::clamp(100.0 * (u - plastic_m), -5.0 + 2.0 * u, 5.0 + 2.0 * u);
    trial_plastic_m = u - spring_n / 100.0;
    return one(spring_n);
  };
  ImplicitNewmark method{{}, test::oscillator(1.0, 10.0, 100.0), 0.01};
  for (int step = 0; step <= 20000; ++step) {
    complete_step(method, force_n, one(std::min(5.5, 0.001 * step)));
    ASSERT_EQ(method.missing_m(), 0.0);
    plastic_m = trial_plastic_m;
  }
  EXPECT_NEAR(method.completed().displacement_m[0], 0.25, 1e-6);
  EXPECT_NEAR(method.completed().velocity_m_per_s[0], 0.0, 1e-8);
}

TEST(ImplicitNewmark, StaysStableWhereTheStiffnessSoftens) {
  for (const double omega_dt : {0.1, 2.1, 20.0}) {
    for (const double share : {0.3, 0.7}) {
      ImplicitNewmark method{{}, test::oscillator(1.0, 0.0, 1.0), omega_dt, {one(1.0), {}}};
      const auto force_n = [share](const MotionState& command) { return one(share * command.displacement_m[0]); };
      double early_m = 0.0;
      double late_m = 0.0;
      for (int step = 0; step < 10'000; ++step) {
        complete_step(method, force_n, one(0.0));
        double& peak_m = step < 5'000 ? early_m : late_m;
        peak_m = std::max(peak_m, std::abs(method.completed().displacement_m[0]));
      }
      EXPECT_LT(late_m, 1.01 * early_m) << "omega dt " << omega_dt << ", stiffness " << share << " of the initial one";
    }
  }
}

TEST(ImplicitNewmark, RejectsParametersThatAreNotStable) {
  const auto make = [](const ImplicitNewmark::Parameters& parameters) {
    return ImplicitNewmark{parameters, test::oscillator(1.0, 0.0, 1.0), 0.1};
  };
  EXPECT_NO_THROW(make({}));
  EXPECT_NO_THROW(make({.gamma = 0.6, .beta = 0.3025}));
  EXPECT_THROW(make({.gamma = 0.4}), ConfigError);
  EXPECT_THROW(make({.gamma = 0.6, .beta = 0.25}), ConfigError);
  EXPECT_THROW(make({.tolerance_m = 0.0}), ConfigError);
  EXPECT_THROW(make({.iterations_max = 0}), ConfigError);
}

}  // namespace
}  // namespace hybridtest
