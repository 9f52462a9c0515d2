#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <thread>

#include "tests/support/recording_checks.hpp"
#include "tests/support/system_fixture.hpp"

/// One row per end of a test: who ended it, why, and the exit code, as the summary tells them.
namespace hybridtest {
namespace {

using ::testing::AnyOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Optional;

const std::string kEndless = "time.duration_s=600";
/// A test of some seconds at the wall's time.
const Arguments kPaced{"--set", "time={mode: paced, step_s: 0.01, duration_s: 600.0}"};

class Ends : public SystemTest {
 protected:
  [[nodiscard]] StartedProgram start(const Arguments& more) const {
    return start_run(shipped_scenario("two_storey_one_site"), "run", more);
  }
  [[nodiscard]] StartedProgram start_endless() const {
    StartedProgram run = start({"--set", kEndless});
    EXPECT_TRUE(has_recorded("run", "coordinator", 1000.0)) << run.standard_error();
    return run;
  }
  static void kill_child(const StartedProgram& run, const std::string& id, int signal) {
    pid_t process = 0;
    ASSERT_TRUE(wait_until([&] { return (process = participant_of(run, id)) != 0; }, std::chrono::seconds{20}))
        << run.standard_error();
    ASSERT_TRUE(send_signal(process, signal));
  }
  void expect_end(StopReason reason, const std::string& who, const std::string& why) const {
    const nlohmann::json summary = recorded("run").summary();
    EXPECT_EQ(summary["stop_reason"], name(reason));
    EXPECT_EQ(summary["end"]["who"], who);
    EXPECT_THAT(summary["end"]["why"].get<std::string>(), HasSubstr(why));
    EXPECT_EQ(summary["exit_code"], exit_code_for(reason));
  }
};

TEST_F(Ends, RigThatDoesNotAnswerIsToldInItsOwnWords) {
  const Arguments arguments{"--set", "substructures[storey_1].rig={type: udp, host: 127.0.0.1, port: 9}"};
  Arguments all = kPaced;
  all.insert(all.end(), arguments.begin(), arguments.end());
  all.insert(all.end(), {"--set", "substructures[storey_1].control_rate_hz=1000"});
  StartedProgram run = start(all);
  ASSERT_THAT(run.wait(), Optional(kExitConfiguration)) << run.standard_error();
  expect_end(StopReason::participant_failed, "storey_1", "127.0.0.1");
  EXPECT_THAT(run.standard_output(), HasSubstr("NEVER STARTED: A PARTICIPANT FAILED (storey_1)"));
  EXPECT_THAT(run.standard_error(), HasSubstr("storey_1.log"));
}

TEST_F(Ends, RefusedRealTimeIsToldInItsOwnWords) {
  Arguments arguments = kPaced;
  arguments.insert(arguments.end(), {"--set", "substructures[storey_1].real_time={cpu: 1000, allow_degraded: false}"});
  StartedProgram run = start(arguments);
  ASSERT_THAT(run.wait(), Optional(kExitConfiguration)) << run.standard_error();
  expect_end(StopReason::participant_failed, "storey_1", "did not grant all of `real_time`");
}

TEST_F(Ends, ProcessKilledBeforeTheStartIsNamed) {
  // The test cannot start: one of its participants never appears.
  StartedProgram run = start({"--remote", "storey_2", "--loopback-only"});
  kill_child(run, "storey_1", SIGKILL);
  ASSERT_THAT(run.wait(), Optional(kExitConfiguration)) << run.standard_error();
  expect_end(StopReason::participant_failed, "storey_1", "killed by signal 9");
}

TEST_F(Ends, KilledNumericalSubstructureIsLost) {
  StartedProgram run = start_endless();
  kill_child(run, "storey_2", SIGKILL);
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  expect_end(StopReason::participant_lost, "storey_2", "killed by signal 9");
}

TEST_F(Ends, KilledCoordinatorIsLost) {
  StartedProgram run = start_endless();
  kill_child(run, "coordinator", SIGKILL);
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  expect_end(StopReason::coordinator_lost, "coordinator", "killed by signal 9");
}

TEST_F(Ends, CrashTellsTheCallsThatLedThere) {
  StartedProgram run = start_endless();
  kill_child(run, "coordinator", SIGSEGV);
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  expect_end(StopReason::coordinator_lost, "coordinator", "killed by signal 11");
  EXPECT_THAT(text_of(directory() / "run" / "coordinator.log"), ContainsRegex("the last one first:\n.*coordinator"));
  EXPECT_THAT(run.standard_error(), HasSubstr("libc.so"));
}

TEST_F(Ends, SilentParticipantIsTheCauseNotTheOverdueCommand) {
  // The site notices the missing command long before the lease of the frozen participant is over.
  StartedProgram run = start({"--set", kEndless, "--set", "substructures[storey_1].limits.command_age_s=0.3", "--set",
                              "timeouts={liveliness_lease_s: 20}"});
  ASSERT_TRUE(has_recorded("run", "coordinator", 500.0)) << run.standard_error();
  kill_child(run, "storey_2", SIGSTOP);
  ASSERT_TRUE(wait_until([&] { return run.standard_error().find("test stopped") != std::string::npos; }));
  kill_child(run, "storey_2", SIGCONT);
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  expect_end(StopReason::participant_lost, "storey_2", "has not answered");
}

TEST_F(Ends, InterlockNamesItsSite) {
  StartedProgram run = start({"--set", "substructures[storey_1].limits.displacement_m=0.002"});
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  expect_end(StopReason::interlock, "storey_1", "displacement_limit");
}

TEST_F(Ends, FullDiskIsNamedWithItsReason) {
  StartedProgram run = start_run(shipped_scenario("two_storey_one_site"), "run",
                                 {"--set", "time.duration_s=20", "--set", "recording={on_failure: stop}"},
                                 {.working_directory = {}, .file_bytes_max = 400'000});
  ASSERT_THAT(run.wait(), Optional(kExitDataInvalid)) << run.standard_error();
  const nlohmann::json summary = recorded("run").summary();
  EXPECT_EQ(summary["stop_reason"], "recording_failed");
  EXPECT_THAT(summary["end"]["who"].get<std::string>(), AnyOf("coordinator", "storey_1", "storey_2"));
  EXPECT_THAT(summary["end"]["why"].get<std::string>(), HasSubstr("File too large"));
  EXPECT_THAT(run.standard_output(), HasSubstr("File too large"));
}

TEST_F(Ends, MissingParticipantIsNamed) {
  StartedProgram run = start({"--remote", "storey_2", "--loopback-only", "--set", "timeouts={discovery_s: 1}"});
  ASSERT_THAT(run.wait(), Optional(kExitConfiguration)) << run.standard_error();
  expect_end(StopReason::not_assembled, "storey_2", "'storey_2' did not appear");
}

/// A clean end by a signal, whichever it is.
class EndBySignal : public Ends, public ::testing::WithParamInterface<int> {};

TEST_P(EndBySignal, BringsTheSiteToRestAndKeepsTheRecord) {
  StartedProgram run = start_endless();
  kill_child(run, "storey_1", GetParam());
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  expect_end(StopReason::interrupted, "storey_1", "");
  EXPECT_THAT(text_of(recorded("run").directory() / "storey_1.log"),
              HasSubstr("received SIG" + std::string{sigabbrev_np(GetParam())}));
  EXPECT_TRUE(recorded("run").open("storey_1").counters().closed_cleanly);
  expect_rig_came_to_zero(recorded("run"), "storey_1");
}

INSTANTIATE_TEST_SUITE_P(Signals, EndBySignal, ::testing::Values(SIGHUP, SIGTERM, SIGUSR1, SIGQUIT),
                         [](const auto& instance) { return std::string{sigabbrev_np(instance.param)}; });

/// Ctrl-C while the processes start, after so many milliseconds.
class EarlyCtrlC : public Ends, public ::testing::WithParamInterface<int> {};

TEST_P(EarlyCtrlC, LeavesReadableFilesOrNone) {
  StartedProgram run = start({"--set", kEndless});
  // Counted from the first child, so that the signal arrives while the children start.
  ASSERT_TRUE(wait_until([&] { return !run.children().empty(); }));
  std::this_thread::sleep_for(std::chrono::milliseconds{GetParam()});
  run.signal(SIGINT);
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  EXPECT_THAT(run.standard_output(), HasSubstr("STOPPED BY THE OPERATOR"));
  for (const auto& entry : std::filesystem::directory_iterator{recorded("run").directory()}) {
    if (entry.path().extension() == ".h5") expect_opens_with_h5dump(entry.path(), directory());
  }
}

INSTANTIATE_TEST_SUITE_P(After, EarlyCtrlC, ::testing::Values(0, 30, 80, 130, 200, 300),
                         [](const auto& instance) { return std::to_string(instance.param) + "_ms"; });

/// A process that stands still for half a second in a paced test.
class Stall : public Ends, public ::testing::WithParamInterface<std::string> {};

TEST_P(Stall, IsInTheVerdictWithItsDuration) {
  StartedProgram run = start({"--set", "time={mode: paced, step_s: 0.01, duration_s: 6.0}"});
  ASSERT_TRUE(has_recorded("run", "coordinator", 100.0)) << run.standard_error();
  kill_child(run, GetParam(), SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds{500});
  kill_child(run, GetParam(), SIGCONT);
  ASSERT_THAT(run.wait(), Optional(kExitCompleted)) << run.standard_error();
  const nlohmann::json stalls = recorded("run").summary()["stalls"];
  EXPECT_GE(stalls["count"], 1);
  // At least what the processes had to wait; a busy machine may add to it.
  EXPECT_GE(stalls["longest_s"], 0.4);
  EXPECT_GT(stalls["model_time_s"], 0.9);
  EXPECT_LT(stalls["model_time_s"], 6.0);
  EXPECT_THAT(run.standard_output(), HasSubstr("SPECIMENS HELD ("));
  EXPECT_GE(recorded("run").events("coordinator", EventCode::test_stalled).size(), 1U);
}

INSTANTIATE_TEST_SUITE_P(Of, Stall, ::testing::Values("coordinator", "storey_1"),
                         [](const auto& instance) { return instance.param; });

}  // namespace
}  // namespace hybridtest
