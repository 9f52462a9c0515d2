#include "scenario/bridging_section.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/scenario/scenario_file.hpp"

namespace hybridtest {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kRealTime = "time.mode=real_time";

class BridgingSection : public testing::Test {
 protected:
  [[nodiscard]] std::vector<std::string> errors(const std::vector<std::string>& overrides) const {
    return file_.errors(kScenarioText, overrides);
  }
  ScenarioFile file_;
};

TEST_F(BridgingSection, HasDefaults) {
  const Scenario scenario = file_.read(kScenarioText, {kRealTime});
  const BridgingSettings& bridging = scenario.real_time.bridging;
  EXPECT_EQ(bridging.type, BridgeType::polynomial);
  EXPECT_EQ(bridging.order, 1);
  EXPECT_EQ(bridging.deadline, std::chrono::microseconds{500});
  EXPECT_EQ(bridging.most_in_a_row, 3);
  EXPECT_FALSE(bridging.start_anyway);
  EXPECT_TRUE(scenario.substructures[0].site.loop.trajectory.keeps_time);
  EXPECT_EQ(scenario.substructures[0].site.loop.trajectory.missed_most, 3);
}

TEST_F(BridgingSection, TakesWhatIsGiven) {
  const Scenario scenario = file_.read(
      kScenarioText,
      {kRealTime, "bridging={type: polynomial, order: 3, deadline_s: 2.0e-4, most_in_a_row: 7, start_anyway: true}",
       "real_time={priority: 60, cpu: 1}", "substructures[storey_2].real_time={priority: 50}"});
  const BridgingSettings& bridging = scenario.real_time.bridging;
  EXPECT_EQ(bridging.order, 3);
  EXPECT_EQ(bridging.deadline, std::chrono::microseconds{200});
  EXPECT_EQ(bridging.most_in_a_row, 7);
  EXPECT_TRUE(bridging.start_anyway);
  EXPECT_EQ(scenario.real_time.coordinator.priority, 60);
  EXPECT_EQ(scenario.real_time.coordinator.cpu, 1);
  EXPECT_EQ(scenario.substructures[1].real_time.priority, 50);
}

TEST_F(BridgingSection, DeadlineIsWithinTheStep) {
  EXPECT_THAT(errors({kRealTime, "bridging={deadline_s: 0.001}"}), ElementsAre(HasSubstr("deadline_s")));
  EXPECT_THAT(errors({kRealTime, "bridging={deadline_s: 0.000999}"}), IsEmpty());
}

TEST_F(BridgingSection, IsUnknownToOtherModes) {
  EXPECT_THAT(errors({"bridging={type: hold}"}), ElementsAre(HasSubstr("bridging")));
  EXPECT_THAT(errors({"time.mode=paced", "substructures[storey_2].real_time={priority: 50}"}),
              ElementsAre(HasSubstr("real_time")));
}

TEST_F(BridgingSection, WhatWaitsIsRefusedInRealTime) {
  EXPECT_THAT(errors({kRealTime, "substructures[storey_1].trajectory={type: ramp_and_hold}"}),
              ElementsAre(HasSubstr("ramp_and_hold waits for its targets")));
  EXPECT_THAT(errors({kRealTime, "time.time_scale=2"}), ElementsAre(HasSubstr("time_scale")));
  EXPECT_THAT(
      errors({kRealTime, "substructures[storey_1].interlocks={tracking_error: {action: hold, clears: when_cleared}}"}),
      ElementsAre(HasSubstr("in real time the test does not wait")));
}

}  // namespace
}  // namespace hybridtest
