#include "diagnosis/verdict/next_experiment.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hybridtest {
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
  EXPECT_THAT(splitting({{force_sensor, "bias"}, {force_sensor, "drift"}}), HasSubstr("stretch of rest"));
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

TEST(NextExperiment, UnknownGapAtTheSpecimenAsksForSlowCycles) {
  EXPECT_THAT(experiment_for_unknown(specimen), StartsWith("Slow cycles"));
  EXPECT_NE(experiment_for_unknown(specimen), experiment_for_unknown(transfer_system));
}

}  // namespace
}  // namespace hybridtest
