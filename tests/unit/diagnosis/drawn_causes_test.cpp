#include "diagnosis/verdict/drawn_causes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "diagnosis/identification/effect_fit.hpp"
#include "diagnosis/identification/smoothing_choice.hpp"
#include "diagnosis/tuning.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

namespace hybridtest {
namespace {

using enum EffectInterface;

TEST(DrawnCauses, HaveTheCovarianceThatIsGiven) {
  // Newtons beside metres, and a parameter that is known exactly.
  Eigen::Matrix3d first;
  const double both = -0.8 * 100.0 * 1e-5;
  first << 1e4, both, 0.0, both, 1e-10, 0.0, 0.0, 0.0, 0.0;
  const std::array<Eigen::MatrixXd, 2> covariances{first, Eigen::MatrixXd::Constant(1, 1, 4.0)};
  constexpr int kDraws = 20'000;
  Random random{3};
  Eigen::Matrix4d found = Eigen::Matrix4d::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::VectorXd drawn = drawn_deviation(covariances, random);
    ASSERT_EQ(drawn.size(), 4);
    found += drawn * drawn.transpose() / kDraws;
  }
  const double tolerance = 3.0 * std::sqrt(2.0 / kDraws);
  EXPECT_NEAR(found(0, 0) / 1e4, 1.0, tolerance);
  EXPECT_NEAR(found(1, 1) / 1e-10, 1.0, tolerance);
  EXPECT_NEAR(found(0, 1) / both, 1.0, 2.0 * tolerance);
  EXPECT_EQ(found(2, 2), 0.0);
  EXPECT_NEAR(found(3, 3) / 4.0, 1.0, tolerance);
  EXPECT_NEAR(found(0, 3) / (100.0 * 2.0), 0.0, tolerance) << "channels are independent of each other";
}

TEST(DrawnCauses, StayWithinWhatTheEffectAccepts) {
  const std::array causes{EffectSetting{find_effect(specimen, "coulomb_friction"), {500.0, 0.1, 1e-4, 0.0}},
                          EffectSetting{find_effect(transfer_system, "gain"), {0.02}}};
  Eigen::VectorXd deviation(5);
  deviation << -2000.0, 0.05, 1e-5, 0.0, 0.01;
  const std::vector<EffectSetting> moved = moved_causes(causes, deviation);
  EXPECT_EQ(moved[0].values[0], causes[0].type->parameters[0].low);
  EXPECT_NEAR(moved[0].values[1], 0.15, 1e-15);
  EXPECT_NEAR(moved[0].values[2], 1.1e-4, 1e-18);
  EXPECT_NEAR(moved[1].values[0], 0.03, 1e-15);
  EXPECT_EQ(moved_causes(causes, {})[0].values, causes[0].values) << "control";
}

/// Of the last parameter that is fitted.
double half_to_draw(const FitOutcome& fit) {
  const Eigen::MatrixXd covariance = covariance_for_draws(fit);
  return tuning::kTwoSided95 * std::sqrt(covariance(covariance.rows() - 1, covariance.cols() - 1));
}

/// As IntervalCoverage.PassesOnTheDoubtOfAnEarlierChannel: a gain of the transducer is known to 2 % only. That makes
/// the stiffness as doubtful, and changes nothing in the force that the two predict together.
TEST(DrawnCauses, DoubtOfPredictionsIsWithoutOtherNumbers) {
  const Recording recording = made_recording([](double t) { return 1.01 * made_motion_m(t); },
                                             [](double t) { return 2.04e6 * made_motion_m(t); });
  const FoundEffect gain{{find_effect(displacement_sensor, "gain"), {0.01}},
                         Eigen::MatrixXd::Constant(1, 1, 0.02 * 0.02)};
  SiteModel model = made_model();
  model.effects = {gain.effect};
  const IdentificationProblem problem = make_problem(model, modelled_segments(model, recording, 0, 0), {&gain, 1});
  const FitOutcome fit = refit_effects(problem, {{find_effect(specimen, "stiffness_error"), {0.0, 4e4}}}, false);
  const ParameterEstimate& stiffness = fit.parameters[0][1];
  EXPECT_GE(half_to_draw(fit), 0.999 * tuning::kIntervalScale * half_width_95(stiffness));
  EXPECT_LT(half_to_draw(fit), 0.1 * half_interval_95(stiffness));
}

TEST(DrawnCauses, TogetherAsTheyWereFitted) {
  const Recording recording = made_recording(made_motion_m, [](double t) {
    const bool forth = made_motion_m(t + 1e-4) > made_motion_m(t);
    return 2.1e6 * made_motion_m(t) + (forth ? 2e3 : -2e3);
  });
  const IdentificationProblem problem = make_problem(made_model(), modelled_segments(made_model(), recording, 0, 0));
  const FitOutcome fit = refit_effects(problem,
                                       {{find_effect(specimen, "coulomb_friction"), {2e3, 0.0, 1e-4, 0.0}},
                                        {find_effect(specimen, "stiffness_error"), {0.0, 1e5}}},
                                       false);
  const Eigen::MatrixXd covariance = covariance_for_draws(fit);
  ASSERT_EQ(covariance.rows(), 6);
  // With a larger friction goes a softer spring.
  EXPECT_LT(covariance(0, 5), 0.0);
  EXPECT_NEAR(covariance(0, 5) / covariance(5, 0), 1.0, 1e-9);
}

}  // namespace
}  // namespace hybridtest
