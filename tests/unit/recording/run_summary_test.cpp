#include "recording/summary/run_summary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/rig_fault.hpp"
#include "recording/error.hpp"
#include "recording/run_file_reader.hpp"
#include "tests/unit/recording/example_run.hpp"
#include "tests/unit/recording/forked_child.hpp"
#include "tests/unit/recording/temporary_directory.hpp"

namespace hybridtest {
namespace {

using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

RunSummary summary_of(const ExampleRun& run) {
  const TemporaryDirectory directory;
  run.write(directory.path());
  return summarise(directory.path());
}

std::string printed(const RunSummary& summary) {
  std::ostringstream stream;
  print_summary(summary, stream);
  return stream.str();
}

TEST(RunSummary, CompletedTestHasEveryFigure) {
  const RunSummary summary = summary_of({});
  EXPECT_EQ(verdict(summary), "completed");
  EXPECT_EQ(summary.exit_code, kExitCompleted);
  EXPECT_TRUE(summary.data_valid);
  EXPECT_THAT(summary.data_faults, IsEmpty());
  EXPECT_EQ(summary.completed_steps, 10'000);
  EXPECT_EQ(summary.planned_steps, 10'000);
  EXPECT_EQ(summary.wall_time_s, 4.0);
  EXPECT_EQ(summary.steps_per_second, 2500.0);
  EXPECT_DOUBLE_EQ(summary.model_time_s, 10.0);

  ASSERT_EQ(summary.peak_displacement_m.size(), 2U);
  EXPECT_EQ(summary.peak_displacement_m[0].dof, "floor_1");
  EXPECT_EQ(summary.peak_displacement_m[0].value, 0.03);
  EXPECT_DOUBLE_EQ(summary.peak_displacement_m[0].model_time_s, 1.0);
  EXPECT_EQ(summary.peak_displacement_m[1].value, -0.045);

  ASSERT_EQ(summary.substructures.size(), 2U);
  const SubstructureSummary& site = summary.substructures[0];
  const SubstructureSummary& numerical = summary.substructures[1];
  EXPECT_EQ(site.id, "storey_1");
  ASSERT_EQ(site.peak_force_n.size(), 1U);
  EXPECT_EQ(site.peak_force_n[0].dof, "floor_1");
  EXPECT_EQ(site.peak_force_n[0].value, -41'000.0);
  EXPECT_EQ(site.energy_error->peak_j, -12.5);
  EXPECT_EQ(site.energy_error->final_j, 0.25);
  ASSERT_EQ(site.tracking.size(), 1U);
  EXPECT_NEAR(site.tracking[0].equivalent_delay_s.value(), ExampleRun::kDelay_s, 5e-7);
  EXPECT_EQ(site.tracking[0].samples, 10'000U) << "of the control table, not of the steps";
  EXPECT_EQ(numerical.id, "storey_2");
  ASSERT_EQ(numerical.peak_force_n.size(), 1U);
  EXPECT_EQ(numerical.peak_force_n[0].dof, "floor_2");
  EXPECT_EQ(numerical.peak_force_n[0].value, 7000.0);
  EXPECT_THAT(numerical.tracking, IsEmpty());
  EXPECT_FALSE(numerical.energy_error.has_value());
}

TEST(RunSummary, CountsExchangesPerSubstructure) {
  ExampleRun run;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  run.extra_exchanges = {{5000.0, 0.0, nan, 4.0, 0.0, nan}, {10'001.0, 0.0, nan, 1.0, 0.0, nan}};
  const RunSummary summary = summary_of(run);
  const ExchangeSummary& site = summary.substructures[0].exchange.value();
  // 1 to 100 us a hundred times over, and once more 1 us.
  EXPECT_EQ(site.round_trip_us->p50, 50.0);
  EXPECT_EQ(site.round_trip_us->p99, 99.0);
  EXPECT_EQ(site.round_trip_us->max, 100.0);
  EXPECT_EQ(site.turnaround_us->p50, 0.5);
  EXPECT_EQ(site.answered, 10'001U);
  EXPECT_EQ(site.resent, 2U + 3U);
  EXPECT_EQ(site.bridged, 1U);
  EXPECT_EQ(site.lost, 1U);
  EXPECT_EQ(site.late, 1U);
  EXPECT_EQ(site.held, 1U);
  EXPECT_EQ(site.extrapolated, 0U);
  const ExchangeSummary& numerical = summary.substructures[1].exchange.value();
  EXPECT_EQ(numerical.round_trip_us->max, 10.0);
  EXPECT_EQ(numerical.resent + numerical.late + numerical.held + numerical.lost, 0U);
}

TEST(RunSummary, DroppedRecordsMakeDataInvalid) {
  ExampleRun run;
  run.site_dropped = 12;
  const RunSummary summary = summary_of(run);
  EXPECT_EQ(verdict(summary), "completed; data invalid");
  EXPECT_EQ(summary.exit_code, kExitDataInvalid);
  EXPECT_THAT(summary.data_faults, ElementsAre("storey_1: 12 records dropped"));
  EXPECT_EQ(summary.participants[1].dropped_rows, 12U);
}

TEST(RunSummary, MissingStepsMakeDataInvalid) {
  ExampleRun run;
  run.site_skips_steps_100_to_102 = true;
  const RunSummary summary = summary_of(run);
  EXPECT_EQ(summary.exit_code, kExitDataInvalid);
  EXPECT_THAT(summary.data_faults, ElementsAre("storey_1: 3 steps missing between recorded steps"));
}

TEST(RunSummary, ShortRecordMakesDataInvalid) {
  ExampleRun run;
  run.site_steps = ExampleRun::kSteps - 1;
  EXPECT_TRUE(summary_of(run).data_valid) << "the very last answer may be under way";
  run.site_steps = ExampleRun::kSteps - 2;
  EXPECT_THAT(summary_of(run).data_faults, ElementsAre("storey_1: the record ends 2 steps before the end of the test"));
}

TEST(RunSummary, InterlockIsListedOnceWithLimitAndExitCode) {
  ExampleRun run;
  run.stop_reason = StopReason::interlock;
  run.exit_code = kExitEndedEarly;
  run.site_dropped = 1;
  run.site_events = {example_event()};
  run.coordinator_events = {example_event()};
  const RunSummary summary = summary_of(run);
  EXPECT_EQ(summary.exit_code, kExitEndedEarly);
  EXPECT_EQ(verdict(summary), "ended by an interlock (storey_1, at 4.711 s); data invalid");
  ASSERT_EQ(summary.interlocks.size(), 1U);
  EXPECT_EQ(summary.interlocks[0].participant, "storey_1");
  EXPECT_EQ(summary.interlocks[0].limit_name, "displacement_limit");
  EXPECT_EQ(summary.interlocks[0].observed, 0.1234);
  EXPECT_EQ(summary.interlocks[0].limit, 0.12);
  EXPECT_EQ(summary.interlocks[0].step, 4711);
  EXPECT_THAT(printed(summary), HasSubstr("storey_1: displacement_limit, observed 123.400 mm, limit 120.000 mm, at "
                                          "step 4711 (4.711 s)"));
}

TEST(RunSummary, RigFaultHasAReasonInPlaceOfValues) {
  ExampleRun run;
  Event fault = example_event();
  fault.subject = "rig_fault";
  fault.values = {static_cast<double>(RigFault::no_answer), 0.0};
  run.coordinator_events = {fault};
  const RunSummary summary = summary_of(run);
  ASSERT_EQ(summary.interlocks.size(), 1U);
  EXPECT_TRUE(std::isnan(summary.interlocks[0].observed));
  EXPECT_THAT(printed(summary), HasSubstr("storey_1: rig_fault: the controller has not answered"));
}

TEST(RunSummary, RefusedRealTimeIsARemark) {
  ExampleRun run;
  Event refused = example_event();
  refused.code = EventCode::real_time_refused;
  refused.severity = Severity::warning;
  run.coordinator_events = {refused, refused};
  const std::vector<std::string> remarks = summary_of(run).remarks;
  EXPECT_EQ(std::ranges::count(remarks, "storey_1: it happened"), 1);
}

TEST(RunSummary, WritesHugeNumbersShort) {
  ExampleRun run;
  Event fault = example_event();
  fault.values = {1e300, 0.12};
  run.coordinator_events = {fault};
  EXPECT_THAT(printed(summary_of(run)), HasSubstr("displacement_limit, observed 1.00e+303 mm, limit 120.000 mm"));
}

TEST(RunSummary, ListsFaultsWithoutInformationEvents) {
  ExampleRun run;
  Event lost = example_event();
  lost.code = EventCode::participant_lost;
  lost.source = "coordinator";
  Event started = lost;
  started.code = EventCode::test_started;
  started.severity = Severity::information;
  run.coordinator_events = {lost, started};
  EXPECT_THAT(summary_of(run).faults, ElementsAre("coordinator: it happened"));
}

TEST(RunSummary, SiteAtRestHasNoDelay) {
  ExampleRun run;
  run.site_at_rest = true;
  const RunSummary summary = summary_of(run);
  ASSERT_EQ(summary.substructures[0].tracking.size(), 1U);
  EXPECT_EQ(summary.substructures[0].tracking[0].rms_m, 0.0);
  EXPECT_FALSE(summary.substructures[0].tracking[0].rms_relative.has_value());
  EXPECT_FALSE(summary.substructures[0].tracking[0].equivalent_delay_s.has_value());
}

TEST(RunSummary, FiguresLeaveOutWaitAndReturnOfTheSite) {
  const SubstructureSummary plain = summary_of({}).substructures[0];
  ExampleRun run;
  run.site_waits = 700;
  run.site_returns = 2000;
  const SubstructureSummary site = summary_of(run).substructures[0];
  ASSERT_EQ(site.tracking.size(), 1U);
  EXPECT_EQ(site.tracking[0].samples, 10'001U) << "from the start to the end of the last step, both included";
  EXPECT_LT(site.tracking[0].peak_m, 0.004) << "5 mm is the error of the return";
  EXPECT_EQ(site.tracking[0].peak_m, plain.tracking[0].peak_m);
  EXPECT_NEAR(site.tracking[0].rms_m, plain.tracking[0].rms_m, 1e-4 * plain.tracking[0].rms_m);
  EXPECT_EQ(site.peak_force_n.at(0).value, -41'000.0);
  EXPECT_EQ(site.energy_error->peak_j, -12.5);
  EXPECT_EQ(site.energy_error->final_j, 0.25);
}

TEST(RunSummary, RemarksOnTrackingErrorAboveATenth) {
  ExampleRun run;
  run.site_at_rest = true;
  EXPECT_THAT(summary_of(run).remarks, IsEmpty());
  run.site_at_rest = false;
  // Behind by 12.5 ms at 2 Hz: 2 sin(pi f tau) = 15.7 %.
  EXPECT_THAT(summary_of(run).remarks,
              ElementsAre(HasSubstr("storey_1 floor_1: tracking error of 16 % of the targets")));
  run.site_error = -1.0;  // measured minus target: one amplitude and more
  EXPECT_THAT(summary_of(run).remarks, ElementsAre(HasSubstr("tracking error of 102 %")));
}

TEST(RunSummary, TellsGroundMotionAndWarnsOfImplausiblePeak) {
  ExampleRun run;
  run.site_at_rest = true;
  const RunSummary plausible = summary_of(run);
  EXPECT_THAT(plausible.remarks, IsEmpty());
  EXPECT_THAT(printed(plausible), HasSubstr("ground motion: peak 0.3569 g (3.5 m/s2), 6201 points, 31 s\n"
                                            "    spectrum (5 %) at the periods of the structure: 0.750 s: 0.785 g, "
                                            "110.0 mm\n"));
  run.ground_peak_m_per_s2 = 0.09;
  EXPECT_THAT(summary_of(run).remarks, ElementsAre(HasSubstr("a peak of 0.009177 g, expected 0.01 to 3 g")));
  run.ground_peak_m_per_s2 = 34.0;
  EXPECT_THAT(summary_of(run).remarks, ElementsAre(HasSubstr("excitation.unit")));
  std::ostringstream stream;
  write_summary_json(summary_of(run), stream);
  const nlohmann::json motion = nlohmann::json::parse(stream.str()).at("ground_motions").at(0);
  EXPECT_EQ(motion.at("points"), 6201);
  EXPECT_EQ(motion.at("factor"), 1.25);
  EXPECT_EQ(motion.at("end_displacement_m"), -0.03);
  const nlohmann::json& spectrum = motion.at("response_spectrum");
  EXPECT_EQ(spectrum.at("damping_ratio"), 0.05);
  EXPECT_TRUE(spectrum.at("points").at(0).at("mode").is_null()) << "of the grid";
  EXPECT_EQ(spectrum.at("points").at(1).at("mode"), 1);
  EXPECT_EQ(spectrum.at("points").at(1).at("pseudo_acceleration_m_per_s2"), 7.7);
  run.with_test_row = false;
  EXPECT_TRUE(summary_of(run).ground_motions.empty());
}

TEST(RunSummary, NamesKilledSite) {
  const TemporaryDirectory directory;
  ExampleRun run;
  run.stop_reason = StopReason::participant_lost;
  run.exit_code = kExitEndedEarly;
  run.write_coordinator(directory / "coordinator.h5");
  run.write_numerical(directory / "storey_2.h5");
  ForkedChild site{[&](const ForkedChild& self) {
    RunFileWriter writer{directory / "storey_1.h5", ExampleRun::header("storey_1", Role::experimental_site),
                         ExampleRun::site_tables()};
    run.append_site(writer);
    self.report(1);
    self.await_word();
  }};
  ASSERT_EQ(site.hear(), 1U);
  site.kill_now();
  const RunSummary summary = summarise(directory.path());
  EXPECT_THAT(summary.data_faults, ElementsAre(HasSubstr("storey_1: killed while recording")));
  EXPECT_EQ(summary.substructures[0].peak_force_n.at(0).value, -41'000.0) << "what was flushed is used";
  EXPECT_EQ(summary.exit_code, kExitEndedEarly);
}

TEST(RunSummary, MissingTestRowMakesDataInvalid) {
  ExampleRun run;
  run.with_test_row = false;
  const RunSummary killed = summary_of(run);
  EXPECT_EQ(killed.exit_code, kExitDataInvalid);
  EXPECT_EQ(verdict(killed), "end unknown (at 10.000 s); data invalid");
  EXPECT_EQ(killed.completed_steps, 10'000) << "from the steps recorded";
  EXPECT_FALSE(killed.planned_steps.has_value());
  EXPECT_DOUBLE_EQ(killed.wall_time_s.value(), 5.0);

  const TemporaryDirectory directory;
  run.write_site(directory / "storey_1.h5");
  const RunSummary alone = summarise(directory.path());
  EXPECT_THAT(alone.data_faults, ElementsAre(HasSubstr("coordinator's file is missing")));
  EXPECT_EQ(alone.substructures.at(0).tracking.size(), 1U);
}

TEST(RunSummary, FileOnAnotherHostIsNoFault) {
  const TemporaryDirectory directory;
  ExampleRun run;
  run.write_coordinator(directory / "coordinator.h5");
  run.write_numerical(directory / "storey_2.h5");
  const RunSummary summary = summarise(directory.path());
  EXPECT_EQ(summary.exit_code, kExitCompleted);
  EXPECT_THAT(summary.remarks, ElementsAre(HasSubstr("storey_1: no file")));
}

TEST(RunSummary, MissingOrForeignFileIsAFault) {
  const TemporaryDirectory directory;
  ExampleRun{}.write(directory.path());
  RunFileHeader stranger = ExampleRun::header("left_over", Role::experimental_site);
  stranger.scenario_digest[0] ^= 1U;
  RunFileWriter{directory / "left_over.h5", stranger, ExampleRun::site_tables()}.close();
  std::ofstream{directory / "torn.h5"} << "torn";
  const RunSummary summary = summarise(directory.path());
  EXPECT_THAT(summary.data_faults,
              ElementsAre(HasSubstr("torn.h5"), HasSubstr("left_over.h5 belongs to another test or scenario")));
  const TemporaryDirectory empty;
  EXPECT_THROW((void)summarise(empty.path()), RecordingError);
  EXPECT_THROW((void)summarise(empty / "absent"), RecordingError);
}

TEST(RunSummary, JsonIsInSiUnitsWithNullForUnknown) {
  ExampleRun run;
  run.site_at_rest = true;
  run.site_events = {example_event()};
  std::ostringstream stream;
  write_summary_json(summary_of(run), stream);
  const auto json = nlohmann::json::parse(stream.str());
  EXPECT_EQ(json.at("schema"), "hybridtest/summary/1");
  EXPECT_EQ(json.at("exit_code"), 0);
  EXPECT_EQ(json.at("stop_reason"), "completed");
  EXPECT_EQ(json.at("peak_displacement").at(1).at("displacement_m"), -0.045);
  const auto& site = json.at("substructures").at(0);
  EXPECT_EQ(site.at("peak_force").at(0).at("force_n"), -41'000.0);
  EXPECT_EQ(site.at("exchange").at("round_trip_us").at("p99"), 99.0);
  EXPECT_EQ(site.at("tracking").at(0).at("rms_m"), 0.0);
  EXPECT_TRUE(site.at("tracking").at(0).at("equivalent_delay_s").is_null());
  EXPECT_TRUE(json.at("substructures").at(1).at("energy_error").is_null());
  EXPECT_EQ(json.at("interlocks").at(0).at("limit"), 0.12);
  EXPECT_EQ(json.at("participants").at(1).at("role"), "experimental_site");
}

TEST(RunSummary, TellsWhoRefusedPackets) {
  const auto json_of = [](const RunSummary& summary) {
    std::ostringstream stream;
    write_summary_json(summary, stream);
    return nlohmann::json::parse(stream.str()).at("participants").at(1).at("refused_packets");
  };
  ExampleRun run;
  EXPECT_TRUE(json_of(summary_of(run)).is_null()) << "a file without the table";
  run.site_refused_packets = {0.0, 0.0, 0.0, 0.0};
  const RunSummary without = summary_of(run);
  EXPECT_EQ(json_of(without).at("harmful"), 0);
  EXPECT_THAT(printed(without), Not(HasSubstr("packets refused")));
  run.site_refused_packets = {3.0, 120.0, 1.0, 2.0};
  const RunSummary with = summary_of(run);
  EXPECT_EQ(json_of(with),
            (nlohmann::json{{"harmful", 3}, {"in_plain_text", 120}, {"announcements", 1}, {"departures", 2}}));
  EXPECT_THAT(printed(with), ContainsRegex("packets refused +harmful +plain text +false +departures\n"
                                           " +storey_1 +3 +120 +1 +2\n"));
  EXPECT_TRUE(with.data_valid);
}

TEST(RunSummary, ReportsControlLoopTiming) {
  EXPECT_FALSE(summary_of({}).substructures[0].loop_timing.has_value());
  ExampleRun run;
  run.site_has_loop_thread = true;
  const RunSummary summary = summary_of(run);
  ASSERT_TRUE(summary.substructures[0].loop_timing.has_value());
  EXPECT_FALSE(summary.substructures[1].loop_timing.has_value());
  const LoopTimingSummary& timing = *summary.substructures[0].loop_timing;
  EXPECT_EQ(timing.starts, 61440);
  EXPECT_EQ(timing.start_lateness_us.p99, 21.0);
  EXPECT_EQ(timing.busy_us.max, 99.0);
  EXPECT_EQ(timing.overruns, 3);
  EXPECT_TRUE(timing.memory_locked);
  EXPECT_EQ(timing.fifo_priority, 80);
  EXPECT_EQ(timing.cpu, 1);
  EXPECT_THAT(printed(summary), HasSubstr("FIFO 80"));
  std::ostringstream stream;
  write_summary_json(summary, stream);
  const auto json = nlohmann::json::parse(stream.str());
  EXPECT_EQ(json.at("substructures").at(0).at("loop_timing").at("start_lateness_us").at("max"), 345.0);
  EXPECT_TRUE(json.at("substructures").at(1).at("loop_timing").is_null());
}

TEST(RunSummary, PrintedSummaryStartsWithVerdict) {
  const std::string text = printed(summary_of({}));
  EXPECT_TRUE(text.starts_with("COMPLETED  (exit 0)  two_storey\n")) << text;
  EXPECT_THAT(text, HasSubstr("10000 of 10000 steps, 10.000 s of model time in 4.00 s, 2500 steps/s"));
  EXPECT_THAT(text, HasSubstr("-45.000      2.000"));           // mm, s
  EXPECT_THAT(text, HasSubstr("-41.000      3.000"));           // kN, s
  EXPECT_THAT(text, HasSubstr("0.050      0.099      0.100"));  // ms
  EXPECT_THAT(text, HasSubstr("12.50"));                        // delay, ms
  EXPECT_THAT(text, Not(HasSubstr("invalid")));
  for (std::istringstream lines{text}; !lines.eof();) {
    std::string line;
    std::getline(lines, line);
    EXPECT_LE(line.size(), 140U) << line;
  }
}

}  // namespace
}  // namespace hybridtest
