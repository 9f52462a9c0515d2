#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/system_fixture.hpp"

/// `hybridtest reference`: a test without coupling, and a run against it.
namespace hybridtest {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Optional;

class ReferenceCommand : public SystemTest {
 protected:
  std::string made(Arguments arguments, int exit_code = kExitCompleted) {
    arguments.insert(arguments.begin(), "reference");
    StartedProgram started = start_hybridtest(arguments, "reference");
    EXPECT_THAT(started.wait(), Optional(exit_code)) << started.standard_error();
    return exit_code == kExitCompleted ? started.standard_output() : started.standard_error();
  }
  [[nodiscard]] double largest_difference(const std::string& run) const {
    return recorded(run).summary()["references"][0]["degrees_of_freedom"][0]["difference_relative"];
  }
  void simulate_ideal(const std::string& run) {
    StartedProgram simulated = start_simulate(shipped_scenario("two_storey_one_site"), run, ideal_);
    ASSERT_THAT(simulated.wait(), Optional(kExitCompleted)) << simulated.standard_error();
  }

  const Arguments ideal_{"--set", "substructures[storey_1].rig.transfer_system={type: ideal}",
                         "--set", "substructures[storey_1].rig.sensors={}",
                         "--set", "substructures[storey_1].compensator={type: none}"};
};

TEST_F(ReferenceCommand, IdealRunIsWithinTheErrorOfItsIntegrator) {
  simulate_ideal("run");
  const std::string scenario = (recorded("run").directory() / "scenario.yaml").string();
  EXPECT_THAT(made({scenario, "--run", recorded("run").directory().string()}),
              AllOf(HasSubstr("against reference in_process"), HasSubstr("floor_2")));
  // Central differences against average acceleration: the errors of their periods, -0.04 and +0.08 % at w dt = 0.1.
  EXPECT_LT(largest_difference("run"), 5e-4);
  StartedProgram summary = start_hybridtest({"summary", recorded("run").directory().string()}, "summary");
  ASSERT_THAT(summary.wait(), Optional(kExitCompleted));
  EXPECT_THAT(summary.standard_output(), HasSubstr("against reference in_process"));
  EXPECT_TRUE(std::filesystem::exists(recorded("run").directory() / "reference" / "in_process.csv"));
}

TEST_F(ReferenceCommand, ControlWrongNumberIsSeen) {
  simulate_ideal("run");
  const std::string scenario = (recorded("run").directory() / "scenario.yaml").string();
  made({scenario, "--run", recorded("run").directory().string(), "--set",
        "substructures[storey_2].model.stiffness_n_per_m=3.3e6"});
  EXPECT_GT(largest_difference("run"), 0.02);
}

TEST_F(ReferenceCommand, WrongInputIsRefusedInWords) {
  EXPECT_THAT(made({shipped_scenario("opensees/shear_frame").string()}, kExitConfiguration),
              HasSubstr("OpenSees leads this test"));
}

}  // namespace
}  // namespace hybridtest
