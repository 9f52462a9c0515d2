#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <pthread.h>
#include <sched.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>

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
    ASSERT_TRUE(send_signal(process, signal)) << id;
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

/// Takes a processor from all programs of lower priority, until it is destroyed.
class Hog {
 public:
  explicit Hog(int cpu) {
    cpu_set_t cpus;
    CPU_ZERO(&cpus);
    CPU_SET(static_cast<std::size_t>(cpu), &cpus);
    const sched_param priority{.sched_priority = 98};
    thread_ = std::jthread{[this, cpus, priority](const std::stop_token& stop) {
      const bool is_granted = ::pthread_setaffinity_np(::pthread_self(), sizeof cpus, &cpus) == 0 &&
                              ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &priority) == 0;
      state_ = is_granted ? State::running : State::refused;
      state_.notify_all();
      while (is_granted && !stop.stop_requested()) continue;
    }};
    state_.wait(State::starting);
  }
  [[nodiscard]] bool is_running() const { return state_ == State::running; }

 private:
  enum class State { starting, running, refused };

  std::atomic<State> state_{State::starting};
  std::jthread thread_;
};

/// Ties all threads of a process to a processor.
void tie(pid_t process, int cpu) {
  cpu_set_t cpus;
  CPU_ZERO(&cpus);
  CPU_SET(static_cast<std::size_t>(cpu), &cpus);
  for (const auto& thread : std::filesystem::directory_iterator{"/proc/" + std::to_string(process) + "/task"}) {
    EXPECT_EQ(::sched_setaffinity(std::stoi(thread.path().filename()), sizeof cpus, &cpus), 0);
  }
}

TEST_F(RealTimeRun, StarvedSiteEndsTheTest) {
  constexpr int kTheirs = 1;
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "needs a processor besides the one that is taken away";
  StartedProgram run = start("600");
  ASSERT_TRUE(has_recorded("run", "coordinator", 100.0)) << run.standard_error();
  const pid_t site = participant_of(run, "storey_1");
  ASSERT_NE(site, 0);
  tie(::getpid(), 0);
  {
    std::optional<Hog> hog{std::in_place, kTheirs};
    if (!hog->is_running()) GTEST_SKIP() << "the operating system does not grant real-time priority";
    tie(site, kTheirs);
    EXPECT_TRUE(wait_until([&] { return run.standard_error().find("deadlines_missed") != std::string::npos; }))
        << run.standard_error();
  }
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  expect_deadlines_missed("storey_1");
  expect_rig_came_to_zero(recorded("run"), "storey_1");
}

TEST_F(RealTimeRun, PauseIsRefusedInWords) {
  StartedProgram run = start("600");
  ASSERT_TRUE(has_recorded("run", "coordinator", 100.0)) << run.standard_error();
  Arguments pause{"pause", test_name()};
  for (const std::string& argument : network()) pause.push_back(argument);
  StartedProgram command = start_hybridtest(pause, "pause");
  EXPECT_THAT(command.wait(), Optional(kExitConfiguration));
  EXPECT_THAT(command.standard_error(), HasSubstr("a real-time test cannot pause; stop it instead"));
  const double then = recorded("run").last_step("coordinator");
  EXPECT_TRUE(has_recorded("run", "coordinator", then + 50.0)) << "the test goes on";
  run.signal(SIGINT);
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
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
