#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "recording/run_file_reader.hpp"
#include "recording/summary/clock_relation.hpp"
#include "tests/support/recording_checks.hpp"
#include "tests/support/system_fixture.hpp"

/// The three programs started one by one, as on three hosts: each with its own records, combined later.
namespace hybridtest {
namespace {

using ::testing::HasSubstr;
using ::testing::Optional;

class ByHand : public SystemTest {};

TEST_F(ByHand, ThreeProgramsStartedInAnyOrderCompleteATest) {
  const std::filesystem::path scenario = shipped_scenario("two_storey_one_site");
  const Arguments arguments{"--set", "time.duration_s=2"};
  StartedProgram site = start_participant("experimental_site", "storey_1", scenario, "at_site", arguments);
  StartedProgram numerical =
      start_participant("numerical_substructure", "storey_2", scenario, "at_computer", arguments);
  StartedProgram coordinator = start_participant("coordinator", "coordinator", scenario, "at_control", arguments);
  EXPECT_THAT(coordinator.wait(), Optional(kExitCompleted)) << coordinator.standard_error();
  EXPECT_THAT(site.wait(), Optional(kExitCompleted)) << site.standard_error();
  EXPECT_THAT(numerical.wait(), Optional(kExitCompleted)) << numerical.standard_error();

  // Each said what it waited for and where; the coordinator showed how far the test was, and a summary.
  EXPECT_THAT(site.standard_error(), HasSubstr("waiting up to 30 s for the coordinator"));
  EXPECT_THAT(numerical.standard_error(), HasSubstr("DDS domain " + network().back()));
  EXPECT_THAT(coordinator.standard_error(), HasSubstr("waiting up to 30 s for the substructures"));
  EXPECT_THAT(coordinator.standard_error(), HasSubstr("step "));
  EXPECT_THAT(coordinator.standard_output(), HasSubstr("COMPLETED"));

  // The records of the coordinator alone are not the whole test, but a valid part of it.
  const std::filesystem::path together = directory() / "at_control";
  std::filesystem::copy(recorded("at_site").file("storey_1"), together);
  std::filesystem::copy(recorded("at_computer").file("storey_2"), together);
  StartedProgram summary = start_hybridtest({"summary", together.string()}, "summary");
  ASSERT_THAT(summary.wait(), Optional(kExitCompleted)) << summary.standard_error();
  EXPECT_THAT(summary.standard_output(), HasSubstr("COMPLETED"));
  const nlohmann::json values = recorded("at_control").summary();
  EXPECT_EQ(values["completed_steps"], 2000);
  EXPECT_EQ(values["participants"].size(), 3U);
  EXPECT_EQ(values["data_valid"], true) << values["data_faults"];

  // The clocks of the processes start with them; on one host the wall clock tells how far apart.
  const RunFileReader control{recorded("at_control").file("coordinator")};
  const std::vector<ParticipantClock> clocks = participant_clocks(control);
  ASSERT_EQ(clocks.size(), 2U);
  for (const ParticipantClock& clock : clocks) {
    const RunFileReader file{recorded("at_control").file(clock.participant)};
    ASSERT_FALSE(clock.parts.empty());
    const ClockRelation& relation = clock.parts.front();
    const double truth_s = control.header().t0_unix_s - file.header().t0_unix_s;
    constexpr double kWallClock_s = 20e-6;  // read beside the other clock, and a double holds it to 0.2 us
    EXPECT_LE(std::abs(relation.offset_s - truth_s), relation.offset_uncertainty_s + kWallClock_s) << clock.participant;
    EXPECT_LT(relation.offset_uncertainty_s, 0.01) << clock.participant;
  }

  StartedProgram simulated = start_simulate(scenario, "simulated", arguments);
  ASSERT_THAT(simulated.wait(), Optional(kExitCompleted)) << simulated.standard_error();
  EXPECT_EQ(recorded("at_control").column("coordinator", "steps", "displacement_floor_2_m"),
            recorded("simulated").column("coordinator", "steps", "displacement_floor_2_m"));
}

TEST_F(ByHand, RunDirectoryCanBeRunAgain) {
  StartedProgram first = start_simulate(shipped_scenario("two_storey_one_site"), "run", {"--set", "time.duration_s=1"});
  ASSERT_THAT(first.wait(), Optional(kExitCompleted)) << first.standard_error();
  StartedProgram again = start_simulate(recorded("run").directory() / "scenario.yaml", "again");
  ASSERT_THAT(again.wait(), Optional(kExitCompleted)) << again.standard_error();
  EXPECT_EQ(recorded("run").summary()["scenario_digest"], recorded("again").summary()["scenario_digest"]);
  EXPECT_EQ(recorded("run").column("coordinator", "steps", "displacement_floor_2_m"),
            recorded("again").column("coordinator", "steps", "displacement_floor_2_m"));
}

}  // namespace
}  // namespace hybridtest
