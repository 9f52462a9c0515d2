#include "diagnosis/verdict/experiments.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>

#include "diagnosis/diagnose.hpp"
#include "diagnosis/page/diagnosis_json.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

namespace hybridtest {
namespace {

using report::Verdict;
using testing::HasSubstr;

struct Noise {
  double displacement_m = 1e-6;
  double force_n = 20.0;
};

/// The motion of made_motion_m(), `scale` times, against a spring `stiffness` times the model's.
Recording scaled_recording(double scale, double stiffness, const Noise& noise) {
  Recording recording;
  recording.file = "scaled.csv";
  recording.sample_period_s = kSitePeriod_s;
  recording.samples = 6000;
  recording.dofs.resize(1);
  Random random{5};
  for (std::size_t i = 0; i < recording.samples; ++i) {
    const double motion_m = scale * made_motion_m(kSitePeriod_s * static_cast<double>(i));
    recording.dofs[0].of(Channel::target_displacement).push_back(motion_m);
    recording.dofs[0].of(Channel::command_displacement).push_back(motion_m);
    recording.dofs[0].of(Channel::measured_displacement).push_back(motion_m + noise.displacement_m * random.normal());
    recording.dofs[0]
        .of(Channel::measured_force)
        .push_back(stiffness * kMadeStiffness_n_per_m * motion_m + noise.force_n * random.normal());
  }
  return recording;
}

Diagnosis diagnosis_of(const Recording& recording, const SiteModel& model = made_model()) {
  return diagnose(model, {&recording, 1}, {});
}

const report::InterfaceGap& gap_at(const Diagnosis& diagnosis, std::string_view interface) {
  return *std::ranges::find(diagnosis.report.where, interface, &report::InterfaceGap::interface);
}

// Motion of 0.015 m rms; 1e-5 of it is a seventh of the displacement sensor's noise.
constexpr double kBelowNoise = 1e-5;

TEST(NotExcited, IsReportedWithoutMotion) {
  const Diagnosis diagnosis = diagnosis_of(scaled_recording(0.0, 1.0, {}));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::not_excited);
  EXPECT_TRUE(diagnosis.causes.empty());
  EXPECT_THAT(diagnosis.report.next_experiment, HasSubstr("Record a test with motion"));
}

TEST(NotExcited, IsReportedWhenWrongSpringWouldNotShow) {
  const Diagnosis diagnosis = diagnosis_of(scaled_recording(kBelowNoise, 1.5, {}));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::not_excited);
  EXPECT_THAT(diagnosis.report.next_experiment, HasSubstr("times the motion"));
  EXPECT_FALSE(gap_at(diagnosis, "specimen").is_judged);
  EXPECT_FALSE(gap_at(diagnosis, "transfer_system").is_judged);
  EXPECT_THAT(gap_at(diagnosis, "specimen").why_not, HasSubstr("measured_displacement_m moves by"));
  // The controller's own law has no noise, however small its signals are.
  EXPECT_TRUE(gap_at(diagnosis, "compensator").is_judged);
  const std::string json = diagnosis_json(diagnosis);
  EXPECT_THAT(json, testing::Not(HasSubstr("\"interface\": \"specimen\""))) << "`where` holds what is judged";
  EXPECT_THAT(json, HasSubstr("\"specimen\": \"measured_displacement_m moves by"));
}

TEST(NotExcited, DependsOnNoiseAndNotOnSize) {
  // The same motion before sensors that are 10 000 times quieter.
  const Noise quiet{.displacement_m = 1e-10, .force_n = 0.002};
  EXPECT_NE(diagnosis_of(scaled_recording(kBelowNoise, 1.5, quiet)).causes.size(), 0U);
  const Diagnosis agrees = diagnosis_of(scaled_recording(kBelowNoise, 1.0, quiet));
  EXPECT_EQ(agrees.report.verdict, Verdict::none);
  EXPECT_TRUE(gap_at(agrees, "specimen").is_judged);
}

TEST(NotExcited, IsNotReportedForAnOrdinaryTestWithoutGap) {
  // A hundredth of the motion and noise: signals of 40 dB, as noisy as tests get.
  for (const double noise : {1.0, 100.0}) {
    const Diagnosis diagnosis =
        diagnosis_of(scaled_recording(1.0, 1.0, {.displacement_m = 1e-6 * noise, .force_n = 2.0 * noise}));
    EXPECT_EQ(diagnosis.report.verdict, Verdict::none);
    EXPECT_TRUE(diagnosis.report.next_experiment.empty());
    EXPECT_TRUE(gap_at(diagnosis, "specimen").is_judged);
    EXPECT_TRUE(gap_at(diagnosis, "transfer_system").is_judged);
  }
}

TEST(NotExcited, ForceWithinNoiseExcludesOnlyTheSpecimen) {
  SiteModel model = made_model();
  model.make_law = [] { return std::make_unique<Elastic>(100.0); };  // 1.5 N rms against 20 N
  const Diagnosis diagnosis = diagnosis_of(scaled_recording(1.0, 150.0 / kMadeStiffness_n_per_m, {}), model);
  EXPECT_EQ(diagnosis.report.verdict, Verdict::none);
  EXPECT_TRUE(gap_at(diagnosis, "transfer_system").is_judged);
  EXPECT_FALSE(gap_at(diagnosis, "specimen").is_judged);
  EXPECT_THAT(gap_at(diagnosis, "specimen").why_not, HasSubstr("measured_force_n changes by"));
}

}  // namespace

