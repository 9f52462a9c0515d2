#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "recording/run_file_writer.hpp"
#include "tests/support/system_fixture.hpp"

/// A coordinator that is killed in the middle of a test, and `hybridtest run --resume`.
namespace hybridtest {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Optional;

class Resume : public SystemTest {
 protected:
  /// @param resume_s   of `timeouts`.
  static Arguments settings(const std::string& resume_s, const std::string& duration_s) {
    return {"--set", "timeouts={liveliness_lease_s: 1, stop_s: 5, resume_s: " + resume_s + "}",
            "--set", "substructures[storey_1].limits.command_age_s=100",
            "--set", "time.duration_s=" + duration_s};
  }
  [[nodiscard]] StartedProgram start(const Arguments& settings) const {
    return start_run(shipped_scenario("two_storey_one_site"), "run", settings);
  }
  /// Kills these participants in the middle of the test, the coordinator among them.
  void kill_at_step(const StartedProgram& run, double step, const std::vector<std::string>& ids) {
    ASSERT_TRUE(has_recorded("run", "coordinator", step)) << run.standard_error();
    for (const std::string& id : ids) {
      const pid_t process = participant_of(run, id);
      ASSERT_NE(process, 0) << id;
      ASSERT_TRUE(send_signal(process, SIGKILL));
    }
    ASSERT_TRUE(wait_until([&] { return run.standard_error().find("To go on, type") != std::string::npos; }))
        << run.standard_error();
  }
  [[nodiscard]] StartedProgram resume(const std::string& output = "resumed") const {
    Arguments arguments{"run", "--resume", (directory() / "run").string(), "--no-report"};
    std::ranges::copy(network(), std::back_inserter(arguments));
    return start_hybridtest(arguments, output);
  }
  void expect_refused(const std::string& words, const std::string& output) const {
    StartedProgram refused = resume(output);
    EXPECT_THAT(refused.wait(), Optional(kExitConfiguration)) << refused.standard_error();
    EXPECT_THAT(refused.standard_error(), HasSubstr(words));
  }
  /// A test ends safely, and its processes with it.
  static void expect_ends(StartedProgram& run) {
    run.signal(SIGINT);
    EXPECT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  }

