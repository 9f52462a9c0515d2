#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <string>

#include "recording/summary/find_end.hpp"
#include "tests/unit/recording/example_run.hpp"
#include "tests/unit/recording/temporary_directory.hpp"

/// Who ended a test, why and when.
namespace hybridtest {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

RecordedEvent event(const char* source, EventCode code, const char* subject, const char* text, double value = 0.0) {
  RecordedEvent recorded;
  recorded.event.source = source;
  recorded.event.severity = Severity::fault;
  recorded.event.code = code;
  recorded.event.subject = subject;
  recorded.event.step = 3210;
  recorded.event.model_time_s = 3.21;
  recorded.event.values[0] = value;
  recorded.text = text;
  return recorded;
}

RecordedEvent stopped(StopReason reason, const char* who) {
  return event("coordinator", EventCode::test_stopped, who, "test stopped", static_cast<double>(reason));
}

ProcessEnd killed(const char* participant) {
  return {.participant = participant, .exit_code = 137, .signal = 9, .words = "", .was_asked = false};
}

RunSummary running(StopReason reason) {
  RunSummary summary;
  summary.stop_reason = reason;
  summary.completed_steps = 3211;
  summary.model_time_s = 3.21;
  return summary;
}

TEST(TestEnds, HaveOneRowPerReason) {
  std::set<StopReason> reasons;
  for (const TestEnd& end : kTestEnds) {
    EXPECT_TRUE(reasons.insert(end.reason).second) << end.name;
    EXPECT_EQ(name(end.reason), end.name);
  }
  EXPECT_TRUE(reasons.contains(StopReason::resume_refused)) << "the last of the enum";
  EXPECT_EQ(name(static_cast<StopReason>(kTestEnds.size())), "unknown");
}

TEST(EndOfRun, InterlockNamesTheSiteThatTripped) {
  RunSummary summary = running(StopReason::interlock);
  find_end(summary, {},
           {event("storey_2", EventCode::interlock_tripped, "force_limit", "another"),
            event("storey_1", EventCode::interlock_tripped, "displacement_limit", "interlock: displacement_limit"),
            stopped(StopReason::interlock, "storey_1")});
  EXPECT_EQ(summary.end.who, "storey_1");
  EXPECT_EQ(summary.end.why, "interlock: displacement_limit");
  EXPECT_EQ(summary.end.model_time_s, 3.21);
}

TEST(EndOfRun, KilledParticipantIsNamedWithItsSignal) {
  RunSummary summary = running(StopReason::participant_lost);
  find_end(summary, {killed("storey_2")}, {stopped(StopReason::participant_lost, "storey_2")});
  EXPECT_EQ(summary.stop_reason, StopReason::participant_lost);
  EXPECT_EQ(summary.end.who, "storey_2");
  EXPECT_THAT(summary.end.why, HasSubstr("killed by signal 9"));
}

TEST(EndOfRun, EmergencyStopThatTheCoordinatorMissedIsTheReason) {
  const auto ended = [](const char* fault) {
    RunSummary summary = running(StopReason::participant_lost);
    find_end(summary, {},
             {event("storey_1", EventCode::interlock_tripped, fault, "interlock"),
              event("coordinator", EventCode::participant_lost, "storey_1", "'storey_1' is lost"),
              stopped(StopReason::participant_lost, "storey_1")});
    return summary;
  };
  EXPECT_EQ(ended("emergency_stop").stop_reason, StopReason::emergency_stop);
  EXPECT_EQ(ended("emergency_stop").end.who, "operator");
  EXPECT_EQ(ended("force_limit").stop_reason, StopReason::participant_lost);
}

TEST(EndOfRun, KilledCoordinatorIsToldByItsParent) {
  RunSummary summary = running(StopReason::none);
  find_end(summary, {killed("coordinator")}, {});
  EXPECT_EQ(summary.stop_reason, StopReason::coordinator_lost);
  EXPECT_EQ(summary.end.who, "coordinator");
}

TEST(EndOfRun, LostCoordinatorIsToldByTheSitesAlone) {
  RunSummary summary = running(StopReason::none);
  find_end(summary, {}, {event("storey_1", EventCode::coordinator_lost, "", "the coordinator is lost")});
  EXPECT_EQ(summary.stop_reason, StopReason::coordinator_lost);
  EXPECT_EQ(summary.end.who, "coordinator");
  EXPECT_EQ(summary.end.why, "the coordinator is lost");
}

TEST(EndOfRun, ProcessThatFailsBeforeTheStartIsTheCause) {
  RunSummary summary;
  summary.stop_reason = StopReason::interrupted;
  const ProcessEnd site{.participant = "storey_1",
                        .exit_code = 2,
                        .signal = 0,
                        .words = "no answer from the rig",
                        .was_asked = false,
                        .before_start = true};
  const ProcessEnd other{.participant = "storey_2",
                         .exit_code = 3,
                         .signal = 0,
                         .words = "stopping safely",
                         .was_asked = true,
                         .before_start = true};
  find_end(summary, {site, other}, {stopped(StopReason::interrupted, "operator")});
  EXPECT_EQ(summary.stop_reason, StopReason::participant_failed);
  EXPECT_EQ(summary.end.who, "storey_1");
  EXPECT_EQ(summary.end.why, "no answer from the rig");
  EXPECT_FALSE(summary.end.model_time_s.has_value());
}

TEST(EndOfRun, ProcessThatWasAskedToStopIsNoCause) {
  RunSummary summary = running(StopReason::interrupted);
  ProcessEnd site = killed("storey_1");
  site.was_asked = true;
  find_end(summary, {site}, {stopped(StopReason::interrupted, "operator")});
  EXPECT_EQ(summary.stop_reason, StopReason::interrupted);
  EXPECT_EQ(summary.end.who, "operator");
  EXPECT_THAT(summary.end.why, IsEmpty());
}

/// The end of an ssh, as the run sees it.
ProcessEnd over_ssh(int code) {
  ProcessEnd end{.participant = "storey_1", .words = "Connection closed by remote host", .host = "lab"};
  end.take_code_of_ssh(code);
  return end;
}

TEST(EndOfRun, LostConnectionToItsHostIsTheCauseAndNoOperator) {
  RunSummary summary = running(StopReason::interrupted);
  find_end(summary, {over_ssh(255)}, {stopped(StopReason::interrupted, "storey_1")});
  EXPECT_EQ(summary.stop_reason, StopReason::participant_lost);
  EXPECT_EQ(summary.end.who, "storey_1");
  EXPECT_THAT(summary.end.why, HasSubstr("the ssh connection to lab was lost"));
}

TEST(EndOfRun, OperatorWhoStoppedStaysWhenAConnectionIsLost) {
  RunSummary summary = running(StopReason::interrupted);
  find_end(summary, {over_ssh(255)}, {stopped(StopReason::interrupted, "operator")});
  EXPECT_EQ(summary.stop_reason, StopReason::interrupted);
  EXPECT_EQ(summary.end.who, "operator");
}

TEST(EndOfRun, ProcessKilledOnItsHostIsTheCause) {
  // A shell tells a signal as 128 + signal (POSIX, 2.8.2), and ssh hands the code on.
  RunSummary summary = running(StopReason::participant_lost);
  find_end(summary, {over_ssh(137)}, {stopped(StopReason::participant_lost, "storey_1")});
  EXPECT_EQ(summary.end.why, "killed by signal 9 (Killed)");
  EXPECT_EQ(over_ssh(kExitEndedEarly).signal, 0);
  EXPECT_FALSE(over_ssh(kExitEndedEarly).is_cause());
}

TEST(EndOfRun, ProcessThatLeftInOrderIsNoCause) {
  // Stopped through the network: nobody sent it a signal.
  ProcessEnd numerical{.participant = "storey_2", .exit_code = kExitEndedEarly, .signal = 0, .words = "ready"};
  EXPECT_FALSE(numerical.is_cause());
  numerical.exit_code = kExitInternal;
  EXPECT_TRUE(numerical.is_cause());
}

TEST(EndOfRun, InterlockStaysWhenASiteIsKilledAfterwards) {
  RunSummary summary = running(StopReason::interlock);
  find_end(summary, {killed("storey_2")}, {stopped(StopReason::interlock, "storey_1")});
  EXPECT_EQ(summary.stop_reason, StopReason::interlock);
  EXPECT_EQ(summary.end.who, "storey_1");
}

TEST(EndOfRun, NetworkEventsTellWhatAFullDiskCouldNotKeep) {
  RunSummary summary = running(StopReason::none);
  find_end(summary, {},
           {event("storey_1", EventCode::recording_failed, "", "recording failed (No space left on device)"),
            stopped(StopReason::recording_failed, "storey_1")});
  EXPECT_EQ(summary.stop_reason, StopReason::recording_failed);
  EXPECT_EQ(summary.end.who, "storey_1");
  EXPECT_THAT(summary.end.why, HasSubstr("No space left"));
}

TEST(ProcessEnds, AreReadBackAsWritten) {
  const TemporaryDirectory directory;
  ProcessEnd site = killed("storey_1");
  site.words = "last \"words\"";
  site.host = "lab";
  write_process_ends({site}, directory.path());
  const std::vector<ProcessEnd> read = read_process_ends(directory.path());
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].participant, "storey_1");
  EXPECT_EQ(read[0].exit_code, 137);
  EXPECT_EQ(read[0].signal, 9);
  EXPECT_EQ(read[0].words, site.words);
  EXPECT_EQ(read[0].host, "lab");
  EXPECT_TRUE(read[0].is_cause());
}

