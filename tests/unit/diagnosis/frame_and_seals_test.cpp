#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "diagnosis/diagnose.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "tests/unit/diagnosis/answers.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"
#include "tests/unit/diagnosis/made_seals.hpp"

/// What lies between the command and the specimen: a reaction frame that gives way, and the seals of an actuator.
namespace hybridtest {
namespace {

using testing::ElementsAre;

constexpr double kCompliance_m_per_n = 3.0e-8;
constexpr double kClosing_n = 5.0e3;

std::unique_ptr<Law> yielding() {
  return std::make_unique<Bilinear>(Bilinear::Parameters{
      .stiffness_n_per_m = kMadeStiffness_n_per_m, .yield_force_n = 3.0e4, .hardening_ratio = 0.07});
}

/// A frame that gives way under the force of the sample before; `closed` times as much once its joints have closed.
Diagnosis diagnosis_on_frame(SiteModel model, double closed) {
  const std::unique_ptr<Law> law = model.make_law();
  double force_n = 0.0;
  double displacement_m = 0.0;
  return diagnosis_of(model,
                      made_recording(
                          [&](double t) {
                            const double joints_n = (1.0 - closed) * kClosing_n * std::tanh(force_n / kClosing_n);
                            displacement_m = made_motion_m(t) - kCompliance_m_per_n * (closed * force_n + joints_n);
                            return displacement_m;
                          },
                          [&](double /*t*/) {
                            force_n = law->trial(displacement_m, 0.0);
                            law->commit();
                            return force_n;
                          }));
}

TEST(ReactionFrame, JointsThatCloseAreFoundWithIt) {
  SiteModel model = made_model();
  model.make_law = yielding;
  const Diagnosis diagnosis = diagnosis_on_frame(model, 0.6);
  EXPECT_EQ(diagnosis.report.verdict, report::Verdict::named);
  ASSERT_THAT(causes_of(diagnosis), ElementsAre("compliance"));
  const report::RankedCause& frame = diagnosis.report.ranking.front();
  // The force that the frame feels is read with a noise of 20 N.
  EXPECT_NEAR(find_parameter(frame, "compliance_m_per_n")->value, kCompliance_m_per_n, 0.01 * kCompliance_m_per_n);
  EXPECT_NEAR(find_parameter(frame, "closed_joint_ratio")->value, 0.6, 0.02);
  EXPECT_NEAR(find_parameter(frame, "closing_force_n")->value, kClosing_n, 0.02 * kClosing_n);
}

/// On a spring a frame is a gain, but for the sample that its force is late: 12 micrometres here, and the noise is one.
/// At the lower rate of the search that sample has to be the recorded one.
TEST(ReactionFrame, OnASpringIsASetWithAGain) {
  const Diagnosis diagnosis = diagnosis_on_frame(made_model(), 1.0);
  EXPECT_EQ(diagnosis.report.verdict, report::Verdict::set);
  ASSERT_THAT(causes_of(diagnosis), ElementsAre("compliance", "gain"));
  EXPECT_NEAR(find_parameter(diagnosis.report.ranking.front(), "compliance_m_per_n")->value, kCompliance_m_per_n,
              0.001 * kCompliance_m_per_n);
}

TEST(Seals, AreFoundWhateverTheSlipLooksLike) {
  constexpr double kStick_m = 5.0e-4;
  MadeSeals held{kStick_m, 0.2 * kStick_m};
  double displacement_m = 0.0;
  const Diagnosis diagnosis = diagnosis_of(
      made_model(), made_recording([&](double t) { return displacement_m = held.next_m(made_motion_m(t)); },
                                   [&](double) { return kMadeStiffness_n_per_m * displacement_m; }));
  ASSERT_THAT(causes_of(diagnosis), ElementsAre("stiction"));
  const report::RankedCause& seals = diagnosis.report.ranking.front();
  // It slips within five samples; the effect's slip dies away with a constant instead, so the two differ by up to a
  // fifth of what it is behind.
  EXPECT_NEAR(find_parameter(seals, "stick_displacement_m")->value, kStick_m, 0.1 * kStick_m);
  EXPECT_LT(find_parameter(seals, "slip_time_s")->value, 5.0 * kSitePeriod_s);
  EXPECT_GT(find_parameter(seals, "slip_time_s")->value, kSitePeriod_s);
}

}  // namespace
}  // namespace hybridtest
