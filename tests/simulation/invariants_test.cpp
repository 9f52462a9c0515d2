#include "tests/simulation/invariants.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

/// Controls: each invariant holds for a valid run and reports a violation when one record of the run is changed.
namespace hybridtest {
namespace {

class InvariantsTest : public testing::Test {
 protected:
  double& value(const std::string& participant, const std::string& table, std::size_t row, const std::string& column) {
    KeptRows& rows = run_.table(participant, table);
    return rows.at(row, rows.column(column));
  }
  static void nudge(double& number) { number = std::nextafter(number, std::numeric_limits<double>::infinity()); }

  Scenario scenario_ = shipped_scenario("two_storey_one_site", {kPulse, "time.duration_s=0.3", "excitation.scale=2.0"});
  DrawnCase drawn_{"two_storey_one_site", {}, {}, false};
  KeptSimulation reference_ = keep_simulation(scenario_, SimulationSettings{});
  KeptSimulation run_ = reference_;
};

TEST_F(InvariantsTest, HoldForAGoodRun) {
  EXPECT_EQ(steps_violated(run_, scenario_), Violations{});
  EXPECT_EQ(limits_violated(run_, scenario_), Violations{});
  EXPECT_EQ(energy_violated(run_, scenario_), Violations{});
  EXPECT_EQ(ending_violated(run_, reference_, scenario_, drawn_), Violations{});
  EXPECT_EQ(history_violated(run_, reference_), Violations{});
}

TEST_F(InvariantsTest, DetectsMissingStep) {
  run_.table("coordinator", "steps").drop(100);
  EXPECT_FALSE(steps_violated(run_, scenario_).empty());
}

TEST_F(InvariantsTest, DetectsMissingLastStep) {
  run_.table("coordinator", "steps").drop(300);
  EXPECT_FALSE(steps_violated(run_, scenario_).empty());
}

TEST_F(InvariantsTest, DetectsStepTakenTwiceBySubstructure) {
  value("storey_2", "steps", 100, "step") = 99.0;
  EXPECT_FALSE(steps_violated(run_, scenario_).empty());
}

TEST_F(InvariantsTest, DetectsMissingExchange) {
  run_.table("coordinator", "exchanges").drop(7);
  EXPECT_FALSE(steps_violated(run_, scenario_).empty());
}

TEST_F(InvariantsTest, DetectsSubstructureMovedElsewhere) {
  nudge(value("storey_2", "steps", 100, "displacement_floor_2_relative_to_floor_1_m"));
  EXPECT_FALSE(steps_violated(run_, scenario_).empty());
}

TEST_F(InvariantsTest, DetectsForceThatWasNotMeasured) {
  nudge(value("coordinator", "steps", 100, "restoring_force_floor_1_n"));
  EXPECT_FALSE(steps_violated(run_, scenario_).empty());
}

TEST_F(InvariantsTest, DetectsCommandBeyondLimit) {
  value("storey_1", "control", 100, "command_displacement_m") = 0.2001;
  EXPECT_FALSE(limits_violated(run_, scenario_).empty());
}

TEST_F(InvariantsTest, DetectsJumpingCommand) {
  // 1.5 m/s at 2 kHz: the control rate of 1024 Hz is rounded up to two periods a step.
  value("storey_1", "control", 100, "command_displacement_m") += 0.0016;
  EXPECT_FALSE(limits_violated(run_, scenario_).empty());
}

TEST_F(InvariantsTest, DetectsCommandThatIsNotANumber) {
  value("storey_1", "control", 100, "command_displacement_m") = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(limits_violated(run_, scenario_).empty());
}

TEST_F(InvariantsTest, DetectsMissingControlPeriod) {
  run_.table("storey_1", "control").drop(100);
  EXPECT_FALSE(limits_violated(run_, scenario_).empty());
}

TEST_F(InvariantsTest, DetectsForceThatWasNotIntegratedByEnergy) {
  value("coordinator", "steps", 200, "restoring_force_floor_1_n") *= 1.0 + 1e-6;
  EXPECT_FALSE(energy_violated(run_, scenario_).empty());
}

TEST_F(InvariantsTest, DetectsForeignDisplacementByEnergy) {
  value("coordinator", "steps", 200, "displacement_floor_2_m") *= 1.0 + 1e-6;
  EXPECT_FALSE(energy_violated(run_, scenario_).empty());
}

TEST_F(InvariantsTest, DetectsSkippedStepByEnergy) {
  run_.table("coordinator", "steps").drop(200);
  EXPECT_FALSE(energy_violated(run_, scenario_).empty());
}

TEST_F(InvariantsTest, DetectsHangingParticipant) {
  run_.result.participants[1].is_done = false;
  EXPECT_FALSE(ending_violated(run_, reference_, scenario_, drawn_).empty());
}

TEST_F(InvariantsTest, DetectsEndWithoutReport) {
  run_.result.coordinator.reason = StopReason::participant_lost;
  drawn_.settings.kills.push_back({"storey_1", {}});
  EXPECT_FALSE(ending_violated(run_, reference_, scenario_, drawn_).empty());
  Event told;
  told.source = "coordinator";
  told.code = EventCode::participant_lost;
  told.subject = "storey_1";
  run_.events.push_back(told);
  EXPECT_TRUE(ending_violated(run_, reference_, scenario_, drawn_).empty());
}

TEST_F(InvariantsTest, DetectsOtherEndDespiteHarmlessFaults) {
  run_.result.coordinator.reason = StopReason::participant_lost;
  Event told;
  told.source = "coordinator";
  told.code = EventCode::participant_lost;
  run_.events.push_back(told);
  EXPECT_FALSE(ending_violated(run_, reference_, scenario_, drawn_).empty());
}

TEST_F(InvariantsTest, DetectsHistoryThatDiffersByOneBit) {
  nudge(value("coordinator", "steps", 300, "velocity_floor_2_m_per_s"));
  EXPECT_FALSE(history_violated(run_, reference_).empty());
}

TEST_F(InvariantsTest, AllowAnyWallTime) {
  value("coordinator", "steps", 300, "wall_time_s") += 1.0;
  EXPECT_TRUE(history_violated(run_, reference_).empty());
}

}  // namespace
}  // namespace hybridtest