TEST(ProcessEnds, AreEmptyWithoutAFileOfOurs) {
  const TemporaryDirectory directory;
  EXPECT_THAT(read_process_ends(directory.path()), IsEmpty());
  std::ofstream{directory.path() / "processes.json"} << R"([{"participant": 7}])";
  EXPECT_THAT(read_process_ends(directory.path()), IsEmpty());
}

TEST(Stalls, OfAPacedTestAreInTheVerdict) {
  const TemporaryDirectory directory;
  ExampleRun run;
  run.step_wall_time_s = 0.0005;
  run.stalled_step = 3210;
  run.write(directory.path());
  const RunSummary summary = summarise(directory.path());
  EXPECT_EQ(summary.stalls.count, 1U);
  EXPECT_NEAR(summary.stalls.longest_s, 0.5, 1e-9);
  EXPECT_NEAR(summary.stalls.model_time_s, 3.21, 1e-9);
  EXPECT_EQ(verdict(summary), "completed; specimens held (once 0.50 s at 3.210 s)");
  EXPECT_EQ(summary.exit_code, kExitCompleted);
}

TEST(Stalls, DoNotExistInLockstep) {
  const TemporaryDirectory directory;
  ExampleRun run;
  run.stalled_step = 3210;
  run.write(directory.path());
  EXPECT_EQ(summarise(directory.path()).stalls.count, 0U);
}

TEST(Stalls, LeaveOutThePausesOfTheOperator) {
  const TemporaryDirectory directory;
  ExampleRun run;
  run.step_wall_time_s = 0.0005;
  run.stalled_step = 3210;
  run.coordinator_events = {event("coordinator", EventCode::test_paused, "", "test paused").event};
  run.write(directory.path());
  EXPECT_EQ(summarise(directory.path()).stalls.count, 0U);
}

}  // namespace
}  // namespace hybridtest
