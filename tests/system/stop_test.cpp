#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <string>
#include <utility>

#include "tests/support/recording_checks.hpp"
#include "tests/support/system_fixture.hpp"

/// Stopped by hand: safely, with every record in order.
namespace hybridtest {
namespace {

using ::testing::HasSubstr;
using ::testing::Optional;

class Stop : public SystemTest {
 protected:
  [[nodiscard]] StartedProgram start_endless_run() const {
    return start_run(shipped_scenario("two_storey_one_site"), "run", {"--set", "time.duration_s=600"});
  }

  [[nodiscard]] int control(const std::string& verb) const {
    Arguments arguments{verb, test_name()};
    for (const std::string& argument : network()) arguments.push_back(argument);
    StartedProgram command = start_hybridtest(arguments, verb);
    const auto exit_code = command.wait();
    EXPECT_TRUE(exit_code.has_value()) << verb;
    EXPECT_THAT(command.standard_output(), HasSubstr("done")) << command.standard_error();
    return exit_code.value_or(-1);
  }

  void expect_stopped_in_order(StopReason reason, bool rig_moved_back = true) const {
    const RecordedRun record = recorded("run");
    const nlohmann::json summary = record.summary();
    EXPECT_EQ(summary["stop_reason"], name(reason));
    EXPECT_EQ(summary["exit_code"], kExitEndedEarly);
    EXPECT_EQ(summary["data_valid"], true) << summary["data_faults"];
    EXPECT_GT(summary["completed_steps"], 0);
    EXPECT_LT(summary["completed_steps"], summary["planned_steps"]);
    for (const char* participant : {"coordinator", "storey_1", "storey_2"}) {
      EXPECT_TRUE(record.open(participant).counters().closed_cleanly) << participant;
      expect_all_steps_from_the_first(record, participant);
      EXPECT_NEAR(record.last_step(participant), record.last_step("coordinator"), 1.0) << participant;
    }
    if (rig_moved_back) expect_rig_came_to_zero(record, "storey_1");
  }
};

TEST_F(Stop, CtrlCStopsTheTestSafely) {
  StartedProgram run = start_endless_run();
  ASSERT_TRUE(has_recorded("run", "coordinator", 1000.0)) << run.standard_error();
  run.signal(SIGINT);
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  EXPECT_THAT(run.standard_output(), HasSubstr("STOPPED BY THE OPERATOR"));
  expect_stopped_in_order(StopReason::interrupted);
}

TEST_F(Stop, CtrlCDuringDiscoveryEndsTheRun) {
  StartedProgram run =
      start_run(shipped_scenario("two_storey_one_site"), "run", {"--remote", "storey_2", "--loopback-only"});
  ASSERT_TRUE(wait_until([&] { return run.standard_error().find("storey_1: ready") != std::string::npos; }))
      << run.standard_error();
  run.signal(SIGINT);
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  EXPECT_EQ(recorded("run").summary()["stop_reason"], "interrupted");
  EXPECT_TRUE(recorded("run").open("storey_1").counters().closed_cleanly);
}

TEST_F(Stop, CtrlCAtASiteStopsTheWholeTest) {
  StartedProgram run = start_endless_run();
  ASSERT_TRUE(has_recorded("run", "coordinator", 1000.0)) << run.standard_error();
  const pid_t site = run.child({"--id", "storey_1"});
  ASSERT_NE(site, 0);
  ASSERT_TRUE(send_signal(site, SIGINT));
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  expect_stopped_in_order(StopReason::interrupted);
}

TEST_F(Stop, StopCommandFindsTestByName) {
  StartedProgram run = start_endless_run();
  ASSERT_TRUE(has_recorded("run", "coordinator", 1000.0)) << run.standard_error();
  EXPECT_EQ(control("stop"), kExitCompleted);
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  expect_stopped_in_order(StopReason::interrupted);
}

TEST_F(Stop, PauseResumeAndEmergencyStopTakeEffect) {
  StartedProgram run = start_endless_run();
  ASSERT_TRUE(has_recorded("run", "coordinator", 1000.0)) << run.standard_error();
  EXPECT_EQ(control("pause"), kExitCompleted);
  // Two looks at the file that agree although its writer flushes ten times as often.
  double paused_at = -1.0;
  ASSERT_TRUE(wait_until(
      [&] {
        const double before = std::exchange(paused_at, recorded("run").last_step("coordinator"));
        return before == paused_at && run.standard_error().find("test paused") != std::string::npos;
      },
      kPatience));
  EXPECT_EQ(control("resume"), kExitCompleted);
  ASSERT_TRUE(has_recorded("run", "coordinator", paused_at + 500.0)) << run.standard_error();
  EXPECT_EQ(control("emergency-stop"), kExitCompleted);
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  // Nothing moves after an emergency stop, not even back.
  expect_stopped_in_order(StopReason::emergency_stop, false);
}

TEST_F(Stop, EmergencyStopReachesTheSiteWithoutTheCoordinator) {
  StartedProgram run = start_run(shipped_scenario("two_storey_one_site"), "run",
                                 {"--set", "time.duration_s=600", "--set", "timeouts={liveliness_lease_s: 30}", "--set",
                                  "substructures[storey_1].limits.command_age_s=60"});
  ASSERT_TRUE(has_recorded("run", "coordinator", 1000.0)) << run.standard_error();
  const pid_t coordinator = participant_of(run, kCoordinatorId);
  ASSERT_NE(coordinator, 0);
  ASSERT_TRUE(send_signal(coordinator, SIGSTOP));
  Arguments arguments{"emergency-stop", test_name()};
  for (const std::string& argument : network()) arguments.push_back(argument);
  StartedProgram command = start_hybridtest(arguments, "emergency_stop");
  // The coordinator did not answer, and the operator is told so.
  EXPECT_THAT(command.wait(), Optional(kExitEndedEarly)) << command.standard_error();
  EXPECT_THAT(command.standard_output(), HasSubstr("storey_1"));
  EXPECT_THAT(command.standard_error(), HasSubstr("NOT found: coordinator"));
  ASSERT_TRUE(wait_until([&] { return run.child({"--id", "storey_1"}) == 0; })) << "the site goes on";
  send_signal(coordinator, SIGCONT);
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  EXPECT_EQ(recorded("run").summary()["stop_reason"], "emergency_stop");
}

TEST_F(Stop, UnknownTestIsNotFound) {
  Arguments arguments{"stop", "no_test_of_this_name"};
  for (const std::string& argument : network()) arguments.push_back(argument);
  StartedProgram command = start_hybridtest(arguments, "stop");
  EXPECT_THAT(command.wait(), Optional(kExitConfiguration));
  EXPECT_THAT(command.standard_error(), HasSubstr("no participant of this test was found"));
}

}  // namespace
}  // namespace hybridtest
