#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/diagnose.hpp"
#include "diagnosis/identification/search.hpp"
#include "tests/unit/diagnosis/answers.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

/// Dry friction that grows with the velocity, as that of a bearing of PTFE on steel.
namespace hybridtest {
namespace {

using report::Verdict;
using testing::ElementsAre;

constexpr double kFast_n = 6.0e3;
constexpr double kSlowRatio = 0.35;
constexpr double kRate_s_per_m = 25.0;  // the peak velocity is 0.2 m/s

double slides_n(double slow_ratio, double time_s) {
  const double velocity_m_per_s = made_velocity_m_per_s(time_s);
  const double grown = 1.0 - (1.0 - slow_ratio) * std::exp(-kRate_s_per_m * std::abs(velocity_m_per_s));
  return std::copysign(kFast_n * grown, velocity_m_per_s);
}

/// A spring beside what slides.
Recording slider(double slow_ratio) {
  return made_recording(made_motion_m, [slow_ratio](double t) {
    return kMadeStiffness_n_per_m * made_motion_m(t) + slides_n(slow_ratio, t);
  });
}

SiteModel with_dry_friction() {
  SiteModel model = made_model();
  model.effects.push_back(absent(*find_effect(EffectInterface::specimen, "coulomb_friction")));
  model.effects.back().values.front() = kFast_n;
  return model;
}

/// The model has a dry friction, and the specimen one that is little or none at rest.
class FrictionThatGrows : public testing::TestWithParam<double> {};

TEST_P(FrictionThatGrows, TakesThePlaceOfADryFriction) {
  const Diagnosis diagnosis = diagnosis_of(with_dry_friction(), slider(GetParam()));
  EXPECT_TRUE(report::names_a_cause(diagnosis.report.verdict));
  ASSERT_THAT(causes_of(diagnosis), ElementsAre("coulomb_friction", "velocity_strengthening_friction"));
  double at_speed_n = 0.0;
  double at_rest_n = 0.0;
  for (const report::RankedCause& cause : diagnosis.report.ranking) {
    if (!cause.is_cause) continue;
    const double friction_n = find_parameter(cause, "friction_force_n")->value;
    const bool grows = cause.effect == "velocity_strengthening_friction";
    at_speed_n += friction_n;
    at_rest_n += grows ? friction_n * find_parameter(cause, "slow_friction_ratio")->value : friction_n;
    if (grows) {
      EXPECT_NEAR(find_parameter(cause, "friction_rate_s_per_m")->value, kRate_s_per_m, 0.1 * kRate_s_per_m);
    }
  }
  // Readings of 1 um and 2 ms see where it reverses to half a sample only.
  EXPECT_NEAR(at_speed_n, kFast_n, 0.05 * kFast_n);
  EXPECT_NEAR(at_rest_n, GetParam() * kFast_n, 0.05 * kFast_n);
}

INSTANTIATE_TEST_SUITE_P(RatiosOfSlowFriction, FrictionThatGrows, testing::Values(0.0, kSlowRatio));

/// Control: one that does not grow, of another size.
TEST(GrowingFriction, IsNotToldOfDryFriction) {
  SiteModel model = with_dry_friction();
  model.effects.back().values.front() = 0.5 * kFast_n;
  EXPECT_THAT(causes_of(diagnosis_of(model, slider(1.0))), ElementsAre("coulomb_friction"));
}

/// Less of the friction that the model has, and a dashpot, explain together what neither does alone; waves of the place
/// are left. Another number of an element that the model has does not make a curve fit of the answer.
TEST(WrongFriction, IsToldInPartBesideADampingThoughAPartIsLeft) {
  const Recording recording = made_recording(made_motion_m, [](double t) {
    return kMadeStiffness_n_per_m * made_motion_m(t) + std::copysign(2.0e3, made_velocity_m_per_s(t)) +
           3.0e4 * made_velocity_m_per_s(t) + 200.0 * std::sin(made_motion_m(t) / 0.002);
  });
  const Diagnosis diagnosis = diagnosis_of(with_dry_friction(), recording);
  EXPECT_EQ(diagnosis.report.verdict, Verdict::partial);
  EXPECT_THAT(causes_of(diagnosis), ElementsAre("coulomb_friction", "viscous_damping"));
}

}  // namespace
}  // namespace hybridtest
