#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "diagnosis/diagnose.hpp"
#include "tests/unit/diagnosis/answers.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

/// A displacement transducer that lags makes the motion late and the force early: a delay of the actuator and a damping
/// of the specimen, in channels that are judged one after the other.
namespace hybridtest {
namespace {

using testing::ElementsAre;

constexpr double kLag_s = 4.0e-4;

/// What a transducer reads of the motion behind one pole, to the first order of T over the periods of the motion.
double read_m(double time_s) { return made_motion_m(time_s - kLag_s); }

TEST(TransducerLag, IsASetWithTheDampingThatItLooksLike) {
  const Diagnosis diagnosis = diagnosis_of(
      made_model(), made_recording(read_m, [](double t) { return kMadeStiffness_n_per_m * made_motion_m(t); }));
  EXPECT_EQ(diagnosis.report.verdict, report::Verdict::set);
  ASSERT_THAT(causes_of(diagnosis), ElementsAre("lag", "viscous_damping"));
  for (const report::RankedCause& cause : diagnosis.report.ranking) {
    if (cause.effect == "lag") {
      EXPECT_NEAR(find_parameter(cause, "time_constant_s")->value, kLag_s, 0.02 * kLag_s);
    }
  }
}

/// An actuator as late, and half the damping that the lag would look like: no lag explains both.
TEST(TransducerLag, IsNoneWhereMotionAndForceDoNotAgreeOnIt) {
  constexpr double kDamping_n_s_per_m = 0.5 * kMadeStiffness_n_per_m * kLag_s;
  const Diagnosis diagnosis = diagnosis_of(made_model(), made_recording(read_m, [](double t) {
                                             return kMadeStiffness_n_per_m * made_motion_m(t - kLag_s) +
                                                    kDamping_n_s_per_m * made_velocity_m_per_s(t - kLag_s);
                                           }));
  EXPECT_THAT(causes_of(diagnosis), ElementsAre("viscous_damping"));
}

}  // namespace
}  // namespace hybridtest
