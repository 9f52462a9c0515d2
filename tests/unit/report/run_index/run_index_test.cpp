#include "report/run_index/run_index.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "recording/error.hpp"
#include "tests/unit/recording/example_run.hpp"
#include "tests/unit/recording/temporary_directory.hpp"

namespace hybridtest {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

void write(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream{file} << text;
}

std::string summary(const std::string& test_name, const std::string& start, int exit_code = kExitCompleted) {
  const nlohmann::json json{{"test_name", test_name},
                            {"verdict", exit_code == kExitCompleted ? "completed" : "ended by an interlock"},
                            {"exit_code", exit_code},
                            {"data_valid", true},
                            {"start_time_utc", start},
                            {"peak_displacement",
                             {{{"dof", "floor_1"}, {"displacement_m", 0.01}, {"model_time_s", 2.5}},
                              {{"dof", "floor_2"}, {"displacement_m", -0.025}, {"model_time_s", 3.0}},
                              {{"dof", "floor_3"}, {"displacement_m", nullptr}, {"model_time_s", nullptr}}}}};
  return json.dump();
}

class RunIndex : public testing::Test {
 protected:
  void add(const std::string& name, const std::string& test_name, const std::string& start,
           int exit_code = kExitCompleted) const {
    write(runs_ / name / "summary.json", summary(test_name, start, exit_code));
  }
  [[nodiscard]] std::vector<std::string> found(const RunFilter& filter = {}) const {
    std::vector<std::string> names;
    for (const RunEntry& run : find_runs(runs_.path(), filter)) names.push_back(run.directory.filename());
    return names;
  }

  TemporaryDirectory runs_;
};

TEST_F(RunIndex, ListsRunsAtAnyDepthNewestFirst) {
  add("b", "frame", "2026-11-20T10:00:00Z");
  add("2026/november/c", "frame", "2026-11-22T10:00:00Z");
  add("a", "frame", "2026-11-21T10:00:00Z");
  write(runs_ / "notes" / "text.txt", "no run");
  EXPECT_THAT(found(), ElementsAre("c", "a", "b"));
}

TEST_F(RunIndex, FiltersByScenarioAndByFailure) {
  add("a", "frame", "2026-11-20T10:00:00Z");
  add("b", "tower", "2026-11-21T10:00:00Z", kExitEndedEarly);
  add("c", "tower", "2026-11-22T10:00:00Z");
  EXPECT_THAT(found({.test_name = "tower"}), ElementsAre("c", "b"));
  EXPECT_THAT(found({.only_failed = true}), ElementsAre("b"));
}

TEST_F(RunIndex, TakesVerdictAndPeaksFromTheSummary) {
  add("a", "frame", "2026-11-20T10:00:00Z", kExitEndedEarly);
  const std::vector<RunEntry> runs = find_runs(runs_.path());
  ASSERT_EQ(runs.size(), 1U);
  EXPECT_EQ(runs[0].verdict, "ended by an interlock");
  EXPECT_EQ(runs[0].exit_code, kExitEndedEarly);
  ASSERT_NE(runs[0].largest_peak(), nullptr);
  EXPECT_EQ(runs[0].largest_peak()->dof, "floor_2");
  EXPECT_EQ(runs[0].largest_peak()->value, -0.025);
  EXPECT_THAT(runs_text(runs),
              HasSubstr("2026-11-20 10:00:00  frame  ended by an interlock\n    peak floor_2 -25.00 mm  "));
}

TEST_F(RunIndex, RunWithoutSummaryIsReadFromItsRecordings) {
  std::filesystem::create_directory(runs_ / "killed");
  ExampleRun{}.write(runs_ / "killed");
  const std::vector<RunEntry> runs = find_runs(runs_.path());
  ASSERT_EQ(runs.size(), 1U);
  EXPECT_EQ(runs[0].fault, "");
  EXPECT_EQ(runs[0].verdict, "completed");
  EXPECT_EQ(runs[0].largest_peak()->value, -0.045);
  EXPECT_THAT(runs_text(runs), HasSubstr("(no summary.json: it still runs, or was killed)"));
  EXPECT_FALSE(std::filesystem::exists(runs_ / "killed" / "summary.json"));
}

TEST_F(RunIndex, BrokenRunIsALineWithItsReason) {
  add("good", "frame", "2026-11-20T10:00:00Z");
  write(runs_ / "half" / "summary.json", "{\"test_name\": \"fr");
  write(runs_ / "other" / "coordinator.h5", "no HDF5");
  const std::vector<RunEntry> runs = find_runs(runs_.path());
  ASSERT_EQ(runs.size(), 3U);
  EXPECT_EQ(std::ranges::count_if(runs, [](const RunEntry& run) { return !run.fault.empty(); }), 2);
  EXPECT_THAT(found({.only_failed = true}), testing::UnorderedElementsAre("half", "other"));
  EXPECT_THAT(runs_text(runs), HasSubstr("cannot be read: "));
  const nlohmann::json json = nlohmann::json::parse(runs_json(runs));
  for (const nlohmann::json& run : json.at("runs")) EXPECT_EQ(run.at("scenario").is_null(), !run.at("fault").is_null());
}

TEST_F(RunIndex, DiagnosisOfEachSiteIsNamedAndLinked) {
  add("a", "frame", "2026-11-20T10:00:00Z");
  write(runs_ / "a" / "diagnosis" / "storey_1" / "diagnosis.json",
        R"({"verdict": "named", "causes": [{"effect": "backlash"}]})");
  write(runs_ / "a" / "diagnosis" / "storey_1" / "diagnosis.html", "");
  write(runs_ / "a" / "diagnosis" / "storey_2" / "diagnosis.json", R"({"verdict": "none", "causes": []})");
  const std::vector<RunEntry> runs = find_runs(runs_.path());
  ASSERT_EQ(runs.size(), 1U);
  EXPECT_THAT(runs[0].diagnoses, ElementsAre("storey_1: named (backlash)", "storey_2: none"));
  EXPECT_THAT(runs_page(runs, runs_.path()), HasSubstr("href=\"./a/diagnosis/storey_1/diagnosis.html\""));
}

TEST_F(RunIndex, PageLinksReportsAndEscapesNames) {
  add("1: 100% <b>", "frame <i>", "2026-11-20T10:00:00Z");
  write(runs_ / "1: 100% <b>" / "report.html", "");
  add("plain", "frame", "2026-11-19T10:00:00Z");
  const std::string page = runs_page(find_runs(runs_.path()), runs_.path());
  EXPECT_THAT(page, HasSubstr("href=\"./1%3A%20100%25%20%3Cb%3E/report.html\""));
  EXPECT_THAT(page, HasSubstr("frame &lt;i&gt;"));
  EXPECT_THAT(page, Not(HasSubstr("plain/report.html")));
  EXPECT_THAT(page, HasSubstr("2 runs, newest first; 0 did not"));
}

TEST_F(RunIndex, EmptyFolderHasNoRunsAndMissingOneIsAnError) {
  EXPECT_THAT(found(), IsEmpty());
  EXPECT_THROW(static_cast<void>(find_runs(runs_ / "missing")), RecordingError);
}

}  // namespace
}  // namespace hybridtest
