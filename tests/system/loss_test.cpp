#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <numeric>
#include <ostream>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "tests/support/recording_checks.hpp"
#include "tests/support/system_fixture.hpp"

/// Participants that never appear, are killed, freeze or lose their parent process.
namespace hybridtest {
namespace {

using ::testing::HasSubstr;
using ::testing::Optional;

/// Much longer than any of these tests runs.
const std::string kEndless = "time.duration_s=600";
constexpr double kLease_s = 2.0;  // the scenarios' default
/// Scheduling and teardown of several processes on a busy machine.
constexpr double kMargin_s = 2.0;

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

class Loss : public SystemTest {};

TEST_F(Loss, NamesMissingParticipantAfterDiscoveryTimeout) {
  const auto begin = std::chrono::steady_clock::now();
  StartedProgram run = start_run(shipped_scenario("two_storey_one_site"), "run",
                                 {"--remote", "storey_2", "--loopback-only", "--set", "timeouts={discovery_s: 2}"});
  ASSERT_THAT(run.wait(), Optional(kExitConfiguration)) << run.standard_error();
  EXPECT_GE(seconds_since(begin), 2.0);

  EXPECT_THAT(run.standard_error(), HasSubstr("'storey_2' did not appear"));
  EXPECT_THAT(run.standard_error(), ::testing::Not(HasSubstr("'storey_1' did not appear")));
  const auto missing = recorded("run").events("coordinator", EventCode::participant_missing);
  ASSERT_EQ(missing.size(), 1U);
  EXPECT_EQ(missing[0].subject, ParticipantId{"storey_2"});
  EXPECT_EQ(recorded("run").summary()["stop_reason"], "not_assembled");
  EXPECT_EQ(recorded("run").summary()["exit_code"], kExitConfiguration);
  // The site that did appear exited by itself.
  EXPECT_TRUE(recorded("run").open("storey_1").counters().closed_cleanly);
}

TEST_F(Loss, NamesMissingCoordinator) {
  StartedProgram site = start_participant("experimental_site", "storey_1", shipped_scenario("two_storey_one_site"),
                                          "site", {"--set", "timeouts={discovery_s: 1}"});
  ASSERT_THAT(site.wait(), Optional(kExitConfiguration)) << site.standard_error();
  EXPECT_THAT(site.standard_error(), HasSubstr("'coordinator' did not appear"));
}

TEST_F(Loss, KilledSiteEndsTestWithinLeaseAndKeepsItsRecord) {
  StartedProgram run = start_run(shipped_scenario("two_storey_one_site"), "run", {"--set", kEndless});
  ASSERT_TRUE(has_recorded("run", "coordinator", 1000.0)) << run.standard_error();
  const pid_t site = run.child({"--id", "storey_1"});
  ASSERT_NE(site, 0);
  const auto killed = std::chrono::steady_clock::now();
  ASSERT_TRUE(send_signal(site, SIGKILL));
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  EXPECT_LE(seconds_since(killed), kLease_s + kMargin_s);
  EXPECT_THAT(run.standard_error(), HasSubstr("'storey_1' is lost"));

  const RecordedRun record = recorded("run");
  const auto lost = record.events("coordinator", EventCode::participant_lost);
  ASSERT_EQ(lost.size(), 1U);
  EXPECT_EQ(lost[0].subject, ParticipantId{"storey_1"});
  const auto started = record.events("coordinator", EventCode::test_started);
  ASSERT_EQ(started.size(), 1U);
  const std::vector<double> wall_s = record.column("coordinator", "steps", "wall_time_s");
  const double silence_s = to_seconds(lost[0].clock - started[0].clock) - wall_s.back();
  EXPECT_LE(silence_s, kLease_s + 0.5);

  const nlohmann::json summary = record.summary();
  EXPECT_EQ(summary["stop_reason"], "participant_lost");
  EXPECT_EQ(summary["data_valid"], false);
  EXPECT_TRUE(record.open("coordinator").counters().closed_cleanly);
  EXPECT_TRUE(record.open("storey_2").counters().closed_cleanly);
  EXPECT_FALSE(record.open("storey_1").counters().closed_cleanly);
  for (const char* participant : {"coordinator", "storey_1", "storey_2"}) {
    expect_opens_with_h5dump(record.file(participant), directory());
    expect_all_steps_from_the_first(record, participant);
  }
  // When the coordinator completed a step it had the site's answer; the site's file may lack those of the
  // last flush interval before the kill.
  const auto kept = static_cast<std::size_t>(record.last_step("storey_1"));
  ASSERT_LT(kept, wall_s.size());
  const double lag_s = wall_s.back() - wall_s[kept];
  std::cout << "the record of the killed site lacks its last " << 1e3 * lag_s << " ms (" << wall_s.size() - 1 - kept
            << " of " << wall_s.size() << " steps)\n";
  EXPECT_LE(lag_s, kFlushInterval_s + kFlushMargin_s);
}

TEST_F(Loss, KilledCoordinatorBringsOthersToRest) {
  StartedProgram run = start_run(shipped_scenario("two_storey_one_site"), "run", {"--set", kEndless});
  ASSERT_TRUE(has_recorded("run", "coordinator", 1000.0)) << run.standard_error();
  const pid_t coordinator = participant_of(run, kCoordinatorId);
  ASSERT_NE(coordinator, 0);
  ASSERT_TRUE(send_signal(coordinator, SIGKILL));
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  EXPECT_THAT(run.standard_output(), HasSubstr("ENDED: THE COORDINATOR WAS LOST (coordinator, at"));
  EXPECT_THAT(run.standard_output(), HasSubstr("DATA INVALID"));

  const RecordedRun record = recorded("run");
  EXPECT_EQ(record.summary()["data_valid"], false);
  EXPECT_EQ(record.summary()["stop_reason"], "coordinator_lost");
  EXPECT_FALSE(record.open("coordinator").counters().closed_cleanly);
  expect_all_steps_from_the_first(record, "coordinator");
  expect_opens_with_h5dump(record.file("coordinator"), directory());
  for (const char* participant : {"storey_1", "storey_2"}) {
    EXPECT_TRUE(record.open(participant).counters().closed_cleanly) << participant;
    EXPECT_EQ(record.events(participant, EventCode::coordinator_lost).size(), 1U) << participant;
  }
  expect_rig_came_to_zero(record, "storey_1");
}

TEST_F(Loss, FrozenSiteEndsTestWithinLeaseAndExitsWhenResumed) {
  StartedProgram run = start_run(shipped_scenario("two_storey_one_site"), "run", {"--set", kEndless});
  ASSERT_TRUE(has_recorded("run", "coordinator", 1000.0)) << run.standard_error();
  const pid_t site = run.child({"--id", "storey_1"});
  ASSERT_NE(site, 0);
  ASSERT_TRUE(send_signal(site, SIGSTOP));
  const auto frozen = std::chrono::steady_clock::now();
  const bool coordinator_left =
      wait_until([&] { return run.child({"--scenario"}) == 0 || run.children().size() == 1; });
  const double left_after_s = seconds_since(frozen);
  send_signal(site, SIGCONT);
  ASSERT_TRUE(coordinator_left);
  EXPECT_LE(left_after_s, kLease_s + kMargin_s);
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();

  const RecordedRun record = recorded("run");
  EXPECT_EQ(record.summary()["stop_reason"], "participant_lost");
  for (const char* participant : {"coordinator", "storey_1", "storey_2"}) {
    EXPECT_TRUE(record.open(participant).counters().closed_cleanly) << participant;
    expect_all_steps_from_the_first(record, participant);
  }
  expect_rig_came_to_zero(record, "storey_1");
}

TEST_F(Loss, KilledParentStopsEveryProcessSafely) {
  StartedProgram run = start_run(shipped_scenario("two_storey_one_site"), "run", {"--set", kEndless});
  ASSERT_TRUE(has_recorded("run", "coordinator", 1000.0)) << run.standard_error();
  const std::vector<pid_t> children = run.children();
  ASSERT_EQ(children.size(), 3U);
  run.signal(SIGKILL);
  ASSERT_THAT(run.wait(), Optional(128 + SIGKILL));
  EXPECT_TRUE(wait_until([&] { return std::ranges::none_of(children, is_alive); }));
  for (const pid_t child : children) {
    if (is_alive(child)) send_signal(child, SIGKILL);
  }

  const RecordedRun record = recorded("run");
  EXPECT_THAT(record.column("coordinator", "test", "stop_reason"),
              ::testing::ElementsAre(static_cast<double>(StopReason::interrupted)));
  for (const char* participant : {"coordinator", "storey_1", "storey_2"}) {
    EXPECT_TRUE(record.open(participant).counters().closed_cleanly) << participant;
    expect_all_steps_from_the_first(record, participant);
  }
  expect_rig_came_to_zero(record, "storey_1");
}

class LostCoordinator : public SystemTest, public ::testing::WithParamInterface<std::string> {};

TEST_P(LostCoordinator, SitesHoldWithinCommandAgeAndExit) {
  constexpr double kCommandAge_s = 0.3;
  const std::filesystem::path scenario = shipped_scenario("two_storey_two_sites");
  const std::vector<std::string> sites{"first_storey_columns", "second_storey_columns"};
  Arguments overrides{"--set", kEndless, "--set", "time.mode=" + GetParam()};
  for (const std::string& site : sites) {
    overrides.insert(overrides.end(), {"--set", "substructures[" + site + "].limits.command_age_s=0.3"});
  }
  if (GetParam() == "paced") overrides.insert(overrides.end(), {"--set", "time.step_s=0.01"});
  StartedProgram coordinator = start_participant("coordinator", "coordinator", scenario, "run", overrides);
  std::vector<StartedProgram> programs;
  for (const std::string& site : sites) {
    programs.push_back(start_participant("experimental_site", site, scenario, "run", overrides));
  }
  ASSERT_TRUE(has_recorded("run", "coordinator", 200.0)) << coordinator.standard_error();
  coordinator.signal(SIGKILL);

  for (std::size_t i = 0; i < sites.size(); ++i) {
    ASSERT_THAT(programs[i].wait(), Optional(kExitEndedEarly)) << programs[i].standard_error();
    EXPECT_THAT(programs[i].standard_error(), HasSubstr("no command for"));
    EXPECT_THAT(programs[i].standard_error(), HasSubstr("the coordinator is lost"));

    const RecordedRun record = recorded("run");
    const auto overdue = record.events(sites[i], EventCode::command_overdue);
    ASSERT_EQ(overdue.size(), 1U);
    EXPECT_GT(overdue[0].values[0], kCommandAge_s);
    EXPECT_LE(overdue[0].values[0], kCommandAge_s + 0.5);
    EXPECT_EQ(overdue[0].values[1], kCommandAge_s);
    const auto lost = record.events(sites[i], EventCode::coordinator_lost);
    ASSERT_EQ(lost.size(), 1U);
    EXPECT_LE(to_seconds(lost[0].clock - overdue[0].clock), kLease_s);
    if (GetParam() == "paced") expect_held_between(record, sites[i], overdue[0], lost[0]);
    EXPECT_TRUE(record.open(sites[i]).counters().closed_cleanly);
    expect_rig_came_to_zero(record, sites[i]);
  }
  expect_opens_with_h5dump(recorded("run").file("first_storey_columns"), directory());
  expect_all_steps_from_the_first(recorded("run"), "coordinator");
}

INSTANTIATE_TEST_SUITE_P(Modes, LostCoordinator, ::testing::Values("lockstep", "paced"),
                         [](const auto& instance) { return instance.param; });

}  // namespace
}  // namespace hybridtest
