#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "diagnosis/diagnose.hpp"
#include "tests/unit/diagnosis/answers.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

/// Stops that a specimen meets, as an isolator in its moat: on one side, or on both.
namespace hybridtest {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsSupersetOf;
using testing::Not;

constexpr double kStop_n_per_m = 6.0e6;
constexpr double kPosition_m = 0.016;
constexpr double kOtherStop_n_per_m = 4.0e6;
constexpr double kOtherPosition_m = -0.018;

Diagnosis diagnosis_with_stops(bool on_both_sides) {
  return diagnosis_of(made_model(), made_recording(made_motion_m, [=](double t) {
                        const double x = made_motion_m(t);
                        const double other_n = kOtherStop_n_per_m * std::min(0.0, x - kOtherPosition_m);
                        return kMadeStiffness_n_per_m * x + kStop_n_per_m * std::max(0.0, x - kPosition_m) +
                               (on_both_sides ? other_n : 0.0);
                      }));
}

TEST(Stops, OnBothSidesAreOneCause) {
  const Diagnosis diagnosis = diagnosis_with_stops(true);
  EXPECT_TRUE(report::names_a_cause(diagnosis.report.verdict));
  ASSERT_THAT(causes_of(diagnosis), ElementsAre("contact"));
  const report::RankedCause& cause = diagnosis.report.ranking.front();
  const auto value_of = [&](const char* name) { return find_parameter(cause, name)->value; };
  // Either one may be the first.
  const double first_n_per_m = value_of("stiffness_n_per_m");
  const double second_n_per_m = first_n_per_m * value_of("other_stiffness_ratio");
  const double first_m = value_of("position_m");
  const double second_m = -first_m * value_of("other_position_ratio");
  // 20 N of noise over a few hundred readings beyond each stop, of 10 kN and more.
  EXPECT_NEAR(std::max(first_m, second_m), kPosition_m, 0.001 * kPosition_m);
  EXPECT_NEAR(std::min(first_m, second_m), kOtherPosition_m, -0.001 * kOtherPosition_m);
  EXPECT_NEAR(first_m > 0.0 ? first_n_per_m : second_n_per_m, kStop_n_per_m, 0.01 * kStop_n_per_m);
  EXPECT_NEAR(first_m > 0.0 ? second_n_per_m : first_n_per_m, kOtherStop_n_per_m, 0.01 * kOtherStop_n_per_m);
}

TEST(Stops, OnOneSideHaveNoOther) {
  const Diagnosis diagnosis = diagnosis_with_stops(false);
  EXPECT_TRUE(report::names_a_cause(diagnosis.report.verdict));
  ASSERT_THAT(causes_of(diagnosis), ElementsAre("contact"));
  const report::RankedCause& cause = diagnosis.report.ranking.front();
  EXPECT_NEAR(find_parameter(cause, "stiffness_n_per_m")->value, kStop_n_per_m, 0.01 * kStop_n_per_m);
  EXPECT_NEAR(find_parameter(cause, "position_m")->value, kPosition_m, 0.001 * kPosition_m);
  // Of what would be 20 N of noise over the same readings.
  EXPECT_LT(find_parameter(cause, "other_stiffness_ratio")->value, 0.01);
}

/// A tendon that pulls one way only, from rest on, beside a frame that is softer than the model: two stops at rest that
/// differ would be the same beside another stiffness.
TEST(Stops, OneAtRestIsOneTendon) {
  constexpr double kTendon_n_per_m = 8.0e4;
  const Recording recording = made_recording(made_motion_m, [](double t) {
    const double x = made_motion_m(t);
    return 0.97 * kMadeStiffness_n_per_m * x + kTendon_n_per_m * std::max(0.0, x);
  });
  const Diagnosis diagnosis = diagnosis_of(made_model(), recording);
  EXPECT_EQ(diagnosis.report.verdict, report::Verdict::named);
  ASSERT_THAT(causes_of(diagnosis), ElementsAre("contact"));
  const report::RankedCause& cause = diagnosis.report.ranking.front();
  EXPECT_EQ(find_parameter(cause, "other_stiffness_ratio")->value, 0.0);
  // 20 N of noise over 6000 readings, of a force of 1 kN; the form of a stop is known no better than a twentieth.
  EXPECT_NEAR(find_parameter(cause, "stiffness_n_per_m")->value, kTendon_n_per_m, 0.01 * kTendon_n_per_m);
  EXPECT_GT(find_parameter(cause, "stiffness_n_per_m")->ci95->low, 0.9 * kTendon_n_per_m);
}

/// With no spring between them, stops are the specimen itself, beyond a gap: a fifth softer than the model here. The
/// gap is not in the middle of what the transducer reads, whose zero is off, nor is the zero of the load cell right.
TEST(Stops, WithoutASpringBetweenThemAreAGap) {
  constexpr double kGap_m = 4e-4;
  constexpr double kZero_m = 5e-5;
  const Recording recording = made_recording([](double t) { return made_motion_m(t) + kZero_m; },
                                             [kGap_m](double t) {
                                               const double x = made_motion_m(t);
                                               const double beyond_m = x - std::clamp(x, -kGap_m, kGap_m);
                                               return 0.8 * kMadeStiffness_n_per_m * beyond_m + 200.0;
                                             });
  const Diagnosis diagnosis = diagnosis_of(made_model(), recording);
  EXPECT_TRUE(report::names_a_cause(diagnosis.report.verdict));
  EXPECT_THAT(causes_of(diagnosis), IsSupersetOf({"gap", "stiffness_error"}));
  EXPECT_THAT(causes_of(diagnosis), Not(Contains("contact")));
  for (const report::RankedCause& cause : diagnosis.report.ranking) {
    if (!cause.is_cause || cause.effect != "gap") continue;
    // 20 N of noise over 6000 readings are 0.1 um of such a spring; a millimetre of motion lies between two readings.
    EXPECT_NEAR(find_parameter(cause, "gap_m")->value, kGap_m, 0.01 * kGap_m);
  }
}

}  // namespace
}  // namespace hybridtest
