#include "report/run_report/run_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "core/config_error.hpp"
#include "recording/error.hpp"
#include "report/run_report/advice.hpp"
#include "report/run_report/comparison.hpp"
#include "report/run_report/time_histogram.hpp"
#include "tests/support/figure_values.hpp"
#include "tests/unit/recording/example_run.hpp"
#include "tests/unit/recording/temporary_directory.hpp"

namespace hybridtest {
namespace {

using testing::HasSubstr;
using testing::Not;
using namespace run_report;

class RunReport : public testing::Test {
 protected:
  [[nodiscard]] std::string page(const ReportRequest& request) const {
    return report_page(request, summarise(request.run));
  }
  [[nodiscard]] std::string page() const { return page({.run = directory_.path()}); }

  TemporaryDirectory directory_;
  ExampleRun example_;
};

double largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

TEST_F(RunReport, HistoriesHaveTheRecordedValues) {
  example_.write(directory_.path());
  const std::string html = page();
  const plot::Points floor_2 = shown_curve(html, "displacement relative to the ground", "floor_2");
  ASSERT_FALSE(floor_2.x.empty());
  const auto peak = std::ranges::max_element(floor_2.y, {}, [](double value) { return std::abs(value); });
  EXPECT_NEAR(*peak, -45.0, 0.02);
  EXPECT_NEAR(floor_2.x[static_cast<std::size_t>(peak - floor_2.y.begin())], 2.0, 0.002);

  const plot::Points target = shown_curve(html, "displacement", "target");
  ASSERT_GT(target.x.size(), 1000U);
  double farthest_mm = 0.0;
  for (std::size_t i = 0; i < target.x.size(); ++i) {
    farthest_mm = std::max(farthest_mm, std::abs(target.y[i] - 1e3 * ExampleRun::target_m(target.x[i])));
  }
  EXPECT_LT(farthest_mm, 0.02);
  // The site is late: its curve is not that of the target.
  const plot::Points measured = shown_curve(html, "displacement", "measured");
  double late_mm = 0.0;
  for (std::size_t i = 0; i < measured.x.size(); ++i) {
    late_mm = std::max(late_mm, std::abs(measured.y[i] - 1e3 * ExampleRun::target_m(measured.x[i])));
  }
  EXPECT_GT(late_mm, 2.0) << "control";
}

TEST_F(RunReport, RowsBeforeAndAfterTheTestAreNotShown) {
  example_.site_waits = 300;
  example_.site_returns = 300;
  example_.write(directory_.path());
  const std::string html = page();
  EXPECT_LT(largest(shown_curve(html, "displacement", "measured").y), 20.1);
  EXPECT_GT(largest(shown_curve(html, "displacement", "measured").y), 19.9);
}

TEST_F(RunReport, SaysVerdictAndNextStep) {
  example_.stop_reason = StopReason::interlock;
  example_.exit_code = 3;
  example_.write(directory_.path());
  const std::string html = page();
  EXPECT_THAT(html, HasSubstr("<p class=\"verdict bad\">✗ Ended by an interlock"));
  EXPECT_THAT(html, HasSubstr("inspect the specimen"));
}

TEST_F(RunReport, InvalidDataAreSaidWithTheirReason) {
  example_.site_dropped = 12;
  example_.write(directory_.path());
  const std::string html = page();
  EXPECT_THAT(html, HasSubstr("data invalid"));
  EXPECT_THAT(html, HasSubstr("The data are invalid: storey_1: 12 records dropped."));
}

TEST_F(RunReport, CompletedTestIsGood) {
  example_.write(directory_.path());
  EXPECT_THAT(page(), HasSubstr("<p class=\"verdict good\">✓ Completed"));
}

TEST_F(RunReport, BridgesAreSummedOverTime) {
  example_.write(directory_.path());
  EXPECT_THAT(page(), Not(HasSubstr("bridged steps so far"))) << "control";
  TemporaryDirectory other;
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  example_.bridges = {{2000.0, 0.0, 1.0, 4.0, 1.0},
                      {2001.0, 0.0, 2.0, -1.0, 0.0},
                      {3000.0, 1.0, 1.0, unknown, 0.0},
                      {6000.0, 0.0, 1.0, 0.5, 1.0}};
  example_.write(other.path());
  const std::string html = page({.run = other.path()});
  const auto value_at = [](const plot::Points& stairs, double time_s) {
    double value = 0.0;
    for (std::size_t i = 0; i < stairs.x.size() && stairs.x[i] <= time_s; ++i) value = stairs.y[i];
    return value;
  };
  const plot::Points site = shown_curve(html, "bridged steps so far", "storey_1");
  ASSERT_FALSE(site.x.empty());
  // Within the width of the pen: the page has a tenth of a pixel.
  EXPECT_NEAR(value_at(site, 1.9), 0.0, 0.01);
  EXPECT_NEAR(value_at(site, 2.1), 2.0, 0.01);
  EXPECT_NEAR(value_at(site, 5.9), 2.0, 0.01);
  EXPECT_NEAR(value_at(site, 9.9), 3.0, 0.01);
  EXPECT_NEAR(value_at(shown_curve(html, "bridged steps so far", "storey_2"), 9.9), 1.0, 0.01);
  const char* energy = "energy that bridges added to the structure so far";
  EXPECT_NEAR(value_at(shown_curve(html, energy, "storey_1"), 5.9), 3.0, 0.02);
  EXPECT_NEAR(value_at(shown_curve(html, energy, "storey_1"), 9.9), 3.5, 0.02);
  EXPECT_TRUE(shown_curve(html, energy, "storey_2").x.empty()) << "nothing is known of its energy";
}

TEST_F(RunReport, AbsentFilesAreLeftOutWithAWord) {
  example_.write(directory_.path());
  std::filesystem::remove(directory_ / "storey_2.h5");
  const std::string html = page();
  EXPECT_THAT(html, HasSubstr("No recording of storey_2 in this run directory"));
  EXPECT_FALSE(shown_curve(html, "displacement", "target").x.empty());
  std::filesystem::remove(directory_ / "coordinator.h5");
  EXPECT_FALSE(shown_curve(page(), "displacement", "target").x.empty());
}

TEST_F(RunReport, FileThatIsNoRecordingIsNamed) {
  example_.write(directory_.path());
  std::ofstream{directory_ / "storey_2.h5"} << "not a recording";
  EXPECT_THAT(page(), HasSubstr("Not read: "));
}

TEST_F(RunReport, RunWithoutAStepHasAPage) {
  example_.coordinator_steps = -1;
  example_.site_steps = -1;
  example_.with_test_row = false;
  example_.write(directory_.path());
  const std::string html = page();
  EXPECT_THAT(html, HasSubstr("End unknown"));
  EXPECT_THAT(html, Not(HasSubstr("data-x-label=\"model time [s]\""))) << "no empty plot";
}

TEST_F(RunReport, UnreadableScenarioIsSaid) {
  example_.write(directory_.path());
  std::ofstream{directory_ / "scenario.yaml"} << "schema: hybridtest/99\n";
  const std::string html = page();
  EXPECT_THAT(html, HasSubstr("The scenario is not shown: "));
  EXPECT_FALSE(shown_curve(html, "displacement", "target").x.empty());
}

TEST_F(RunReport, NamesAreEscaped) {
  example_.site_events.push_back(Event{.source = "storey_1", .code = EventCode::zero_offset, .subject = "<b>"});
  example_.write(directory_.path());
  EXPECT_THAT(page(), Not(HasSubstr("<b>")));
}

TEST_F(RunReport, ReportThatCannotBeWrittenIsSaid) {
  example_.write(directory_.path());
  const RunSummary summary = summarise(directory_.path());
  EXPECT_THROW(write_report({.run = directory_.path()}, summary, directory_ / "gone/report.html"), RecordingError);
  write_report({.run = directory_.path()}, summary, directory_ / "report.html");
  EXPECT_GT(std::filesystem::file_size(directory_ / "report.html"), 10'000U);
}

TEST_F(RunReport, OtherRunIsDrawnOverIt) {
  example_.write(directory_.path());
  TemporaryDirectory second;
  ExampleRun other = example_;
  other.site_error = 0.5;
  other.write(second.path());
  const std::string label = second.path().filename().string();
  const std::string html = page({.run = directory_.path(), .compare = {second.path()}});
  EXPECT_NEAR(largest(shown_curve(html, "displacement", "measured").y), 20.0, 0.1);
  EXPECT_GT(largest(shown_curve(html, "displacement", "measured, " + label).y), 29.0);
  EXPECT_FALSE(shown_curve(html, "displacement of floor_1", label).x.empty());
  EXPECT_FALSE(shown_curve(html, "synchronisation subspace", "measured, " + label).x.empty());
}

TEST_F(RunReport, RunDoesNotDifferFromItself) {
  example_.write(directory_.path());
  const Compared same = read_compared(directory_.path(), read_run_record(directory_.path()));
  ASSERT_EQ(same.differences.size(), 4U);  // two floors, displacement and force of the site
  for (const Difference& difference : same.differences) {
    EXPECT_EQ(difference.peak, difference.other_peak);
    EXPECT_EQ(difference.rms_relative.value_or(0.0), 0.0);
    EXPECT_EQ(difference.peak_relative.value_or(0.0), 0.0);
  }
}

TEST_F(RunReport, ReferenceInTheRunIsDrawnOverIt) {
  example_.write(directory_.path());
  std::filesystem::create_directory(directory_ / "reference");
  std::ofstream csv{directory_ / "reference/in_process.csv"};
  csv << "time_s,displacement_floor_1_m\n";
  // Ten times coarser than the run, whose floor 1 stands at 1 mm but for one step of 30 mm.
  for (int i = 0; i <= 1000; ++i) csv << 0.01 * i << ",0.002\n";
  csv.close();
  const RunRecord run = read_run_record(directory_.path());
  const auto references = references_of(run);
  ASSERT_EQ(references.size(), 1U);
  ASSERT_EQ(references[0].differences.size(), 1U);
  const Difference& difference = references[0].differences[0];
  EXPECT_EQ(difference.signal, "displacement floor_1");
  EXPECT_DOUBLE_EQ(difference.peak, 0.03);
  EXPECT_DOUBLE_EQ(difference.other_peak, 0.002);
  EXPECT_NEAR(*difference.peak_relative, 14.0, 1e-12);
  const double squares = 10'000.0 * 1e-6 + 0.028 * 0.028;
  EXPECT_NEAR(*difference.rms_relative, std::sqrt(squares / (10'001.0 * 4e-6)), 1e-9);
  EXPECT_FALSE(shown_curve(page(), "displacement of floor_1", "reference in_process").x.empty());
}

TEST_F(RunReport, PredictionOfADiagnosisIsDrawnWithItsGap) {
  example_.write(directory_.path());
  TemporaryDirectory diagnosis;
  std::ofstream csv{diagnosis / "prediction.csv"};
  csv << "interface,dof,unit,time_s,measured,modelled,completed,recording\n";
  for (int i = 0; i < 1000; ++i) {
    const double force_n = 1e3 * std::sin(0.05 * i);
    csv << "specimen,1,N," << 0.001 * i << ',' << force_n << ',' << 0.8 * force_n << ',' << 0.99 * force_n
        << ",a, b.csv\n";
  }
  csv.close();
  const Compared compared = read_compared(diagnosis.path(), read_run_record(directory_.path()));
  ASSERT_EQ(compared.differences.size(), 2U);
  EXPECT_NEAR(*compared.differences[0].rms_relative, 0.2, 1e-4);
  EXPECT_NEAR(*compared.differences[1].rms_relative, 0.01, 1e-4);
  const std::string html = page({.run = directory_.path(), .compare = {diagnosis.path()}});
  EXPECT_NEAR(largest(shown_curve(html, "specimen, a, b.csv", "measured").y), 1.0, 2e-3);
  EXPECT_NEAR(largest(shown_curve(html, "specimen, a, b.csv", "model as given").y), 0.8, 2e-3);
}

TEST_F(RunReport, WhatCannotBeComparedIsRefused) {
  example_.write(directory_.path());
  const RunRecord run = read_run_record(directory_.path());
  TemporaryDirectory empty;
  EXPECT_THROW((void)read_compared(empty.path(), run), ConfigError);
  std::ofstream{empty / "other.csv"} << "time_s,displacement_roof_m\n0,1\n1,2\n";
  EXPECT_THROW((void)read_compared(empty / "other.csv", run), ConfigError);
  std::ofstream{empty / "broken.csv"} << "time_s,displacement_floor_1_m\n0,1\n1,x\n";
  EXPECT_THROW((void)read_compared(empty / "broken.csv", run), ConfigError);
}

TEST(TimeHistogram, OutlineHasAllItsShares) {
  TimeHistogram histogram;
  for (int i = 0; i < 99; ++i) histogram.add(10.1);
  histogram.add(1000.5);
  histogram.add(std::nan(""));
  const TimeHistogram::Outline outline = histogram.outline();
  EXPECT_DOUBLE_EQ(histogram.count(), 100.0);
  EXPECT_DOUBLE_EQ(*std::ranges::max_element(outline.percent), 99.0);
  EXPECT_NEAR(outline.time_us.front(), 10.0, 1e-9);
  EXPECT_GT(outline.time_us.back(), 1000.5);
  EXPECT_TRUE(TimeHistogram{}.outline().time_us.empty());
}

}  // namespace
}  // namespace hybridtest
