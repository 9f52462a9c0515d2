#include "diagnosis/diagnose.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/report/diagnosis_json.hpp"
#include "made_recording.hpp"

namespace hybridtest {
namespace {

using report::Verdict;

double spring_n(double time_s) { return kMadeStiffness_n_per_m * made_motion_m(time_s); }

Diagnosis diagnosis_of(const Recording& recording, std::size_t threads = 1) {
  DiagnoseSettings settings;
  settings.threads = threads;
  return diagnose(made_model(), {&recording, 1}, settings);
}

bool has_cause(const Diagnosis& diagnosis, std::string_view interface, std::string_view effect) {
  return std::ranges::any_of(diagnosis.report.ranking, [&](const report::RankedCause& cause) {
    return cause.is_cause && cause.interface == interface && cause.effect == effect;
  });
}

TEST(Diagnose, FindsNothingWhereModelAndRecordingAgree) {
  const Diagnosis diagnosis = diagnosis_of(made_recording(made_motion_m, spring_n));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::none);
  EXPECT_TRUE(diagnosis.causes.empty());
}

TEST(Diagnose, NamesAViscousForceAndPutsItAtTheSpecimen) {
  const auto velocity = [](double t) { return (made_motion_m(t + 1e-5) - made_motion_m(t - 1e-5)) / 2e-5; };
  const Diagnosis diagnosis =
      diagnosis_of(made_recording(made_motion_m, [&](double t) { return spring_n(t) + 3.0e4 * velocity(t); }));
  ASSERT_FALSE(diagnosis.report.where.empty());
  EXPECT_EQ(diagnosis.report.where.front().interface, "specimen");
  EXPECT_GT(diagnosis.report.where.front().share, 0.95);
  EXPECT_TRUE(has_cause(diagnosis, "specimen", "viscous_damping"));
  EXPECT_GT(diagnosis.report.interface_shrink->explainable_fraction.value(), 0.99);
}

TEST(Diagnose, NamesACoarseConverterBesideABias) {
  Recording recording = made_recording(made_motion_m, [](double t) { return spring_n(t) + 900.0; });
  double largest = 0.0;
  for (const double force_n : recording.dofs[0].of(Channel::measured_force)) {
    largest = std::max(largest, std::abs(force_n));
  }
  const double step_n = 0.05 * largest;
  for (double& force_n : recording.dofs[0].of(Channel::measured_force)) {
    force_n = step_n * std::round(force_n / step_n);
  }
  const Diagnosis diagnosis = diagnosis_of(recording);
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
  EXPECT_TRUE(has_cause(diagnosis, "force_sensor", "quantization"));
  EXPECT_TRUE(has_cause(diagnosis, "force_sensor", "bias"));
  EXPECT_EQ(diagnosis.report.where.front().interface, "force_sensor");
  ASSERT_EQ(diagnosis.causes.size(), 2U);
  EXPECT_NEAR(diagnosis.causes.back().values[0], step_n, 1e-3 * step_n) << "coarsened last";
}

TEST(Diagnose, AnswersWithTheSetWhereASpringCannotTell) {
  // Of a linear spring a load cell that reads a tenth too much and a spring that is a tenth stiffer are the same.
  const Diagnosis diagnosis = diagnosis_of(made_recording(made_motion_m, [](double t) { return 1.1 * spring_n(t); }));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::set);
  EXPECT_TRUE(has_cause(diagnosis, "specimen", "stiffness_error"));
  EXPECT_TRUE(has_cause(diagnosis, "force_sensor", "gain"));
  EXPECT_FALSE(diagnosis.report.next_experiment.empty());
}

TEST(Diagnose, TellsADisplacementSensorFromAnActuatorByTheForce) {
  // The transducer reads a tenth too much of a motion that is as commanded: the force knows.
  const Diagnosis diagnosis = diagnosis_of(made_recording([](double t) { return 1.1 * made_motion_m(t); }, spring_n));
  EXPECT_TRUE(has_cause(diagnosis, "displacement_sensor", "gain"));
  EXPECT_FALSE(has_cause(diagnosis, "transfer_system", "gain"));
  EXPECT_EQ(diagnosis.report.where.front().interface, "displacement_sensor");
}

TEST(Diagnose, SaysUnknownWhereTheLibraryHasNothing) {
  const Diagnosis diagnosis = diagnosis_of(
      made_recording(made_motion_m, [](double t) { return spring_n(t) + 2000.0 * std::sin(40.0 * t + std::sin(t)); }));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::unknown);
  EXPECT_TRUE(diagnosis.causes.empty());
  EXPECT_FALSE(diagnosis.report.next_experiment.empty());
}

TEST(Diagnose, CannotTellFromAForceAlone) {
  Recording recording = made_recording(made_motion_m, spring_n);
  recording.dofs[0].of(Channel::command_displacement).clear();
  recording.dofs[0].of(Channel::measured_displacement).clear();
  EXPECT_EQ(diagnosis_of(recording).report.verdict, Verdict::not_excited);
}

TEST(Diagnose, GivesTheSameBytesOnOneThreadAndOnTwo) {
  const Recording recording = made_recording(made_motion_m, [](double t) { return 1.2 * spring_n(t); });
  EXPECT_EQ(diagnosis_json(diagnosis_of(recording, 1)), diagnosis_json(diagnosis_of(recording, 2)));
}

}  // namespace
}  // namespace hybridtest
