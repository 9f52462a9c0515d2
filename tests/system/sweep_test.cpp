#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/system_fixture.hpp"

/// `hybridtest sweep`: one table, whoever runs the cases and in what order.
namespace hybridtest {
namespace {

using ::testing::HasSubstr;
using ::testing::Optional;

class Sweep : public SystemTest {
 protected:
  /// Eight short tests: two delays, two probabilities of loss, two seeds, with sensor noise of each case.
  [[nodiscard]] Arguments arguments(const std::string& folder, const Arguments& more = {}) const {
    Arguments all{"sweep",   shipped_scenario("two_storey_one_site").string(),
                  "--set",   "time.duration_s=0.5",
                  "--vary",  "substructures[storey_1].rig.transfer_system.delay_s=0.002,0.006",
                  "--vary",  "loss=0,0.05",
                  "--vary",  "substructures[storey_1].rig.sensors.seed=@seed",
                  "--seeds", "1..2",
                  "--out",   (directory() / folder).string()};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  [[nodiscard]] std::string table(const std::string& folder) const {
    return text_of(directory() / folder / "table.csv");
  }
  void expect_exit(StartedProgram program, int code) const {
    EXPECT_THAT(program.wait(), Optional(code)) << program.standard_output() << program.standard_error();
  }
};

TEST_F(Sweep, TableDoesNotDependOnTheNumberOfJobs) {
  expect_exit(start_hybridtest(arguments("one", {"--jobs", "1"}), "one"), kExitCompleted);
  expect_exit(start_hybridtest(arguments("three", {"--jobs", "3"}), "three"), kExitCompleted);
  const std::string one = table("one");
  EXPECT_EQ(std::ranges::count(one, '\n'), 9);
  EXPECT_THAT(one, HasSubstr("peak_displacement_floor_1_m"));
  EXPECT_EQ(one, table("three"));
  EXPECT_THAT(text_of(directory() / "one" / "index.html"), HasSubstr("Fragility over loss"));
  EXPECT_FALSE(std::filesystem::exists(directory() / "one" / "cases" / "000001_run")) << "kept on request alone";
}

TEST_F(Sweep, InterruptedSweepGoesOnToTheSameTable) {
  expect_exit(start_hybridtest(arguments("whole"), "whole"), kExitCompleted);
  StartedProgram cut = start_hybridtest(arguments("cut", {"--jobs", "1"}), "cut");
  ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(directory() / "cut" / "cases" / "000002.json"); }));
  cut.signal(SIGKILL);
  ASSERT_TRUE(cut.wait().has_value());
  ASSERT_FALSE(std::filesystem::exists(directory() / "cut" / "cases" / "000008.json"))
      << "cut too late to show anything";
  expect_exit(start_hybridtest({"sweep", (directory() / "cut").string()}, "go_on"), kExitCompleted);
  EXPECT_EQ(table("cut"), table("whole"));
}

TEST_F(Sweep, WorkersOfGnuParallelGiveTheSameTable) {
  if (std::system("parallel --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "GNU parallel is not installed";
  expect_exit(start_hybridtest(arguments("own"), "own"), kExitCompleted);
  expect_exit(start_hybridtest(arguments("others", {"--prepare"}), "prepare"), kExitCompleted);
  const std::string jobs = (directory() / "others" / "jobs.txt").string();
  ASSERT_EQ(std::system(("parallel --jobs 2 < '" + jobs + "' > /dev/null 2>&1").c_str()), 0);
  expect_exit(start_hybridtest({"sweep", (directory() / "others").string()}, "collect"), kExitCompleted);
  EXPECT_EQ(table("others"), table("own"));
}

TEST_F(Sweep, WrongValueIsToldBeforeTheFirstCase) {
  StartedProgram wrong = start_hybridtest(arguments("wrong", {"--vary", "time.step=0.001"}), "wrong");
  EXPECT_THAT(wrong.wait(), Optional(kExitConfiguration));
  EXPECT_THAT(wrong.standard_error(), HasSubstr("time.step"));
  EXPECT_FALSE(std::filesystem::exists(directory() / "wrong"));
}

/// In real time a substructure whose round trip does not fit into a step is too far away.
TEST_F(Sweep, LatencyOfOneSubstructureIsVaried) {
  const Arguments sweep{"sweep",   shipped_scenario("two_storey_one_site").string(),
                        "--set",   "time={mode: real_time, step_s: 0.01, duration_s: 0.5}",
                        "--vary",  "site_latency_us[storey_2]=100,50000",
                        "--vary",  "latency_spread=0,0.3",
                        "--seeds", "1..2",
                        "--out",   (directory() / "far").string()};
  expect_exit(start_hybridtest(sweep, "far"), kExitCompleted);
  const std::string far = table("far");
  EXPECT_THAT(far, HasSubstr("site_latency_us[storey_2],latency_spread"));
  std::istringstream lines{far};
  int near_ones = 0;
  int far_ones = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.find(",100,") != std::string::npos) {
      ++near_ones;
      EXPECT_THAT(line, HasSubstr(",completed,"));
    }
    if (line.find(",50000,") != std::string::npos) {
      ++far_ones;
      EXPECT_THAT(line, HasSubstr(",network_too_slow,"));
    }
  }
  EXPECT_EQ(near_ones, 4) << far;
  EXPECT_EQ(far_ones, 4) << far;
}

TEST_F(Sweep, LatencyOfAnUnknownSubstructureIsRefused) {
  StartedProgram wrong = start_hybridtest(arguments("wrong", {"--vary", "site_latency_us[storey_9]=1,2"}), "wrong");
  EXPECT_THAT(wrong.wait(), Optional(kExitConfiguration));
  EXPECT_THAT(wrong.standard_error(), HasSubstr("the scenario has no substructure 'storey_9'"));
  EXPECT_FALSE(std::filesystem::exists(directory() / "wrong"));
}

TEST_F(Sweep, FolderOfAnotherSweepIsNotMixedIn) {
  expect_exit(start_hybridtest(arguments("folder", {"--prepare"}), "first"), kExitCompleted);
  StartedProgram other = start_hybridtest(arguments("folder", {"--vary", "jitter_us=0,10"}), "other");
  EXPECT_THAT(other.wait(), Optional(kExitConfiguration));
  EXPECT_THAT(other.standard_error(), HasSubstr("choose another --out"));
}

}  // namespace
}  // namespace hybridtest
