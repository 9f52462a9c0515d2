#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include "core/config_error.hpp"
#include "diagnosis/runs/run_records.hpp"
#include "diagnosis/tuning.hpp"
#include "recording/csv_export.hpp"
#include "recording/error.hpp"
#include "recording/run_file_reader.hpp"
#include "recording/run_file_writer.hpp"
#include "scenario/scenario_digest.hpp"
#include "tests/simulation/kept_simulation.hpp"
#include "tests/simulation/recorded_simulation.hpp"
#include "tests/unit/recording/temporary_directory.hpp"

/// A run directory as a recording for the diagnosis.
namespace hybridtest {
namespace {

constexpr std::size_t kRingRows = std::size_t{1} << 14U;

/// As many as the recording has.
std::vector<double> first(const Recording& recording, std::vector<double> values) {
  values.resize(recording.samples);
  return values;
}

class RunRecording : public testing::Test {
 protected:
  void simulate(std::string_view scenario_name, std::vector<std::string> overrides) {
    overrides.emplace_back("time.duration_s=4");
    const Scenario scenario = shipped_scenario(scenario_name, overrides);
    prepare_run_directory(directory_.path(), scenario);
    RecordedSimulation simulation{scenario, directory_.path(), kRingRows};
    SimulationSettings settings;
    settings.seed = 1;
    ASSERT_EQ(simulation.run(settings), StopReason::completed);
    ASSERT_EQ(simulation.dropped(), 0U);
  }

