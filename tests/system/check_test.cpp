#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "tests/support/system_fixture.hpp"

/// What `hybridtest check` says line by line, and what `run` and `simulate` do with it.
namespace hybridtest {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Optional;

const std::string kUncompensated = "substructures[storey_1].compensator={type: none}";

class CheckCommand : public SystemTest {
 protected:
  /// Exit code and standard output.
  [[nodiscard]] std::pair<int, std::string> check(const Arguments& more) const {
    Arguments arguments{"check", shipped_scenario("two_storey_one_site")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    StartedProgram program = start_hybridtest(arguments, "check");
    const auto code = program.wait();
    return {code.value_or(-1), program.standard_output()};
  }
};

TEST_F(CheckCommand, PassesShippedScenariosWithTheirPeaks) {
  for (const char* name :
       {"two_storey_one_site", "two_storey_two_sites", "three_storey_base_isolated", "isolated_with_dampers"}) {
    StartedProgram program = start_hybridtest({"check", shipped_scenario(name)}, "check");
    EXPECT_THAT(program.wait(), Optional(kExitCompleted)) << program.standard_error();
    EXPECT_THAT(program.standard_output(),
                AllOf(HasSubstr("critical delay"), ContainsRegex("pass +delay margin"),
                      ContainsRegex("pass +displacement +[0-9.]+ m, [0-9]+ % of the limit"), HasSubstr("\npass: ")));
  }
}

TEST_F(CheckCommand, FailsWithTwoAndSaysWhatToChange) {
  const auto [unstable_code, unstable] = check({"--set", kUncompensated});
  EXPECT_EQ(unstable_code, kExitConfiguration);
  EXPECT_THAT(unstable, AllOf(ContainsRegex("FAIL +delay margin +-[0-9.]+ ms +UNSTABLE"),
                              HasSubstr("-> compensate the delay: compensator {type: polynomial_displacement"),
                              HasSubstr("Do not run this test with a specimen"), Not(HasSubstr("predicted test"))));
  const auto [stiffness_code, stiffness] =
      check({"--quick", "--set", "substructures[storey_1].initial_stiffness_n_per_m=[[2.0]]"});
  EXPECT_EQ(stiffness_code, kExitConfiguration);
  EXPECT_THAT(stiffness, AllOf(HasSubstr("initial_stiffness_n_per_m is [[2]], but the simulated"),
                               Not(HasSubstr("stable at any delay"))));
  const auto [weak_code, weak] = check({"--quick", "--set", "excitation.scale=0.01"});
  EXPECT_EQ(weak_code, kExitCompleted) << "only a caution";
  EXPECT_THAT(weak, AllOf(ContainsRegex("caution +record"), HasSubstr("peak of"), HasSubstr("caution: 1 line")));
}

TEST_F(CheckCommand, PeaksAreJudgedAgainstLimitsAndRating) {
  const auto [code, text] = check({"--set", "substructures[storey_1].rig.rating={force_n: 6.0e4}", "--set",
                                   "substructures[storey_1].limits.displacement_m=0.05"});
  EXPECT_EQ(code, kExitConfiguration);
  EXPECT_THAT(text, AllOf(ContainsRegex("FAIL +end +ended by an interlock"), ContainsRegex("FAIL +displacement"),
                          HasSubstr("of the rig's 6e+04 N"), ContainsRegex("caution +limits")));
}

TEST_F(CheckCommand, RigElsewhereIsReplacedAndSaid) {
  const auto [code, text] =
      check({"--set", "time={mode: paced, step_s: 0.001, duration_s: 2.0}", "--set",
             "substructures[storey_1].rig={type: udp, host: 127.0.0.1, port: 9, transfer_delay_s: 0.0231}"});
  EXPECT_EQ(code, kExitCompleted) << text;
  EXPECT_THAT(text, HasSubstr("by an elastic specimen of the initial stiffness in place of its udp rig"));
}

TEST_F(CheckCommand, WritesTheSameLinesAsJson) {
  const auto [code, text] = check({"--quick", "--json", "check.json", "--set", kUncompensated});
  EXPECT_EQ(code, kExitConfiguration);
  const auto written = nlohmann::json::parse(std::ifstream{directory() / "check.json"});
  EXPECT_EQ(written.at("schema"), "hybridtest_check/1");
  EXPECT_EQ(written.at("verdict"), "fail");
  int fails = 0;
  for (const auto& line : written.at("lines")) {
    EXPECT_THAT(text, HasSubstr(line.at("found").get<std::string>()));
    if (line.at("verdict") == "fail") {
      ++fails;
      EXPECT_FALSE(line.at("change").get<std::string>().empty());
    }
  }
  EXPECT_EQ(fails, 2);
}

TEST_F(CheckCommand, RunRefusesUnstableTestOfRealRig) {
  const Arguments late{"--set",
                       "substructures[storey_1].rig={type: udp, host: 127.0.0.1, port: 9, pace: datagrams, "
                       "connect_timeout_s: 0.2, transfer_delay_s: 0.05}"};
  StartedProgram refused = start_run(shipped_scenario("two_storey_one_site"), "run", late);
  EXPECT_THAT(refused.wait(), Optional(kExitConfiguration));
  EXPECT_THAT(refused.standard_error(), AllOf(HasSubstr("UNSTABLE (storey_1)"), HasSubstr("--even-if-unstable")));
  EXPECT_FALSE(std::filesystem::exists(directory() / "run"));
}

TEST_F(CheckCommand, SimulateWarnsOfUnstableTest) {
  StartedProgram simulated = start_simulate(shipped_scenario("two_storey_one_site"), "run",
                                            {"--set", kUncompensated, "--set", "time.duration_s=0.1"});
  EXPECT_THAT(simulated.wait(), Optional(kExitCompleted)) << simulated.standard_error();
  EXPECT_THAT(simulated.standard_error(), HasSubstr("warning: the coupled test is UNSTABLE (storey_1)"));
}

}  // namespace
}  // namespace hybridtest
