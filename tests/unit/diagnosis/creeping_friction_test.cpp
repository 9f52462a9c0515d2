#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/diagnose.hpp"
#include "tests/unit/diagnosis/answers.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

/// Dry friction that creeps before it slides, or does not.
namespace hybridtest {
namespace {

using testing::ElementsAre;

constexpr double kForce_n = 1.5e3;
constexpr double kPresliding_m = 2e-4;

/// Of a spring with a friction whose share z grows with the displacement by `slope(z sign(dx)) / d`, in steps far
/// shorter than a sample; recorded with 20 N of noise.
template <class Slope>
Recording friction_recording(Slope&& slope) {
  double share = 0.0;
  double now = 0.0;
  return made_recording(made_motion_m, [&, slope](double t) {
    constexpr double kStep_s = 1e-6;
    for (; now + 0.5 * kStep_s < t; now += kStep_s) {
      const double velocity = made_velocity_m_per_s(now + 0.5 * kStep_s);
      share += slope(std::copysign(1.0, velocity) * share) * velocity / kPresliding_m * kStep_s;
      share = std::clamp(share, -1.0, 1.0);
    }
    return kMadeStiffness_n_per_m * made_motion_m(t) + kForce_n * share;
  });
}

/// Bristles of the LuGre model: each bends less and less (Canudas de Wit et al., 1995).
TEST(FrictionThatCreeps, IsNamedWithItsWayToSliding) {
  const Diagnosis diagnosis = diagnosis_of(made_model(), friction_recording([](double share) { return 1.0 - share; }));
  EXPECT_TRUE(report::names_a_cause(diagnosis.report.verdict));
  ASSERT_THAT(causes_of(diagnosis), ElementsAre("coulomb_friction"));
  const report::RankedCause& cause = diagnosis.report.ranking.front();
  // 20 N of noise in 6000 readings leave 0.3 N; of the way to sliding there are 100 readings or so, after 50 reversals.
  EXPECT_NEAR(find_parameter(cause, "friction_force_n")->value, kForce_n, 0.001 * kForce_n);
  EXPECT_NEAR(find_parameter(cause, "presliding_displacement_m")->value, kPresliding_m, 0.01 * kPresliding_m);
  EXPECT_NEAR(find_parameter(cause, "presliding_exponent")->value, 1.0, 0.02);
}

/// The control: a friction that slides at once after its presliding does not creep.
TEST(FrictionThatDoesNotCreep, IsNamedWithoutAnExponent) {
  const Diagnosis diagnosis = diagnosis_of(made_model(), friction_recording([](double) { return 1.0; }));
  EXPECT_TRUE(report::names_a_cause(diagnosis.report.verdict));
  ASSERT_THAT(causes_of(diagnosis), ElementsAre("coulomb_friction"));
  const report::RankedCause& cause = diagnosis.report.ranking.front();
  EXPECT_NEAR(find_parameter(cause, "friction_force_n")->value, kForce_n, 0.001 * kForce_n);
  EXPECT_NEAR(find_parameter(cause, "presliding_displacement_m")->value, kPresliding_m, 0.01 * kPresliding_m);
  EXPECT_EQ(find_parameter(cause, "presliding_exponent")->value, 0.0);
}

}  // namespace
}  // namespace hybridtest
