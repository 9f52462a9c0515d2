#include "recording/csv_export.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "recording/error.hpp"
#include "tests/unit/recording/example_run.hpp"
#include "tests/unit/recording/temporary_directory.hpp"

namespace hybridtest {
namespace {

std::vector<std::string> lines_of(const std::filesystem::path& path) {
  std::ifstream stream{path};
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(CsvExport, WritesEveryTableWithUnitsInItsHeader) {
  const TemporaryDirectory directory;
  ExampleRun run;
  run.site_events = {example_event()};
  run.site_events[0].clock = Duration{1'500'000'000};
  run.write(directory.path());
  const auto out = directory / "csv";
  const auto written = export_csv(directory.path(), out);
  ASSERT_EQ(written.size(), 13U) << "7 + 2 + 1 tables and the events of three files";
  EXPECT_EQ(written.front(), out / "coordinator.bridges.csv");

  const auto control = lines_of(out / "storey_1.control.csv");
  ASSERT_EQ(control.size(), 10'001U);
  EXPECT_EQ(control[0],
            "sample,time_s,model_time_s,target_displacement_m,command_displacement_m,measured_displacement_m,"
            "measured_force_n,energy_error_j,faults");
  const auto events = lines_of(out / "storey_1.events.csv");
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[1],
            "1.5,2,12,interlock_tripped,4711,4.711,\"storey_1\",\"displacement_limit\",0.1234,0.12,"
            "\"it \"\"happened\"\", there\"");
}

TEST(CsvExport, NumbersKeepTheirBits) {
  const TemporaryDirectory directory;
  const std::vector<double> values{0.1,     1.0 / 3.0, -0.0, 5e-324, 1.7976931348623157e308,
                                   31000.0, 1e22,      0.3,  -2.5,   std::numeric_limits<double>::infinity()};
  {
    RunFileWriter writer{directory / "a.h5", example_header(), {{"t", {{"value", "-"}}}}};
    writer.append(0, values);
    writer.append(0, std::vector{std::copysign(std::numeric_limits<double>::quiet_NaN(), -1.0)});
  }
  export_csv(directory.path(), directory.path());
  const auto lines = lines_of(directory / "a.t.csv");
  ASSERT_EQ(lines.size(), values.size() + 2);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double back = std::strtod(lines[i + 1].c_str(), nullptr);
    EXPECT_EQ(back, values[i]);
    EXPECT_EQ(std::signbit(back), std::signbit(values[i]));
  }
  EXPECT_EQ(lines[1], "0.1") << "the shortest";
  EXPECT_EQ(lines.back(), "nan");
}

TEST(CsvExport, ReportsMissingRunAndUnwritableTarget) {
  const TemporaryDirectory directory;
  EXPECT_THROW(export_csv(directory.path(), directory / "csv"), RecordingError);
  RunFileWriter{directory / "a.h5", example_header(), {example_layout()}}.close();
  EXPECT_THROW(export_csv(directory.path(), "/proc/nowhere"), RecordingError);
}

}  // namespace
}  // namespace hybridtest
