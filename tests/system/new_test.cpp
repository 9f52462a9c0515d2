#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "tests/support/system_fixture.hpp"

/// `hybridtest new` makes folders that run, from the build folder as from where the programs are installed.
namespace hybridtest {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Optional;

class New : public SystemTest {
 protected:
  /// What the program prints when it makes the folder, or why it does not.
  [[nodiscard]] std::string made(Arguments arguments, int exit_code = kExitCompleted) const {
    arguments.insert(arguments.begin(), "new");
    StartedProgram started = start_hybridtest(arguments, "new");
    EXPECT_THAT(started.wait(), Optional(exit_code)) << started.standard_error();
    return exit_code == kExitCompleted ? started.standard_output() : started.standard_error();
  }
  [[nodiscard]] std::string scenario_of(const std::string& folder) const {
    return text_of(directory() / folder / "scenario.yaml");
  }
  void expect_runs(const std::string& folder) const {
    StartedProgram simulate = start_hybridtest({"simulate", folder + "/scenario.yaml", "--seed", "1", "--set",
                                                "time.duration_s=0.1", "--out", folder + ".run"},
                                               "simulate");
    EXPECT_THAT(simulate.wait(), Optional(kExitCompleted)) << simulate.standard_error();
  }
};

TEST_F(New, FolderOfEveryShippedScenarioRuns) {
  std::vector<std::string> names{"two_storey_one_site", "two_storey_two_sites", "three_storey_base_isolated",
                                 "isolated_with_dampers"};
  for (const auto& entry :
       std::filesystem::directory_iterator{shipped_scenario("two_storey_one_site").parent_path() / "founding_study"}) {
    names.push_back("founding_study/" + entry.path().stem().string());
  }
  ASSERT_GT(names.size(), 3U);
  for (const std::string& name : names) {
    const std::string folder = "of_" + std::filesystem::path{name}.filename().string();
    EXPECT_THAT(made({folder, "--from", name}), HasSubstr("hybridtest run " + folder + "/scenario.yaml"));
    EXPECT_THAT(scenario_of(folder), AllOf(HasSubstr("\nname: " + folder + "\n"), HasSubstr("# ")));
    expect_runs(folder);
  }
}

TEST_F(New, ScenarioThatOpenSeesLeadsIsCopiedByHand) {
  EXPECT_THAT(made({"mine", "--from", "opensees/shear_frame"}, kExitConfiguration),
              AllOf(HasSubstr("copy its folder"), HasSubstr("scenarios/opensees")));
  EXPECT_FALSE(std::filesystem::exists(directory() / "mine"));
}

TEST_F(New, TakesTheMotionOfTheUser) {
  std::ofstream{directory() / "my $1 motion.txt"} << "0 0\n0.5 0.2\n1.0 0\n";
  EXPECT_THAT(made({"mine", "--motion", "my $1 motion.txt"}, kExitConfiguration), HasSubstr("unit"));
  EXPECT_FALSE(std::filesystem::exists(directory() / "mine"));
  EXPECT_THAT(made({"mine", "--motion", "my $1 motion.txt", "--unit", "g"}),
              HasSubstr("1 s; the test lasts 31 s (time.duration_s)"));
  EXPECT_THAT(scenario_of("mine"),
              HasSubstr("\nexcitation: {ground_motion: \"ground_motions/my $1 motion.txt\", scale: 1.0, unit: g}\n"));
  // The folder does not need the original.
  std::filesystem::remove(directory() / "my $1 motion.txt");
  expect_runs("mine");
}

TEST_F(New, ListsShippedScenariosAndKeepsWhatIsThere) {
  EXPECT_THAT(made({"mine", "--from", "two_storey_onesite"}, kExitConfiguration),
              AllOf(HasSubstr("did you mean 'two_storey_one_site'?"), HasSubstr("founding_study/exact"),
                    Not(HasSubstr("mr_damper_0a"))));
  EXPECT_THAT(made({"my test"}, kExitConfiguration), HasSubstr("does not serve as the name of a test"));
  std::filesystem::create_directory(directory() / "there");
  EXPECT_THAT(made({"there"}, kExitConfiguration), HasSubstr("already exists"));
  EXPECT_TRUE(std::filesystem::is_empty(directory() / "there"));
}

TEST_F(New, FindsScenariosWhereTheProgramIsInstalled) {
  const std::filesystem::path prefix = directory() / "prefix";
  const std::filesystem::path installed = prefix / "share" / "hybridtest" / "scenarios";
  std::filesystem::create_directories(prefix / "bin");
  std::filesystem::copy_file(program("hybridtest"), prefix / "bin" / "hybridtest");
  const auto make = [&] {
    return StartedProgram{prefix / "bin" / "hybridtest", {"new", "mine"}, directory() / "new", {directory()}};
  };
  StartedProgram without = make();
  EXPECT_THAT(without.wait(), Optional(kExitConfiguration));
  EXPECT_THAT(without.standard_error(), HasSubstr(installed.string() + ": the scenarios that ship with this program"));
  std::filesystem::create_directories(installed.parent_path());
  std::filesystem::copy(shipped_scenario("two_storey_one_site").parent_path(), installed,
                        std::filesystem::copy_options::recursive);
  StartedProgram with = make();
  EXPECT_THAT(with.wait(), Optional(kExitCompleted)) << with.standard_error();
  expect_runs("mine");
}

}  // namespace
}  // namespace hybridtest
