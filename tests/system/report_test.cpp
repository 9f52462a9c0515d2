#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <fstream>
#include <string>

#include "tests/support/figure_values.hpp"
#include "tests/support/recording_checks.hpp"
#include "tests/support/system_fixture.hpp"

/// Every run has a report that says what its recording says.
namespace hybridtest {
namespace {

using ::testing::HasSubstr;
using ::testing::Optional;

class Report : public SystemTest {
 protected:
  [[nodiscard]] StartedProgram simulate(const std::string& run, const Arguments& more = {}) const {
    return start_simulate(shipped_scenario("two_storey_one_site"), run, more);
  }
  [[nodiscard]] std::string page(const std::string& run) const { return text_of(directory() / run / "report.html"); }
};

const Arguments kShort{"--set", "time.duration_s=4"};

double largest_of(const std::vector<double>& values) {
  double most = 0.0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

TEST_F(Report, OfASimulationShowsWhatItRecorded) {
  StartedProgram program = simulate("run", kShort);
  ASSERT_THAT(program.wait(), Optional(kExitCompleted)) << program.standard_error();
  EXPECT_THAT(program.standard_error(), HasSubstr("report.html"));
  const std::string html = page("run");
  const RecordedRun run = recorded("run");
  const auto expect_peak = [&](const std::string& panel, const std::string& curve, const std::vector<double>& values,
                               double factor, const std::string& section) {
    const std::size_t from = html.find("<section id=\"" + section + "\"");
    ASSERT_NE(from, std::string::npos) << section;
    const double peak = factor * largest_of(values);
    EXPECT_NEAR(largest_of(shown_curve(html, panel, curve, from).y), peak, 1e-3 * peak) << panel << " " << curve;
  };
  expect_peak("displacement relative to the ground", "floor_2",
              run.column("coordinator", "steps", "displacement_floor_2_m"), 1e3, "structure");
  expect_peak("ground acceleration", "ground motion",
              run.column("coordinator", "steps", "ground_acceleration_m_per_s2"), 1.0, "structure");
  expect_peak("force", "measured", run.column("storey_1", "steps", "measured_force_n"), 1e-3, "substructure_storey_1");
  for (const char* part : {"energy relative to the ground", "synchronisation subspace", "equivalent delay",
                           "pseudo-acceleration", "round trip of the exchanges", "share of each limit"}) {
    EXPECT_THAT(html, HasSubstr("data-title=\"" + std::string{part}));
  }
  EXPECT_THAT(html, HasSubstr(run.summary()["scenario_digest"].get<std::string>()));
}

TEST_F(Report, SaysWhatDiffersFromTheShippedScenario) {
  StartedProgram program =
      start_hybridtest({"simulate", shipped_scenario("two_storey_one_site").string(), "--seed", "1", "--out",
                        (directory() / "run").string(), "--set", "time.duration_s=0.5"},
                       "simulate");
  ASSERT_THAT(program.wait(), Optional(kExitCompleted)) << program.standard_error();
  EXPECT_THAT(page("run"), HasSubstr("It differs from the shipped scenario of this name"));
  EXPECT_THAT(page("run"), HasSubstr("<del>time &gt; duration_s: 31</del>"));
  EXPECT_THAT(page("run"), HasSubstr("<ins>time &gt; duration_s: 0.5</ins>"));
}

TEST_F(Report, IsLeftOutWhenAskedAndWrittenLater) {
  Arguments arguments = kShort;
  arguments.emplace_back("--no-report");
  StartedProgram program = simulate("run", arguments);
  ASSERT_THAT(program.wait(), Optional(kExitCompleted)) << program.standard_error();
  EXPECT_FALSE(std::filesystem::exists(directory() / "run/report.html"));
  StartedProgram report = start_hybridtest({"report", (directory() / "run").string()}, "report");
  ASSERT_THAT(report.wait(), Optional(kExitCompleted)) << report.standard_error();
  EXPECT_THAT(page("run"), HasSubstr("✓ Completed"));
}

TEST_F(Report, OfAnInterlockedTestNamesTheLimit) {
  StartedProgram program = simulate("run", {"--set", "substructures[storey_1].limits.displacement_m=0.03"});
  ASSERT_THAT(program.wait(), Optional(kExitEndedEarly)) << program.standard_error();
  const std::string html = page("run");
  EXPECT_THAT(html, HasSubstr("✗ Ended by an interlock (storey_1"));
  EXPECT_THAT(html, HasSubstr("✗ reached"));
  const std::size_t from = html.find("<section id=\"substructure_storey_1\"");
  EXPECT_GT(largest_of(shown_curve(html, "share of each limit", "displacement", from).y), 99.0);
  EXPECT_LT(largest_of(shown_curve(html, "share of each limit", "force", from).y), 50.0) << "control";
}

TEST_F(Report, OfAnotherCompensatorIsComparedInFigures) {
  const Arguments plain{"--set", "time.duration_s=4", "--set", "substructures[storey_1].compensator={type: none}"};
  StartedProgram with = simulate("with", kShort);
  ASSERT_THAT(with.wait(), Optional(kExitCompleted)) << with.standard_error();
  StartedProgram without = simulate("without", plain);
  ASSERT_TRUE(without.wait().has_value()) << without.standard_error();
  StartedProgram report =
      start_hybridtest({"report", (directory() / "with").string(), "--compare", (directory() / "without").string(),
                        "--out", (directory() / "both.html").string()},
                       "report");
  ASSERT_THAT(report.wait(), Optional(kExitCompleted)) << report.standard_error();
  const std::string html = text_of(directory() / "both.html");
  EXPECT_THAT(html, HasSubstr("storey_1: substructures &gt; compensator &gt; type: none"));
  EXPECT_THAT(html, HasSubstr("<td>displacement floor_1</td>"));
  EXPECT_FALSE(shown_curve(html, "displacement of floor_1", "without").x.empty());
  EXPECT_FALSE(shown_curve(html, "force over displacement", "measured, without").x.empty());
}

TEST_F(Report, OfAKilledSiteSaysSo) {
  StartedProgram program = start_run(shipped_scenario("two_storey_one_site"), "run", {"--set", "time.duration_s=600"});
  ASSERT_TRUE(has_recorded("run", "coordinator", 1000.0)) << program.standard_error();
  ASSERT_TRUE(send_signal(participant_of(program, "storey_1"), SIGKILL));
  ASSERT_THAT(program.wait(), Optional(kExitEndedEarly)) << program.standard_error();
  const std::string html = page("run");
  EXPECT_THAT(html, HasSubstr("✗ Ended: a participant was lost (storey_1"));
  EXPECT_THAT(html, HasSubstr("killed by signal 9"));
  EXPECT_THAT(html, HasSubstr("The data are invalid: "));
  EXPECT_THAT(html, HasSubstr("✗ not closed: its process was killed"));
  EXPECT_FALSE(shown_curve(html, "displacement", "measured").x.empty());
}

TEST_F(Report, ThatCannotBeWrittenDoesNotChangeTheEnd) {
  std::filesystem::create_directories(directory() / "run/report.html");  // stands where the page would be
  StartedProgram program = simulate("run", {"--set", "time.duration_s=0.5"});
  EXPECT_THAT(program.wait(), Optional(kExitCompleted)) << program.standard_error();
  EXPECT_THAT(program.standard_error(), HasSubstr("report.html was not written: "));
  EXPECT_EQ(recorded("run").summary()["exit_code"], kExitCompleted);
}

TEST_F(Report, OfADiagnosisShowsItsPrediction) {
  StartedProgram program = simulate("run", {"--set", "time.duration_s=6", "--diagnose"});
  ASSERT_THAT(program.wait(), Optional(kExitCompleted)) << program.standard_error();
  StartedProgram report = start_hybridtest(
      {"report", (directory() / "run").string(), "--compare", (directory() / "run/diagnosis").string()}, "report");
  ASSERT_THAT(report.wait(), Optional(kExitCompleted)) << report.standard_error();
  const std::string html = page("run");
  EXPECT_THAT(html, HasSubstr("model as given, there measured"));
  EXPECT_THAT(html, HasSubstr("data-name=\"model as given\""));
}

TEST_F(Report, RefusesWhatCannotBeCompared) {
  StartedProgram program = simulate("run", {"--set", "time.duration_s=0.5"});
  ASSERT_THAT(program.wait(), Optional(kExitCompleted)) << program.standard_error();
  std::ofstream{directory() / "other.csv"} << "time_s,displacement_roof_m\n0,1\n1,2\n";
  StartedProgram report = start_hybridtest(
      {"report", (directory() / "run").string(), "--compare", (directory() / "other.csv").string()}, "report");
  ASSERT_THAT(report.wait(), Optional(kExitConfiguration)) << report.standard_error();
  EXPECT_THAT(report.standard_error(), HasSubstr("has no displacement or force"));
}

}  // namespace
}  // namespace hybridtest
