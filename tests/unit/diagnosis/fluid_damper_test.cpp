#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "diagnosis/diagnose.hpp"
#include "mechanics/laws/parallel.hpp"
#include "mechanics/laws/viscous.hpp"
#include "tests/unit/diagnosis/answers.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

/// A fluid damper beside a spring: its force is a power of the velocity.
namespace hybridtest {
namespace {

using testing::ElementsAre;

constexpr double kDamping_n_s_per_m = 2.0e4;

/// Of a spring with a damper of that exponent, recorded with 20 N of noise.
Recording damper_recording(double exponent) {
  return made_recording(made_motion_m, [exponent](double t) {
    const double velocity = made_velocity_m_per_s(t);
    return kMadeStiffness_n_per_m * made_motion_m(t) +
           kDamping_n_s_per_m * std::copysign(std::pow(std::abs(velocity), exponent), velocity);
  });
}

void expect_damper(const report::RankedCause& cause, double exponent) {
  // Of 20 N of noise in 6000 readings of about 10 kN, a ten thousandth is left in a coefficient; near a reversal the
  // velocity is smoothed over a hundredth of a second, in which a small power of it rises to half its size.
  EXPECT_NEAR(find_parameter(cause, "damping_n_s_per_m")->value, kDamping_n_s_per_m, 0.01 * kDamping_n_s_per_m);
  EXPECT_NEAR(find_parameter(cause, "exponent")->value, exponent, 0.01);
}

class FluidDamper : public testing::TestWithParam<double> {};

TEST_P(FluidDamper, IsNamedBesideASpring) {
  const Diagnosis diagnosis = diagnosis_of(made_model(), damper_recording(GetParam()));
  EXPECT_TRUE(report::names_a_cause(diagnosis.report.verdict));
  ASSERT_THAT(causes_of(diagnosis), ElementsAre("nonlinear_viscous_damping"));
  expect_damper(diagnosis.report.ranking.front(), GetParam());
}

TEST_P(FluidDamper, TakesThePlaceOfTheLinearOneOfTheModel) {
  SiteModel model = made_model();
  model.make_law = [] {
    std::vector<std::unique_ptr<Law>> both;
    both.push_back(std::make_unique<Elastic>(kMadeStiffness_n_per_m));
    both.push_back(std::make_unique<Viscous>(Viscous::Parameters{.damping_n_s_per_m = 5.0e4}));
    return std::make_unique<Parallel>(std::move(both));
  };
  const Diagnosis diagnosis = diagnosis_of(model, damper_recording(GetParam()));
  ASSERT_THAT(causes_of(diagnosis), ElementsAre("nonlinear_viscous_damping", "viscous_damping"));
  for (const report::RankedCause& cause : diagnosis.report.ranking) {
    if (!cause.is_cause) continue;
    if (cause.effect == "nonlinear_viscous_damping") {
      expect_damper(cause, GetParam());
    } else {
      EXPECT_NEAR(find_parameter(cause, "damping_n_s_per_m")->value, -5.0e4, 0.02 * 5.0e4);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OfExponent, FluidDamper, testing::Values(0.3, 0.5, 0.75));

/// The model has a damper with another coefficient, another exponent, or both: the numbers of the whole specimen, in
/// the place of those of the model.
TEST(FluidDamperOfTheModel, HasOtherNumbers) {
  const Recording recording = damper_recording(0.5);
  for (const auto& [share, exponent] : {std::pair{0.8, 0.5}, {1.0, 0.6}, {1.3, 0.35}}) {
    SCOPED_TRACE(exponent);
    SiteModel model = made_model();
    model.effects.push_back({find_effect(EffectInterface::specimen, "nonlinear_viscous_damping"),
                             {share * kDamping_n_s_per_m, exponent, 0.0}});
    const Diagnosis diagnosis = diagnosis_of(model, recording);
    EXPECT_TRUE(report::names_a_cause(diagnosis.report.verdict));
    const report::RankedCause& cause = diagnosis.report.ranking.front();
    ASSERT_EQ(cause.effect, "nonlinear_viscous_damping");
    expect_damper(cause, 0.5);
  }
}

/// A damper on a brace that is not rigid: spring and damper in series, by the fourth-order Runge-Kutta method.
TEST(FluidDamperOnABrace, IsNamedWithItsBrace) {
  constexpr double kExponent = 0.4;
  constexpr double kStretch_m = 0.002;
  const auto slope = [](double share, double t) {
    const double relaxes = std::copysign(std::pow(std::abs(share), 1.0 / kExponent), share);
    return (made_velocity_m_per_s(t) - relaxes) / kStretch_m;
  };
  double share = 0.0;
  double now = 0.0;
  const Recording recording = made_recording(made_motion_m, [&](double t) {
    constexpr double kStep_s = 2e-6;
    for (; now + 0.5 * kStep_s < t; now += kStep_s) {
      const double k1 = slope(share, now);
      const double k2 = slope(share + 0.5 * kStep_s * k1, now + 0.5 * kStep_s);
      const double k3 = slope(share + 0.5 * kStep_s * k2, now + 0.5 * kStep_s);
      const double k4 = slope(share + kStep_s * k3, now + kStep_s);
      share += kStep_s / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    return kMadeStiffness_n_per_m * made_motion_m(t) + kDamping_n_s_per_m * share;
  });
  const Diagnosis diagnosis = diagnosis_of(made_model(), recording);
  EXPECT_TRUE(report::names_a_cause(diagnosis.report.verdict));
  ASSERT_THAT(causes_of(diagnosis), ElementsAre("nonlinear_viscous_damping"));
  const report::RankedCause& cause = diagnosis.report.ranking.front();
  expect_damper(cause, kExponent);
  // As the coefficient.
  EXPECT_NEAR(find_parameter(cause, "brace_stretch_m")->value, kStretch_m, 0.01 * kStretch_m);
}

/// A linear damper is no power of the velocity: the control.
TEST(LinearDamper, IsNoNonlinearOne) {
  EXPECT_THAT(causes_of(diagnosis_of(made_model(), damper_recording(1.0))), ElementsAre("viscous_damping"));
}

TEST(QuadraticDamper, IsNoOtherPower) {
  EXPECT_THAT(causes_of(diagnosis_of(made_model(), damper_recording(2.0))), ElementsAre("quadratic_damping"));
}

}  // namespace
}  // namespace hybridtest