  /// Bit for bit, every column but for those named.
  void expect_same_table(const std::string& participant, const std::string& table,
                         const std::vector<std::string>& but_for = {}) const {
    const RunFileReader file = recorded("run").open(participant);
    const RunFileReader other = recorded("simulated").open(participant);
    EXPECT_GT(file.row_count(table), 0U) << participant << "/" << table;
    for (const TableLayout& layout : file.tables()) {
      if (layout.name != table) continue;
      for (const Column& column : layout.columns) {
        if (std::ranges::find(but_for, column.name) != but_for.end()) continue;
        const std::vector<double> resumed = file.column(table, column.name);
        const std::vector<double> whole = other.column(table, column.name);
        ASSERT_EQ(resumed.size(), whole.size()) << participant << "/" << table;
        EXPECT_EQ(std::memcmp(resumed.data(), whole.data(), resumed.size() * sizeof(double)), 0)
            << participant << "/" << table << "/" << column.name;
      }
    }
  }
  /// As an uninterrupted test, which the same scenario under simulated time is (Determinism).
  void expect_whole_test(const Arguments& settings) const {
    StartedProgram simulated = start_simulate(shipped_scenario("two_storey_one_site"), "simulated", settings);
    ASSERT_THAT(simulated.wait(), Optional(kExitCompleted)) << simulated.standard_error();
    expect_same_table("coordinator", "steps", {"wall_time_s"});
    expect_same_table("coordinator", "answers");
    expect_same_table("storey_1", "steps");
    expect_same_table("storey_1", "control");
    expect_same_table("storey_2", "steps");
    const nlohmann::json summary = recorded("run").summary();
    EXPECT_EQ(summary["stop_reason"], "completed");
    EXPECT_EQ(summary["data_valid"], true) << summary["data_faults"];
  }
  /// The recording of the coordinator with other rows. @param change   is given the rows of one table.
  void rewrite_recording(const std::function<void(const TableLayout&, std::vector<double>&)>& change) const {
    const std::filesystem::path file = directory() / "run" / "coordinator.h5";
    const std::filesystem::path original = directory() / "original.h5";
    std::filesystem::rename(file, original);
    const RunFileReader before{original};
    RunFileWriter writer{file, before.header(), before.tables()};
    for (std::size_t table = 0; table < before.tables().size(); ++table) {
      const TableLayout& layout = before.tables()[table];
      std::vector<double> rows = before.rows(layout.name, 0, before.row_count(layout.name));
      change(layout, rows);
      if (!rows.empty()) writer.append(table, rows);
    }
    for (const RecordedEvent& recorded : before.events()) {
      writer.append_events(std::span{&recorded.event, 1}, std::span{&recorded.text, 1});
    }
    writer.flush();
  }
  /// One bit of one force.
  void damage_recording() const {
    rewrite_recording([](const TableLayout& layout, std::vector<double>& rows) {
      if (layout.name != "answers") return;
      double& force_n = rows[300 * layout.columns.size() + layout.position("force_n").value()];
      force_n = std::nextafter(force_n, 1e9);
    });
  }
  /// As after a loss of power, which may take what the operating system had not written out yet.
  void forget_steps_from(double step) const {
    rewrite_recording([&](const TableLayout& layout, std::vector<double>& rows) {
      const std::optional<std::size_t> column = layout.position("step");
      if (!column) return;
      std::size_t row = 0;
      const std::size_t width = layout.columns.size();
      while (row < rows.size() / width && rows[row * width + *column] < step) ++row;
      rows.resize(row * width);
    });
  }
  /// One value of the ground motion that the run keeps, at 0.8 s. The digest of a scenario does not cover its motions.
  void change_motion() const {
    const std::filesystem::path file = directory() / "run" / "ground_motions" / "design_ec8_c.AT2";
    std::istringstream before{text_of(file)};
    std::ofstream after{file, std::ios::trunc};
    constexpr int kLine = 4 + 160 / 8;  // behind the head, with 8 values of 5 ms in a line
    std::string line;
    for (int number = 0; std::getline(before, line); ++number) {
      if (number == kLine) line.replace(0, 10, "  0.500000");
      after << line << '\n';
    }
  }
  /// Every row of every table of these participants is in its file, and each process closed its file itself.
  void expect_nothing_lost(const std::vector<std::string>& participants) const {
    for (const std::string& participant : participants) {
      const RunFileReader file = recorded("run").open(participant);
      EXPECT_TRUE(file.counters().closed_cleanly) << participant;
      EXPECT_FALSE(file.counters().write_failed) << participant;
      EXPECT_EQ(file.counters().dropped_rows(), 0U) << participant;
      const std::vector<double> steps = file.column("steps", "step");
      for (std::size_t i = 0; i < steps.size(); ++i) ASSERT_EQ(steps[i], static_cast<double>(i)) << participant;
    }
  }
};

TEST_F(Resume, KilledCoordinatorGoesOnWithTheSameBits) {
  const Arguments all = settings("100", "8");
  StartedProgram run = start(all);
  kill_at_step(run, 1000.0, {"coordinator"});
  StartedProgram resumed = resume();
  ASSERT_THAT(resumed.wait(), Optional(kExitCompleted)) << resumed.standard_error() << run.standard_error();
  EXPECT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  EXPECT_THAT(run.standard_error(), HasSubstr("the test went on under another"));
  expect_whole_test(all);

  const RecordedRun record = recorded("run");
  const auto continued = record.events("coordinator", EventCode::test_continued);
  ASSERT_EQ(continued.size(), 1U);
  EXPECT_GT(continued[0].values[0], 1000.0);
  EXPECT_EQ(record.events("coordinator", EventCode::test_started).size(), 1U) << "that of the first coordinator";
  for (const char* participant : {"storey_1", "storey_2"}) {
    EXPECT_EQ(record.events(participant, EventCode::coordinator_awaited).size(), 1U) << participant;
    EXPECT_EQ(record.events(participant, EventCode::coordinator_succeeded).size(), 1U) << participant;
  }
  EXPECT_THAT(resumed.standard_output(), HasSubstr("resumed"));
  EXPECT_TRUE(std::filesystem::exists(record.directory() / "before_1" / "coordinator.h5"));
  std::cout << "resumed with " << continued[0].values[0] << " of 8001 steps from the recording, after "
            << continued[0].values[1] << " s\n";
}

TEST_F(Resume, NumericalSubstructureThatDiedIsRestored) {
  const Arguments all = settings("100", "8");
  StartedProgram run = start(all);
  kill_at_step(run, 1000.0, {"coordinator", "storey_2"});
  StartedProgram resumed = resume();
  ASSERT_THAT(resumed.wait(), Optional(kExitCompleted)) << resumed.standard_error() << run.standard_error();
  EXPECT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  expect_whole_test(all);
}

/// The motion of a paced test depends on when its commands come, so its bits do; every step is imposed once.
TEST_F(Resume, PacedSpecimenIsHeldAndEachStepImposedOnce) {
  Arguments all = settings("100", "4");
  all.insert(all.end(), {"--set", "time.mode=paced", "--set", "time.step_s=0.01"});
  StartedProgram run = start(all);
  kill_at_step(run, 100.0, {"coordinator"});
  StartedProgram resumed = resume();
  ASSERT_THAT(resumed.wait(), Optional(kExitCompleted)) << resumed.standard_error() << run.standard_error();
  EXPECT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();

  const RecordedRun record = recorded("run");
  for (const char* participant : {"coordinator", "storey_1", "storey_2"}) {
    const std::vector<double> steps = record.column(participant, "steps", "step");
    ASSERT_EQ(steps.size(), 401U) << participant;
    for (std::size_t i = 0; i < steps.size(); ++i) ASSERT_EQ(steps[i], static_cast<double>(i)) << participant;
  }
  const auto awaited = record.events("storey_1", EventCode::coordinator_awaited);
  const auto succeeded = record.events("storey_1", EventCode::coordinator_succeeded);
  ASSERT_EQ(awaited.size(), 1U);
  ASSERT_EQ(succeeded.size(), 1U);
  // Control periods without motion follow each other for as long as the site waited.
  const std::vector<double> command_m = record.column("storey_1", "control", "command_displacement_m");
  std::size_t longest = 0;
  std::size_t still = 0;
  for (std::size_t i = 1; i < command_m.size(); ++i) {
    still = command_m[i] == command_m[i - 1] ? still + 1 : 0;
    longest = std::max(longest, still);
    ASSERT_LE(std::abs(command_m[i] - command_m[i - 1]), 1.5 / 1000.0) << "the velocity limit, row " << i;
  }
  const std::vector<double> time_s = record.column("storey_1", "control", "time_s");
  const double held_s = static_cast<double>(longest) * (time_s[1] - time_s[0]);
  EXPECT_GE(held_s, to_seconds(succeeded[0].clock - awaited[0].clock));
  EXPECT_GE(record.summary()["stalls"]["count"], 1);
  std::cout << "held for " << held_s << " s\n";
}

TEST_F(Resume, ClocksOfBothCoordinatorsAreOnOneTimeBase) {
  Arguments all = settings("100", "4");
  all.insert(all.end(), {"--set", "time.mode=paced", "--set", "time.step_s=0.01"});
  StartedProgram run = start(all);
  kill_at_step(run, 200.0, {"coordinator"});
  StartedProgram resumed = resume();
  ASSERT_THAT(resumed.wait(), Optional(kExitCompleted)) << resumed.standard_error() << run.standard_error();
  EXPECT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();

  const RecordedRun record = recorded("run");
  const auto column = [&](const std::string& name) { return record.column("coordinator", "clocks", name); };
  const std::vector<double> who = column("substructure");
  const std::vector<double> at_s = column("there_at_s");
  const std::vector<double> there_s = column("least_there_s");
  const std::vector<double> back_s = column("least_back_s");
  const auto continued = record.events("coordinator", EventCode::test_continued);
  ASSERT_EQ(continued.size(), 1U);
  ASSERT_FALSE(at_s.empty());
  EXPECT_LT(at_s.front(), to_seconds(continued[0].clock)) << "of the first coordinator";
  EXPECT_GT(at_s.back(), to_seconds(continued[0].clock)) << "of the second";
  // On one machine the clocks differ by their zeros. No latency is negative.
  const double zero_s = record.open("coordinator").header().t0_unix_s;
  const std::array offset_s{zero_s - record.open("storey_1").header().t0_unix_s,
                            zero_s - record.open("storey_2").header().t0_unix_s};
  constexpr double kReadingError_s = 1e-3;
  for (std::size_t i = 0; i < who.size(); ++i) {
    const double offset = offset_s.at(static_cast<std::size_t>(who[i]));
    EXPECT_GT(there_s[i], offset - kReadingError_s) << i;
    EXPECT_GT(back_s[i], -offset - kReadingError_s) << i;
    if (i >= 2 && who[i] == who[i - 2]) {
      EXPECT_GT(at_s[i], at_s[i - 2]) << i;
    }
  }
}

TEST_F(Resume, CoordinatorThatDiesTwiceGoesOnTwice) {
  const Arguments all = settings("100", "8");
  StartedProgram run = start(all);
  kill_at_step(run, 1000.0, {"coordinator"});
  StartedProgram second = resume("second");
  ASSERT_TRUE(has_recorded("run", "coordinator", 3000.0)) << second.standard_error();
  ASSERT_TRUE(send_signal(participant_of(second, kCoordinatorId), SIGKILL));
  StartedProgram third = resume("third");
  ASSERT_THAT(third.wait(), Optional(kExitCompleted)) << third.standard_error() << second.standard_error();
  EXPECT_THAT(second.wait(), Optional(kExitEndedEarly)) << second.standard_error();
  EXPECT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  expect_whole_test(all);
  EXPECT_EQ(recorded("run").events("coordinator", EventCode::test_continued).size(), 2U);
}

TEST_F(Resume, RefusesOtherScenariosAndLostSites) {
  StartedProgram run = start(settings("100", "600"));
  ASSERT_TRUE(has_recorded("run", "coordinator", 500.0)) << run.standard_error();
  expect_refused("is still running", "alive");
  kill_at_step(run, 500.0, {"coordinator"});
  const std::filesystem::path scenario = directory() / "run" / "scenario.yaml";
  const std::string text = text_of(scenario);
  std::string other = text;
  const auto at = other.rfind("stiffness_n_per_m: 3.0e+06");
  ASSERT_NE(at, std::string::npos) << text;
  std::ofstream{scenario} << other.replace(at, 26, "stiffness_n_per_m: 3.1e+06");
  expect_refused("the scenario differs from that of the recording", "other");
  std::ofstream{scenario} << text;
  const pid_t site = participant_of(run, "storey_1");
  ASSERT_TRUE(send_signal(site, SIGKILL));
  expect_refused("A site cannot be restarted in the middle of a test", "site");
  expect_ends(run);
}

TEST_F(Resume, RefusesARecordingWithOneOtherBit) {
  StartedProgram run = start(settings("100", "600"));
  kill_at_step(run, 1000.0, {"coordinator"});
  damage_recording();
  expect_refused("comes out differently than it was recorded", "damaged");
  expect_refused("who waits for it still waits", "again");
  EXPECT_TRUE(run.is_running());
  expect_ends(run);
}

/// The control of the next test: what the site had imposed and the recording does not have comes from its memory.
TEST_F(Resume, OlderRecordingGoesOnWithTheSameBits) {
  const Arguments all = settings("100", "4");
  StartedProgram run = start(all);
  kill_at_step(run, 1000.0, {"coordinator", "storey_2"});
  forget_steps_from(700.0);
  StartedProgram resumed = resume();
  ASSERT_THAT(resumed.wait(), Optional(kExitCompleted)) << resumed.standard_error() << run.standard_error();
  EXPECT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  const auto continued = recorded("run").events("coordinator", EventCode::test_continued);
  ASSERT_EQ(continued.size(), 1U);
  EXPECT_EQ(continued[0].values[0], 700.0);
  expect_whole_test(all);
}

/// The recording is whole up to step 700, so the coordinator cannot tell; the site has imposed the steps behind it.
TEST_F(Resume, SiteRefusesAnotherDisplacementThanItImposed) {
  const Arguments all = settings("100", "4");
  StartedProgram run = start(all);
  kill_at_step(run, 1000.0, {"coordinator", "storey_2"});
  const std::vector<pid_t> processes = run.children();
  EXPECT_FALSE(processes.empty());
  forget_steps_from(700.0);
  change_motion();
  StartedProgram resumed = resume();
  ASSERT_THAT(resumed.wait(), Optional(kExitEndedEarly)) << resumed.standard_error() << run.standard_error();
  EXPECT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  for (const pid_t process : processes) EXPECT_FALSE(is_alive(process)) << process;

  const RecordedRun record = recorded("run");
  const nlohmann::json summary = record.summary();
  EXPECT_EQ(summary["stop_reason"], "resume_refused");
  EXPECT_EQ(summary["end"]["who"], "storey_1");
  EXPECT_THAT(summary["end"]["why"].get<std::string>(), HasSubstr("the resumed coordinator asked 'storey_1' for"));
  EXPECT_THAT(resumed.standard_output() + resumed.standard_error(),
              HasSubstr("a specimen cannot go back: start a new test"));
  const auto refused = record.events("storey_1", EventCode::imposed_differently);
  ASSERT_EQ(refused.size(), 1U);

  // Steps from 700 on are answered from memory. The motion differs behind 0.795 s, where the line to 0.8 s begins, and
  // the first displacement that depends on it is that of the step behind.
  expect_nothing_lost({"coordinator", "storey_1", "storey_2"});
  const std::vector<double> completed = record.column("coordinator", "steps", "step");
  ASSERT_EQ(completed.size(), 797U);
  EXPECT_EQ(refused[0].step, 797);
  EXPECT_NEAR(summary["end"]["model_time_s"].get<double>(), 0.797, 1e-9);
  std::cout << completed.size() << " steps completed, refused " << refused[0].values[1] << " m where "
            << refused[0].values[0] << " m was imposed\n";

  // The site has each step once and with the bits of an uninterrupted test.
  StartedProgram simulated = start_simulate(shipped_scenario("two_storey_one_site"), "simulated", all);
  ASSERT_THAT(simulated.wait(), Optional(kExitCompleted)) << simulated.standard_error();
  const RecordedRun whole = recorded("simulated");
  const auto rows_alike = [&](const std::string& table, const std::string& column) {
    const std::vector<double> imposed = record.column("storey_1", table, column);
    const std::vector<double> other = whole.column("storey_1", table, column);
    std::size_t row = 0;
    while (row < imposed.size() && row < other.size() && std::memcmp(&imposed[row], &other[row], sizeof(double)) == 0) {
      ++row;
    }
    return row;
  };
  const std::vector<double> target_m = record.column("storey_1", "steps", "target_displacement_m");
  ASSERT_GT(target_m.size(), 1000U);
  for (const char* name : {"step", "target_displacement_m", "measured_displacement_m", "measured_force_n"}) {
    EXPECT_EQ(rows_alike("steps", name), target_m.size()) << name;
  }
  EXPECT_EQ(refused[0].values[0], target_m.at(completed.size()));
  EXPECT_NE(refused[0].values[1], target_m.at(completed.size()));

  // Each step takes two control periods. Behind the last one the rig follows no target: the site moves it back to rest.
  const std::vector<double> follows = record.column("storey_1", "control", "follows_targets");
  const std::size_t in_test = 2 * (target_m.size() - 1) + 1;
  ASSERT_GT(follows.size(), in_test);
  for (std::size_t row = 0; row < follows.size(); ++row) ASSERT_EQ(follows[row], row < in_test ? 1.0 : 0.0) << row;
  for (const char* name : {"target_displacement_m", "command_displacement_m", "measured_displacement_m"}) {
    EXPECT_GE(rows_alike("control", name), in_test) << name;
  }
  EXPECT_EQ(record.column("storey_1", "control", "command_displacement_m").back(), 0.0);
}

TEST_F(Resume, SitesEndSafelyWhenNobodyResumes) {
  StartedProgram run = start(settings("1", "600"));
  kill_at_step(run, 500.0, {"coordinator"});
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  EXPECT_EQ(recorded("run").summary()["stop_reason"], "coordinator_lost");
  expect_refused("has ended the test safely", "late");
  EXPECT_TRUE(recorded("run").open("storey_1").counters().closed_cleanly);
}

}  // namespace
}  // namespace hybridtest
