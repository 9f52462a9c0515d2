#include "diagnosis/identification/repetition.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "diagnosis/diagnose.hpp"
#include "tests/unit/diagnosis/answers.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

/// The same test, recorded more than once. What differs between the recordings is no gap.
namespace hybridtest {
namespace {

using report::Verdict;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A spring that is stiffer than the model's by a ratio, and rubs. The motion is always the same.
Recording of_spring(double stiffer, double friction_n, std::uint64_t seed) {
  return made_recording(
      made_motion_m,
      [=](double t) {
        return (1.0 + stiffer) * kMadeStiffness_n_per_m * made_motion_m(t) +
               std::copysign(friction_n, made_velocity_m_per_s(t));
      },
      20.0, seed);
}

Diagnosis diagnosis_of_all(const std::vector<Recording>& recordings) {
  DiagnoseSettings settings;
  settings.threads = 2;
  return diagnose(made_model(), recordings, settings);
}

/// The stiffness differs from one time to the next, about what the model says.
TEST(Repetition, WhatDiffersBetweenRepetitionsIsNoGap) {
  const Diagnosis both = diagnosis_of_all({of_spring(-0.08, 0.0, 3), of_spring(0.08, 0.0, 4)});
  EXPECT_EQ(both.report.verdict, Verdict::none);
  EXPECT_THAT(both.report.corrections, IsEmpty());
  // 16 % over the square root of two, of the smaller force.
  EXPECT_THAT(both.report.notes, Contains(HasSubstr("Recordings of the same test scatter by 12")));
  // Control: each of them alone has one.
  for (const double stiffer : {-0.08, 0.08}) {
    EXPECT_THAT(causes_of(diagnosis_of_all({of_spring(stiffer, 0.0, 3)})), Contains("stiffness_error")) << stiffer;
  }
}

/// A friction that is always there, under a stiffness that differs.
TEST(Repetition, CauseIsNamedThatLeavesNoMoreThanTheDifference) {
  constexpr double kFriction_n = 4000.0;
  const Diagnosis both = diagnosis_of_all({of_spring(-0.02, kFriction_n, 3), of_spring(0.02, kFriction_n, 4)});
  EXPECT_EQ(both.report.verdict, Verdict::named);
  ASSERT_THAT(causes_of(both), ElementsAre("coulomb_friction"));
  // Its corners are smoothed by 1 %.
  EXPECT_NEAR(both.causes.front().values.front(), kFriction_n, 0.02 * kFriction_n);
}

TEST(Repetition, IsNoneWithOtherInputsOrAHistory) {
  Segment first;
  first.inputs = {.names = {"current_a", "temperature_c"}, .values = {1.0, 20.0, 1.0, 21.0}};
  Segment second = first;
  EXPECT_TRUE(may_repeat(first, second));
  second.inputs.values[2] = 1.02;
  EXPECT_FALSE(may_repeat(first, second)) << "a current that differs by 1.4 % of its root mean square";
  second = first;
  second.history = std::make_shared<const Segment>(first);
  EXPECT_FALSE(may_repeat(first, second));
  second = first;
  second.to = Channel::measured_force;
  EXPECT_FALSE(may_repeat(first, second));
}

}  // namespace
}  // namespace hybridtest
