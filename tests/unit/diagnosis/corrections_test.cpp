#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "diagnosis/diagnose.hpp"
#include "diagnosis/page/diagnosis_json.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

/// Numbers of the user's model that are slightly off: corrected, and no causes.
namespace hybridtest {
namespace {

using report::Verdict;
using testing::HasSubstr;
using testing::Not;
using testing::UnorderedElementsAre;

double slope(const std::function<double(double)>& of, double time_s) {
  return (of(time_s + 1e-5) - of(time_s - 1e-5)) / 2e-5;
}

/// A site that differs from made_model() in the gain of its actuator, the stiffness of its spring and a dashpot.
Recording site_with(double gain, double stiffness_ratio, double damping_n_s_per_m) {
  const auto moved_m = [gain](double t) { return gain * made_motion_m(t); };
  return made_recording(moved_m, [=](double t) {
    return stiffness_ratio * kMadeStiffness_n_per_m * moved_m(t) + damping_n_s_per_m * slope(moved_m, t);
  });
}

Diagnosis diagnosis_of(const Recording& recording, const VerdictPolicy& policy = {}) {
  DiagnoseSettings settings;
  settings.threads = 2;
  settings.policy = policy;
  return diagnose(made_model(), {&recording, 1}, settings);
}

std::vector<std::string> names_in(const std::vector<report::RankedCause>& entries, bool causes_alone) {
  std::vector<std::string> names;
  for (const report::RankedCause& entry : entries) {
    if (!causes_alone || entry.is_cause) names.push_back(entry.interface + " " + entry.effect);
  }
  return names;
}

// The dashpot's force is 1.4 % of the spring's.
constexpr double kSmallDamping_n_s_per_m = 3.0e3;

TEST(Corrections, NumbersSlightlyOffAreNone) {
  const Diagnosis diagnosis = diagnosis_of(site_with(1.02, 0.98, kSmallDamping_n_s_per_m));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::none);
  EXPECT_THAT(names_in(diagnosis.report.ranking, true), testing::IsEmpty());
  EXPECT_THAT(names_in(diagnosis.report.corrections, false),
              UnorderedElementsAre("transfer_system gain", "specimen stiffness_error", "specimen viscous_damping"));
  for (const report::RankedCause& number : diagnosis.report.corrections) {
    // Within the noise: 1 um of 20 mm, 20 N of 40 kN, over thousands of samples.
    if (number.effect == "gain") {
      EXPECT_NEAR(number.parameters[0].value, 0.02, 1e-4);
    }
    if (number.effect == "stiffness_error") {
      EXPECT_NEAR(number.parameters[1].value, -0.02 * kMadeStiffness_n_per_m, 1e-3 * kMadeStiffness_n_per_m);
    }
    if (number.effect == "viscous_damping") {
      EXPECT_NEAR(number.parameters[0].value, kSmallDamping_n_s_per_m, 30.0);
    }
  }
  // The augmented model has the right numbers, and the gap is gone with them.
  EXPECT_EQ(diagnosis.causes.size(), 3U);
  EXPECT_LT(diagnosis.report.interface_shrink->nrmse_after, 1.2 * diagnosis.report.interface_shrink->floor_nrmse);
  EXPECT_THAT(diagnosis_json(diagnosis), HasSubstr("\"corrections\": [\n  {"));
}

TEST(Corrections, NumbersFurtherOffAreCauses) {
  const Diagnosis diagnosis = diagnosis_of(site_with(1.02, 1.08, kSmallDamping_n_s_per_m));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
  EXPECT_THAT(names_in(diagnosis.report.ranking, true), UnorderedElementsAre("specimen stiffness_error"));
  EXPECT_THAT(names_in(diagnosis.report.corrections, false),
              UnorderedElementsAre("transfer_system gain", "specimen viscous_damping"));
}

TEST(Corrections, PolicyDecidesWhatIsSlightlyOff) {
  const Recording recording = site_with(1.02, 0.98, kSmallDamping_n_s_per_m);
  const Diagnosis diagnosis = diagnosis_of(recording, {.numbers_within = 0.0});
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
  EXPECT_THAT(names_in(diagnosis.report.ranking, true),
              UnorderedElementsAre("transfer_system gain", "specimen stiffness_error", "specimen viscous_damping"));
  EXPECT_THAT(diagnosis_json(diagnosis), HasSubstr("\"corrections\": []"));
}

TEST(Corrections, WrongGainOfTheActuatorEarnsASensorNothing) {
  // A lag of the transducer looks like this damping in the force. It must not lead for the wrong gain and delay of the
  // actuator, numbers that a fit of the transducer's lag may correct besides.
  const auto moved_m = [](double t) { return 0.96 * made_motion_m(t - 0.0005); };
  const Recording recording = made_recording(
      moved_m, [&](double t) { return kMadeStiffness_n_per_m * moved_m(t) + 1.0e4 * slope(moved_m, t); });
  const Diagnosis diagnosis = diagnosis_of(recording);
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
  EXPECT_THAT(names_in(diagnosis.report.ranking, true), Not(testing::Contains(HasSubstr("displacement_sensor"))));
  EXPECT_THAT(names_in(diagnosis.report.ranking, true), testing::Contains("specimen viscous_damping"));
}

}  // namespace
}  // namespace hybridtest