  TemporaryDirectory directory_;
};

TEST_F(RunRecording, HoldsControlTableAndSentCommands) {
  simulate("two_storey_one_site", {});
  const Recording recording = read_recording(directory_.path(), RecordingRole::held_out);
  const RunFileReader site{run_file(directory_.path(), "storey_1")};
  EXPECT_EQ(recording.role, RecordingRole::held_out);
  EXPECT_EQ(recording.file, directory_.path().string());
  ASSERT_EQ(recording.dofs.size(), 1U);
  const DofRecording& dof = recording.dofs[0];
  EXPECT_EQ(dof.of(Channel::command_displacement), first(recording, site.column("control", "command_displacement_m")));
  EXPECT_EQ(dof.of(Channel::measured_force), first(recording, site.column("control", "measured_force_n")));
  EXPECT_LT(recording.samples, site.row_count("control")) << "the site has returned to rest";
  EXPECT_NEAR(site.column("control", "model_time_s")[recording.samples - 1], 4.0, 1e-9);
  EXPECT_DOUBLE_EQ(recording.sample_period_s, 0.0005) << "1024 Hz, rounded up to whole periods of a step of 1 ms";

  std::ifstream file{run_file(directory_.path(), "storey_1"), std::ios::binary};
  const std::string bytes{std::istreambuf_iterator<char>{file}, std::istreambuf_iterator<char>{}};
  EXPECT_EQ(recording.sha256, hex(sha256(bytes)));

  // Without network faults the commands that arrived are those that were sent.
  const std::vector<double>& sent = dof.of(Channel::sent_displacement);
  const std::vector<double>& target = dof.of(Channel::target_displacement);
  const double peak_m = std::abs(*std::ranges::max_element(sent, {}, [](double value) { return std::abs(value); }));
  ASSERT_GT(peak_m, 1e-3);
  const std::vector<double> model_time_s = site.column("control", "model_time_s");
  double worst_m = 0.0;
  std::size_t compared = 0;
  for (std::size_t i = 0; i < sent.size(); ++i) {
    if (model_time_s[i] <= 0.0 || model_time_s[i] > 3.9) continue;
    worst_m = std::max(worst_m, std::abs(sent[i] - target[i]));
    ++compared;
  }
  EXPECT_GT(compared, 3000U);
  // Between two steps the site goes on from the velocity it has, the cubic here from the coordinator's.
  EXPECT_LT(worst_m, 1e-6 * peak_m);
}

TEST_F(RunRecording, ExportedControlTableIsTheSameRecording) {
  simulate("two_storey_one_site", {});
  const Recording from_run = read_recording(directory_.path(), RecordingRole::fit);
  export_csv(directory_.path(), directory_ / "csv");
  const Recording from_csv = read_recording(directory_ / "csv" / "storey_1.control.csv", RecordingRole::fit);
  EXPECT_DOUBLE_EQ(from_csv.sample_period_s, from_run.sample_period_s);
  for (const Channel channel :
       {Channel::target_displacement, Channel::measured_displacement, Channel::measured_force}) {
    EXPECT_EQ(first(from_run, from_csv.dofs[0].of(channel)), from_run.dofs[0].of(channel)) << column_name(channel);
  }
  EXPECT_FALSE(from_csv.dofs[0].has(Channel::sent_displacement)) << "the coordinator's file knows that, not the site's";
}

TEST_F(RunRecording, RequiresSiteNameForSeveralSites) {
  simulate("two_storey_two_sites", {});
  EXPECT_THAT([&] { (void)read_recording(directory_.path(), RecordingRole::fit); },
              testing::ThrowsMessage<ConfigError>(testing::HasSubstr("first_storey_columns, second_storey_columns")));
  EXPECT_THAT([&] { (void)read_recording(directory_.path(), RecordingRole::fit, "storey_9"); },
              testing::ThrowsMessage<ConfigError>(testing::HasSubstr("storey_9: no such site")));
  const Recording second = read_recording(directory_.path(), RecordingRole::fit, "second_storey_columns");
  const RunFileReader site{run_file(directory_.path(), "second_storey_columns")};
  EXPECT_EQ(second.dofs[0].of(Channel::measured_force), first(second, site.column("control", "measured_force_n")));
}

TEST_F(RunRecording, LongerThanFitsIntoMemoryIsRefused) {
  simulate("two_storey_one_site", {});
  const std::filesystem::path site = run_file(directory_.path(), "storey_1");
  const RunFileHeader header = RunFileReader{site}.header();
  {
    RunFileWriter writer{site, header, {{"control", {{"time_s", "s"}, {"measured_force_n", "N"}}}}};
    const std::vector<double> rows(2 * (tuning::kSamplesMax + 1), 0.0);
    writer.append(0, rows);
    writer.close();
  }
  EXPECT_THAT([&] { (void)read_recording(directory_.path(), RecordingRole::fit); },
              testing::ThrowsMessage<ConfigError>(
                  testing::AllOf(testing::HasSubstr("the table control has 2097153 rows; expected at most 2097152"),
                                 testing::HasSubstr("csv/storey_1.control.csv"))));
}

TEST_F(RunRecording, StructureOfIteratedRunIsNotRecomputed) {
  const std::filesystem::path source{HYBRIDTEST_SOURCE_DIR};
  const Scenario scenario = read_scenario(
      source / "tests/system/scenarios/two_storey_iterated.yaml",
      {"excitation.ground_motion=" + (source / "launch/scenarios/ground_motions/design_ec8_c.AT2").string()});
  prepare_run_directory(directory_.path(), scenario);
  EXPECT_THAT([&] { static_cast<void>(structure_record(directory_.path(), scenario)); },
              testing::ThrowsMessage<RecordingError>(testing::HasSubstr("tries several displacements in a step")));
}

TEST(ReadRecording, LongerCsvThanFitsIntoMemoryIsRefused) {
  std::string text = "time_s,measured_force_n\n";
  for (std::size_t row = 0; row <= tuning::kSamplesMax; ++row) text += "0,1\n";
  const Intake intake = read_csv_recording(text, "a.csv");
  EXPECT_FALSE(intake.recording.has_value());
  ASSERT_EQ(intake.findings.size(), 1U);
  EXPECT_THAT(intake.findings[0].what, testing::HasSubstr("expected at most 2097152"));
}

TEST(ReadRecording, FindingsAndMissingFileAreConfigErrors) {
  const TemporaryDirectory directory;
  std::ofstream{directory / "a.csv"} << "time_s,measured_force_n\n0,1\n0.1,nan\n0.2,3\n";
  try {
    (void)read_recording(directory / "a.csv", RecordingRole::fit);
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    ASSERT_EQ(error.issues().size(), 1U);
    EXPECT_EQ(error.issues()[0].text(), (directory / "a.csv").string() +
                                            ":3: column 'measured_force_n': 'nan': not a finite number; expected a "
                                            "number, replace or remove this part of the recording");
  }
  EXPECT_THROW((void)read_recording(directory / "b.csv", RecordingRole::fit), ConfigError);
}

}  // namespace
}  // namespace hybridtest
