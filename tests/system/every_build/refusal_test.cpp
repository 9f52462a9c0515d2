#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/recording_checks.hpp"
#include "tests/support/system_fixture.hpp"

/// Participants that do not belong to a test are refused, without an effect on the test.
namespace hybridtest {
namespace {

using ::testing::HasSubstr;
using ::testing::Optional;

class Refusal : public SystemTest {};

TEST_F(Refusal, DuplicatesExitAndTestContinues) {
  // Paced, so that the test lasts longer than the refusal takes.
  const std::filesystem::path scenario = shipped_scenario("two_storey_one_site");
  const Arguments paced{"--set", "time.mode=paced", "--set", "time.step_s=0.01", "--set", "time.duration_s=8"};
  StartedProgram run = start_run(scenario, "run", paced);
  ASSERT_TRUE(has_recorded("run", "storey_1", 50.0)) << run.standard_error();
  StartedProgram coordinator = start_participant("coordinator", "coordinator", scenario, "second", paced);
  StartedProgram site = start_participant("experimental_site", "storey_1", scenario, "second", paced);
  StartedProgram numerical = start_participant("numerical_substructure", "storey_2", scenario, "second", paced);
  EXPECT_THAT(coordinator.wait(), Optional(kExitConfiguration));
  EXPECT_THAT(site.wait(), Optional(kExitConfiguration));
  EXPECT_THAT(numerical.wait(), Optional(kExitConfiguration));
  EXPECT_TRUE(run.is_running()) << "the test was over before the intruders were";
  EXPECT_THAT(coordinator.standard_error(), HasSubstr("another coordinator is already running this test"));
  EXPECT_THAT(site.standard_error(), HasSubstr("another participant with the id 'storey_1'"));
  EXPECT_THAT(numerical.standard_error(), HasSubstr("another participant with the id 'storey_2'"));

  ASSERT_THAT(run.wait(), Optional(kExitCompleted)) << run.standard_error();
  const nlohmann::json summary = recorded("run").summary();
  EXPECT_EQ(summary["completed_steps"], 800);
  EXPECT_EQ(summary["data_valid"], true);
  for (const char* participant : {"coordinator", "storey_1", "storey_2"}) {
    expect_all_steps_from_the_first(recorded("run"), participant);
  }
  // The intruders' answers were not taken for the participants' own.
  for (const auto& substructure : summary["substructures"]) EXPECT_EQ(substructure["exchange"]["lost"], 0);
}

TEST_F(Refusal, OtherScenarioIsRefusedAndBothSidesReportIt) {
  const std::filesystem::path scenario = shipped_scenario("two_storey_one_site");
  StartedProgram run = start_run(scenario, "run", {"--remote", "storey_2", "--loopback-only"});
  StartedProgram other = start_participant("numerical_substructure", "storey_2", scenario, "other",
                                           {"--set", "substructures[storey_2].model.stiffness_n_per_m=3.1e6"});
  ASSERT_THAT(other.wait(), Optional(kExitConfiguration)) << other.standard_error();
  ASSERT_THAT(run.wait(), Optional(kExitConfiguration)) << run.standard_error();
  EXPECT_THAT(other.standard_error(), HasSubstr("the scenario differs from that of 'coordinator'"));
  EXPECT_THAT(run.standard_error(), HasSubstr("the scenario differs from that of 'storey_2'"));

  EXPECT_EQ(recorded("run").summary()["stop_reason"], "refused");
  EXPECT_EQ(recorded("run").events("coordinator", EventCode::digest_mismatch).size(), 1U);
  EXPECT_EQ(recorded("other").events("storey_2", EventCode::digest_mismatch).size(), 1U);
  EXPECT_TRUE(recorded("run").events("coordinator", EventCode::test_armed).empty());
  EXPECT_EQ(recorded("run").open("storey_1").row_count("control"), 0U);
}

}  // namespace
}  // namespace hybridtest
