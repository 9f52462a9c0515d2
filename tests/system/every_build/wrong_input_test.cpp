#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <string>

#include "tests/support/system_fixture.hpp"

/// Errors of a user are reported with what, where and what was expected, and exit code 2.
namespace hybridtest {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::Optional;

class WrongInput : public SystemTest {
 protected:
  /// The error message of the program.
  [[nodiscard]] std::string refusal(const std::string& program_name, const Arguments& arguments) const {
    StartedProgram started{
        program(program_name), arguments, directory() / program_name, {.working_directory = directory()}};
    EXPECT_THAT(started.wait(), Optional(kExitConfiguration)) << started.standard_error();
    return started.standard_error();
  }
};

TEST_F(WrongInput, ListsEveryScenarioErrorWithItsPlace) {
  const std::string scenario = system_scenario("many_errors");
  const auto says_all = AllOf(HasSubstr("many_errors.yaml:5:24: "), HasSubstr("did you mean 'step_s'"),      // stepp_s
                              HasSubstr("many_errors.yaml:9:"), HasSubstr("many_errors.yaml:10:"),           //
                              HasSubstr("many_errors.yaml:15:"), HasSubstr("did you mean 'floor_1'"),        // flor_1
                              HasSubstr("many_errors.yaml:20:"), HasSubstr("did you mean 'second_order'"));  // seconds
  EXPECT_THAT(refusal("hybridtest", {"check", scenario}), says_all);
  EXPECT_THAT(refusal("hybridtest", {"run", scenario}), says_all);
  EXPECT_THAT(refusal("hybridtest", {"simulate", scenario, "--seed", "1"}), says_all);
  EXPECT_THAT(refusal("coordinator", {"--scenario", scenario}), says_all);
  EXPECT_FALSE(std::filesystem::exists(directory() / "runs")) << "nothing is written for a test that cannot be";
}

TEST_F(WrongInput, NamesMissingFile) {
  EXPECT_THAT(refusal("hybridtest", {"run", "no_such_scenario.yaml"}), HasSubstr("no_such_scenario.yaml"));
  EXPECT_THAT(refusal("hybridtest", {"check", shipped_scenario("two_storey_one_site"), "--set",
                                     "excitation.ground_motion=no_such_motion.AT2"}),
              AllOf(HasSubstr("ground_motion"), HasSubstr("launch/scenarios/no_such_motion.AT2"),
                    HasSubstr("a relative path starts at the folder of the scenario file")));
}

TEST_F(WrongInput, ExplainsOverrideThatDoesNotApply) {
  const std::string scenario = shipped_scenario("two_storey_one_site");
  EXPECT_THAT(refusal("hybridtest", {"run", scenario, "--set", "time.stepp_s=0.002"}),
              AllOf(HasSubstr("stepp_s"), HasSubstr("did you mean 'step_s'")));
  EXPECT_THAT(refusal("hybridtest", {"run", scenario, "--set", "nonsense"}), HasSubstr("expected key.path=value"));
  EXPECT_THAT(refusal("hybridtest", {"run", scenario, "--set", "time.step_s=fast"}),
              AllOf(HasSubstr("--set time.step_s"), HasSubstr("fast")));
}

TEST_F(WrongInput, RejectsStepAboveStabilityLimit) {
  EXPECT_THAT(refusal("hybridtest", {"run", shipped_scenario("two_storey_one_site"), "--set", "time.step_s=0.2"}),
              AllOf(HasSubstr("time: the step of 0.2 s is too long"), HasSubstr("at most T_n/pi")));
}

TEST_F(WrongInput, RejectsUnknownIdAndListsKnownOnes) {
  const std::string scenario = shipped_scenario("two_storey_one_site");
  EXPECT_THAT(refusal("experimental_site", {"--scenario", scenario, "--id", "storey_9"}),
              AllOf(HasSubstr("storey_9"), HasSubstr("storey_1, storey_2")));
  EXPECT_THAT(refusal("experimental_site", {"--scenario", scenario, "--id", "storey_2"}),
              HasSubstr("numerical_substructure"));
  EXPECT_THAT(refusal("hybridtest", {"run", scenario, "--remote", "storey_9"}), HasSubstr("storey_9"));
  EXPECT_THAT(refusal("experimental_site", {"--scenario", scenario}), HasSubstr("--id"));
}

TEST_F(WrongInput, RejectsEmptyNamesAndIds) {
  const std::string scenario = shipped_scenario("two_storey_one_site");
  for (const char* path : {"name", "substructures[storey_1].id", "excitation.ground_motion"}) {
    const std::string empty = std::string{path} + "=\"\"";
    const auto names_it =
        AllOf(HasSubstr(std::string{"--set "} + path), HasSubstr("expected a text, found an empty one"));
    EXPECT_THAT(refusal("hybridtest", {"check", scenario, "--set", empty}), names_it);
    EXPECT_THAT(refusal("hybridtest", {"simulate", scenario, "--seed", "1", "--set", empty}), names_it);
    EXPECT_THAT(refusal("hybridtest", {"run", scenario, "--set", empty}), names_it);
  }
  EXPECT_THAT(refusal("hybridtest", {"stop", ""}), HasSubstr("test name ''"));
  EXPECT_FALSE(std::filesystem::exists(directory() / "runs"));
}

TEST_F(WrongInput, NetworkOptionsAreRefusedBeforeAnythingIsWritten) {
  const std::string scenario = shipped_scenario("two_storey_one_site");
  std::ofstream{directory() / "no_profile.xml"} << "no xml";
  const std::vector<std::pair<Arguments, std::string>> cases{
      {{"--peer", "127.0.0.1:99999"}, "peer '127.0.0.1:99999': expected host or host:port"},
      {{"--peer", "no.such.host.invalid"}, "peer 'no.such.host.invalid': this host has no IPv4 address"},
      {{"--discovery-server", "lab:x"}, "discovery server 'lab:x': expected host or host:port"},
      {{"--profile", "no_profile.xml"}, "no_profile.xml: is not a valid profile file"}};
  for (const auto& one : cases) {
    const Arguments& option = one.first;
    const std::string& message = one.second;
    const auto with_option = [&option](Arguments arguments) {
      arguments.insert(arguments.end(), option.begin(), option.end());
      return arguments;
    };
    EXPECT_THAT(refusal("hybridtest", with_option({"run", scenario})), HasSubstr(message));
    EXPECT_THAT(refusal("coordinator", with_option({"--scenario", scenario})), HasSubstr(message));
    EXPECT_THAT(refusal("hybridtest", with_option({"stop", "nobody"})), HasSubstr(message));
  }
  static_cast<void>(refusal("experimental_site", {"--scenario", scenario, "--id", "storey_9"}));
  EXPECT_FALSE(std::filesystem::exists(directory() / "runs")) << "a folder is left of a test that cannot start";
}

TEST_F(WrongInput, RefusesNamedPipesWithoutWaiting) {
  const std::filesystem::path pipe = directory() / "pipe.AT2";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const std::string scenario = shipped_scenario("two_storey_one_site");
  const auto is_refused = AllOf(HasSubstr("pipe.AT2"), HasSubstr("it is a named pipe"));
  const auto check_with = [&](const std::string& value) {
    return refusal("hybridtest", {"check", scenario, "--set", value});
  };
  const std::string rig = "substructures[storey_1].rig=";
  EXPECT_THAT(check_with("excitation.ground_motion=" + pipe.string()), is_refused);
  EXPECT_THAT(check_with(rig + "{model: " + pipe.string() + "}"), is_refused);
  EXPECT_THAT(check_with(rig + "{type: replay, recording: " + pipe.string() + "}"), is_refused);
  EXPECT_THAT(check_with("substructures[storey_2].model={type: elastic, matrix_market: " + pipe.string() + "}"),
              is_refused);
  EXPECT_THAT(refusal("hybridtest", {"check", pipe}), is_refused);
  EXPECT_THAT(refusal("hybridtest", {"run", scenario, "--profile", pipe}), is_refused);
  EXPECT_THAT(refusal("hybridtest", {"replay", "--model", pipe, "--recording", "x.csv", "--out", "y.csv"}), is_refused);
  std::ofstream{directory() / "site.yaml"} << "specimen: {type: elastic, stiffness_n_per_m: 1.0e6}\n";
  EXPECT_THAT(refusal("hybridtest", {"replay", "--model", "site.yaml", "--recording", pipe, "--out", "y.csv"}),
              is_refused);

  ASSERT_TRUE(std::filesystem::create_directory(directory() / "run"));
  ASSERT_EQ(::mkfifo((directory() / "run" / "coordinator.h5").c_str(), 0600), 0);
  StartedProgram summary = start_hybridtest({"summary", "run"}, "summary");
  EXPECT_THAT(summary.wait(), Optional(kExitDataInvalid));
  EXPECT_THAT(summary.standard_error(), HasSubstr("coordinator.h5: opening: it is a named pipe"));
}

TEST_F(WrongInput, FaultTimesAreCheckedAndNamedSimulatedTime) {
  const std::string scenario = shipped_scenario("two_storey_one_site");
  for (const char* outage : {"storey_1:2:1", "storey_1:1:1"}) {
    EXPECT_THAT(refusal("hybridtest", {"simulate", scenario, "--seed", "1", "--outage", outage}),
                AllOf(HasSubstr(outage), HasSubstr("the end is not after the begin")));
  }
  EXPECT_FALSE(std::filesystem::exists(directory() / "runs"));
  // In lockstep 0.1 s of model time is over long before 5 s of simulated time.
  StartedProgram late = start_simulate(scenario, "late",
                                       {"--set", "time.duration_s=0.1", "--kill", "storey_1:5", "--outage",
                                        "storey_2:0.05:0.06", "--outage", "storey_2:6:7"});
  ASSERT_THAT(late.wait(), Optional(kExitCompleted)) << late.standard_error();
  EXPECT_THAT(late.standard_error(), AllOf(HasSubstr("--kill storey_1:5 had no effect"), HasSubstr("not model time"),
                                           HasSubstr("--outage storey_2:6:7 had no effect"),
                                           Not(HasSubstr("storey_2:0.05:0.06 had no effect"))));
}

TEST_F(WrongInput, RejectsInvalidCommandLine) {
  EXPECT_THAT(refusal("hybridtest", {}), HasSubstr("subcommand"));
  EXPECT_THAT(refusal("hybridtest", {"run"}), HasSubstr("FILE"));
  EXPECT_THAT(refusal("hybridtest", {"run", shipped_scenario("two_storey_one_site"), "--no-such-option"}),
              HasSubstr("--no-such-option"));
  EXPECT_THAT(refusal("hybridtest", {"simulate", shipped_scenario("two_storey_one_site")}), HasSubstr("--seed"));
  EXPECT_THAT(refusal("hybridtest", {"export", directory().string(), "--csv"}), HasSubstr("no run file"));
}

TEST_F(WrongInput, KeepsExistingRunDirectory) {
  const std::filesystem::path scenario = shipped_scenario("two_storey_one_site");
  StartedProgram first = start_simulate(scenario, "run", {"--set", "time.duration_s=0.1"});
  ASSERT_THAT(first.wait(), Optional(kExitCompleted)) << first.standard_error();
  const std::string before = text_of(recorded("run").file("coordinator"));
  StartedProgram second = start_run(scenario, "run", {"--set", "time.duration_s=0.1"});
  ASSERT_THAT(second.wait(), Optional(kExitConfiguration));
  EXPECT_THAT(second.standard_error(), HasSubstr("has already recorded a run in this directory"));
  EXPECT_EQ(text_of(recorded("run").file("coordinator")), before);
}

TEST_F(WrongInput, CheckAcceptsSiteFileAndListsItsErrors) {
  std::ofstream{directory() / "site.yaml"} << "specimen: {type: elastic, stiffness_n_per_m: 1.0e6}\n";
  StartedProgram check = start_hybridtest({"check", "site.yaml"}, "check");
  EXPECT_THAT(check.wait(), Optional(kExitCompleted)) << check.standard_error();
  EXPECT_THAT(check.standard_output(), AllOf(HasSubstr("a valid site file"), HasSubstr("rig: {model: site.yaml}")));
  std::ofstream{directory() / "site.yaml"} << "specimen: {type: elastic, stifness_n_per_m: 1.0e6}\n";
  EXPECT_THAT(
      refusal("hybridtest", {"check", "site.yaml"}),
      AllOf(HasSubstr("did you mean 'stiffness_n_per_m'"), Not(HasSubstr("schema")), Not(HasSubstr("integrator"))));
}

TEST_F(WrongInput, CountsThatDoNotFitAreRefusedByEveryCommand) {
  const std::string laws = "[{type: elastic, stiffness_n_per_m: 4.0e6}, {type: viscous, damping_n_s_per_m: 2.0e4}]";
  const auto two_laws = AllOf(HasSubstr("2 given; expected 1"), HasSubstr("{type: parallel, laws: [...]}"));
  const std::string scenario = shipped_scenario("two_storey_one_site");
  const Arguments set{"--set", "substructures[storey_1].rig.specimen=" + laws};
  EXPECT_THAT(refusal("hybridtest", {"check", scenario, set[0], set[1]}), two_laws);
  EXPECT_THAT(refusal("hybridtest", {"run", scenario, set[0], set[1]}), two_laws);
  EXPECT_THAT(refusal("hybridtest", {"simulate", scenario, "--seed", "1", set[0], set[1]}), two_laws);
  EXPECT_THAT(refusal("hybridtest", {"check", scenario, "--set",
                                     "substructures[storey_1].rig.transfer_system=[{type: ideal}, {type: ideal}]"}),
              HasSubstr("2 given; expected 1"));

  std::ofstream{directory() / "site.yaml"} << "specimen: " << laws << "\n";
  std::ofstream recording{directory() / "test.csv"};
  recording << "time_s,measured_displacement_m,measured_force_n\n";
  for (int i = 0; i < 1000; ++i) recording << 0.001 * i << ',' << 0.01 << ',' << 4.0e4 << '\n';
  recording.close();
  const auto other_count = AllOf(HasSubstr("test.csv has 1 degrees of freedom"), HasSubstr("site.yaml has 2"),
                                 HasSubstr("{type: parallel, laws: [...]}"));
  EXPECT_THAT(
      refusal("hybridtest", {"diagnose", "--model", "site.yaml", "--recording", "test.csv", "--out", "diagnosis"}),
      other_count);
  EXPECT_THAT(
      refusal("hybridtest", {"replay", "--model", "site.yaml", "--recording", "test.csv", "--out", "predicted.csv"}),
      other_count);
}

}  // namespace
}  // namespace hybridtest
