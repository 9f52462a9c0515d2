#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <string>

#include "tests/support/recording_checks.hpp"
#include "tests/support/system_fixture.hpp"

/// Tests with deadlines, in real processes. The steps are long, so that a busy machine misses few deadlines.
namespace hybridtest {
namespace {

using ::testing::HasSubstr;
using ::testing::Optional;

class RealTimeRun : public SystemTest {
 protected:
  static constexpr int kMostInARow = 20;

  [[nodiscard]] StartedProgram start(const std::string& duration_s) const {
    return start_run(
        shipped_scenario("two_storey_one_site"), "run",
        {"--set", "time.mode=real_time", "--set", "time.step_s=0.01", "--set", "time.duration_s=" + duration_s, "--set",
         "bridging={start_anyway: true, most_in_a_row: " + std::to_string(kMostInARow) + "}"});
  }
  void send(const StartedProgram& run, const std::string& id, int signal) const {
    const pid_t process = participant_of(run, id);
    ASSERT_NE(process, 0) << id;
    ASSERT_EQ(::kill(process, signal), 0) << id;
  }
  /// What the participant `id` did not do in time ended the test.
  void expect_deadlines_missed(const std::string& id) const {
    const RecordedRun record = recorded("run");
    const nlohmann::json summary = record.summary();
    EXPECT_EQ(summary["stop_reason"], "deadlines_missed");
    EXPECT_EQ(summary["end"]["who"], id);
    expect_all_steps_from_the_first(record, "coordinator");
    for (const nlohmann::json& substructure : summary["substructures"]) {
      if (substructure["id"] != id) continue;
      EXPECT_GT(substructure["exchange"]["bridged_in_a_row"], 0);
      EXPECT_LE(substructure["exchange"]["bridged_in_a_row"], kMostInARow + 1);
    }
  }
};

TEST_F(RealTimeRun, TakesTheTimeOfTheModel) {
  StartedProgram run = start("3");
  ASSERT_THAT(run.wait(), Optional(kExitCompleted)) << run.standard_error();
  const nlohmann::json summary = recorded("run").summary();
  EXPECT_EQ(summary["data_valid"], true) << summary["data_faults"];
  // The last step is sent one step before its time, and answered a round trip after it.
  EXPECT_GE(summary["wall_time_s"], 3.0 - 0.02);
  EXPECT_LE(summary["wall_time_s"], 3.0 + 0.01 * kMostInARow);
  expect_all_steps_from_the_first(recorded("run"), "coordinator");
}

TEST_F(RealTimeRun, KilledSiteEndsTheTest) {
  StartedProgram run = start("600");
  ASSERT_TRUE(has_recorded("run", "coordinator", 100.0)) << run.standard_error();
  send(run, "storey_1", SIGKILL);
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  expect_deadlines_missed("storey_1");
}

TEST_F(RealTimeRun, StoppedSiteEndsTheTest) {
  StartedProgram run = start("600");
  ASSERT_TRUE(has_recorded("run", "coordinator", 100.0)) << run.standard_error();
  send(run, "storey_1", SIGSTOP);
  EXPECT_TRUE(wait_until([&] { return run.standard_error().find("deadlines_missed") != std::string::npos; }))
      << run.standard_error();
  send(run, "storey_1", SIGCONT);
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  expect_deadlines_missed("storey_1");
  expect_rig_came_to_zero(recorded("run"), "storey_1");
}

TEST_F(RealTimeRun, StoppedNumericalSubstructureEndsTheTest) {
  StartedProgram run = start("600");
  ASSERT_TRUE(has_recorded("run", "coordinator", 100.0)) << run.standard_error();
  send(run, "storey_2", SIGSTOP);
  EXPECT_TRUE(wait_until([&] { return run.standard_error().find("deadlines_missed") != std::string::npos; }))
      << run.standard_error();
  send(run, "storey_2", SIGCONT);
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  expect_deadlines_missed("storey_2");
  expect_rig_came_to_zero(recorded("run"), "storey_1");
}

TEST_F(RealTimeRun, SiteOfAStoppedCoordinatorHolds) {
  StartedProgram run = start("600");
  ASSERT_TRUE(has_recorded("run", "coordinator", 100.0)) << run.standard_error();
  send(run, "coordinator", SIGSTOP);
  // The site decides by itself, with nobody in the way.
  EXPECT_TRUE(wait_until([&] { return run.standard_error().find("no command for") != std::string::npos; }))
      << run.standard_error();
  send(run, "coordinator", SIGCONT);
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  EXPECT_TRUE(recorded("run").open("storey_1").counters().closed_cleanly);
}

TEST_F(RealTimeRun, CtrlCStopsTheTestSafely) {
  StartedProgram run = start("600");
  ASSERT_TRUE(has_recorded("run", "coordinator", 100.0)) << run.standard_error();
  run.signal(SIGINT);
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  EXPECT_EQ(recorded("run").summary()["stop_reason"], "interrupted");
  EXPECT_EQ(recorded("run").summary()["data_valid"], true);
  expect_rig_came_to_zero(recorded("run"), "storey_1");
}

}  // namespace
}  // namespace hybridtest