namespace {

using enum EffectInterface;
using testing::HasSubstr;
using testing::StartsWith;

struct Named {
  EffectInterface interface;
  std::string_view effect;
};

std::string splitting(std::initializer_list<Named> names) {
  std::vector<const EffectType*> effects;
  for (const Named& name : names) effects.push_back(find_effect(name.interface, name.effect));
  EXPECT_THAT(effects, testing::Each(testing::NotNull()));
  return experiment_that_splits(effects);
}

TEST(NextExperiment, OneEffectNeedsNone) {
  EXPECT_EQ(splitting({{specimen, "gap"}}), "");
  EXPECT_EQ(splitting({}), "");
}

TEST(NextExperiment, MassAsksForAnAirRun) {
  EXPECT_THAT(splitting({{specimen, "inertia"}, {force_sensor, "lag"}}), StartsWith("Air run"));
}

TEST(NextExperiment, LoadCellAgainstSpecimenAsksForADeadWeight) {
  EXPECT_THAT(splitting({{specimen, "stiffness_error"}, {force_sensor, "gain"}}), HasSubstr("dead weight"));
}

TEST(NextExperiment, SensorLagAgainstSpecimenAsksForHalfTheRate) {
  EXPECT_THAT(splitting({{specimen, "viscous_damping"}, {force_sensor, "lag"}}), HasSubstr("half the rate"));
}

TEST(NextExperiment, DisplacementSensorAsksForASecondTransducer) {
  EXPECT_THAT(splitting({{displacement_sensor, "gain"}, {transfer_system, "gain"}}), HasSubstr("second displacement"));
}

TEST(NextExperiment, ArrivalAsksForAComparisonOfClocks) {
  EXPECT_THAT(splitting({{network, "clock_drift"}, {network, "latency"}}), HasSubstr("Compare the clocks"));
  EXPECT_THAT(splitting({{network, "clock_drift"}, {network, "clock_offset"}}), HasSubstr("Compare the clocks"));
}

TEST(NextExperiment, ClockDriftIsNoDegradation) {
  EXPECT_THAT(splitting({{network, "clock_drift"}, {transfer_system, "gain"}}), HasSubstr("half the rate"));
}

TEST(NextExperiment, RateAsksForHalfTheRate) {
  EXPECT_THAT(splitting({{transfer_system, "delay"}, {transfer_system, "bandwidth"}}), HasSubstr("half the rate"));
  EXPECT_THAT(splitting({{specimen, "coulomb_friction"}, {specimen, "stribeck_friction"}}), HasSubstr("half the rate"));
}

TEST(NextExperiment, OffsetAsksForRest) {
  EXPECT_THAT(splitting({{force_sensor, "bias"}, {force_sensor, "drift"}}), HasSubstr("some seconds at rest"));
}

TEST(NextExperiment, DegradationAsksForEqualCycles) {
  EXPECT_THAT(splitting({{specimen, "stiffness_degradation"}, {specimen, "pinching"}}), HasSubstr("same cycle"));
}

TEST(NextExperiment, ComplianceAsksForAnAirRun) {
  EXPECT_THAT(splitting({{transfer_system, "compliance"}, {transfer_system, "gain"}}), StartsWith("Air run"));
}

TEST(NextExperiment, PositionAsksForASlowRamp) {
  EXPECT_THAT(splitting({{specimen, "gap"}, {specimen, "backlash"}}), StartsWith("Slow ramp"));
}

TEST(NextExperiment, AmplitudeAsksForASweep) {
  EXPECT_THAT(splitting({{specimen, "yielding"}, {specimen, "bouc_wen_hysteresis"}}), StartsWith("Amplitude sweep"));
  EXPECT_THAT(splitting({{specimen, "cubic_stiffness"}, {specimen, "stiffness_error"}}), StartsWith("Amplitude sweep"));
}

TEST(NextExperiment, LoadCellAtItsLimitAsksForAWiderRange) {
  EXPECT_THAT(experiment_within_range({find_effect(specimen, "gap"), find_effect(force_sensor, "saturation")}),
              HasSubstr("load cell with a wider range"));
  EXPECT_EQ(experiment_within_range({find_effect(specimen, "gap"), find_effect(force_sensor, "gain")}), "");
}

TEST(NextExperiment, UnknownGapAtTheSpecimenAsksForSlowCycles) {
  EXPECT_THAT(experiment_for_unknown(specimen, true), StartsWith("Slow cycles"));
  EXPECT_NE(experiment_for_unknown(specimen, true), experiment_for_unknown(transfer_system, true));
  EXPECT_THAT(experiment_for_unknown(specimen, false), StartsWith("Repeat this test"));
}

}  // namespace

}  // namespace hybridtest
