#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/support/recording_checks.hpp"
#include "tests/support/system_fixture.hpp"

/// Exceeded limits and non-finite values end a test safely, and the records say why.
namespace hybridtest {
namespace {

using ::testing::HasSubstr;
using ::testing::Optional;

class Interlock : public SystemTest {};

TEST_F(Interlock, ExceededLimitEndsTest) {
  StartedProgram run = start_run(shipped_scenario("two_storey_one_site"), "run",
                                 {"--set", "substructures[storey_1].limits.displacement_m=0.002"});
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  EXPECT_THAT(run.standard_error(), HasSubstr("interlock: displacement_limit"));
  EXPECT_THAT(run.standard_output(), HasSubstr("displacement_limit"));

  const RecordedRun record = recorded("run");
  const nlohmann::json summary = record.summary();
  EXPECT_EQ(summary["stop_reason"], "interlock");
  EXPECT_EQ(summary["exit_code"], kExitEndedEarly);
  EXPECT_EQ(summary["data_valid"], true) << summary["data_faults"];
  ASSERT_EQ(summary["interlocks"].size(), 1U);
  EXPECT_EQ(summary["interlocks"][0]["participant"], "storey_1");
  EXPECT_EQ(summary["interlocks"][0]["limit"], 0.002);
  EXPECT_GT(summary["interlocks"][0]["observed"], 0.002);
  EXPECT_EQ(record.events("storey_1", EventCode::interlock_tripped).size(), 1U);
  EXPECT_LT(record.last_step("coordinator"), 31000.0);
  // No command ever passes the limit, and the actuator is brought back.
  for (const double command_m : record.column("storey_1", "control", "command_displacement_m")) {
    ASSERT_LE(std::abs(command_m), 0.002);
  }
  expect_rig_came_to_zero(record, "storey_1");
}

TEST_F(Interlock, DivergingMotionEndsTest) {
  StartedProgram run = start_run(system_scenario("falls_over"), "run");
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  EXPECT_THAT(run.standard_error(), HasSubstr("test stopped: not_finite"));
  EXPECT_THAT(run.standard_output(), HasSubstr("A NUMBER WAS NOT FINITE"));

  const RecordedRun record = recorded("run");
  EXPECT_EQ(record.summary()["stop_reason"], "not_finite");
  EXPECT_EQ(record.summary()["data_valid"], true) << record.summary()["data_faults"];
  // The non-finite value was neither commanded nor counted as a step.
  for (const double displacement_m : record.column("coordinator", "steps", "displacement_floor_1_m")) {
    ASSERT_TRUE(std::isfinite(displacement_m));
  }
  for (const double command_m : record.column("storey_1", "control", "command_displacement_m")) {
    ASSERT_TRUE(std::isfinite(command_m));
  }
  expect_rig_came_to_zero(record, "storey_1");
}

TEST_F(Interlock, NonFiniteForceEndsTestAtSite) {
  // So much stiffer than stated that the integration diverges, and its own force overflows first.
  StartedProgram run = start_run(system_scenario("falls_over"), "run",
                                 {"--set", "substructures[storey_1].rig.specimen.stiffness_n_per_m=1.0e12"});
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();

  const RecordedRun record = recorded("run");
  const nlohmann::json summary = record.summary();
  EXPECT_EQ(summary["stop_reason"], "interlock");
  ASSERT_EQ(summary["interlocks"].size(), 1U);
  EXPECT_EQ(summary["interlocks"][0]["participant"], "storey_1");
  EXPECT_EQ(summary["interlocks"][0]["limit_name"], "rig_fault");
  EXPECT_EQ(summary["interlocks"][0]["cause"],
            "rig_fault: the simulated specimen moved to a number that is not finite");
  for (const double force_n : record.column("storey_1", "steps", "measured_force_n")) {
    ASSERT_TRUE(std::isfinite(force_n));
  }
}

}  // namespace
}  // namespace hybridtest
