#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "diagnosis/intake/intake.hpp"
#include "tests/support/shared_data.hpp"

namespace hybridtest {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

constexpr int kRows = 100;

/// A recording of rows that a test may spoil one by one; row 2 is the first with data.
struct ExampleCsv {
  std::vector<std::string> rows;

  explicit ExampleCsv(double metre = 1.0) {
    rows.emplace_back("time_s,command_displacement_m,measured_displacement_m,measured_force_n");
    for (int i = 0; i < kRows; ++i) {
      const double time_s = 0.001 * i;
      const double command_m = 0.02 * std::sin(60.0 * time_s);
      const double measured_m = 0.019 * std::sin(60.0 * time_s - 0.2);
      rows.push_back(
          fmt::format("{:.3f},{:.7f},{:.7f},{:.3f}", time_s, command_m, metre * measured_m, 1e5 * measured_m));
    }
  }
  std::string& row(std::size_t number) { return rows[number - 1]; }
  [[nodiscard]] std::string text() const {
    std::string text;
    for (const std::string& row : rows) text += row + "\n";
    return text;
  }
  [[nodiscard]] std::vector<std::string> complaints() const { return complaints_about(text()); }

  static std::vector<std::string> complaints_about(const std::string& text) {
    const Intake intake = read_csv_recording(text, "a.csv");
    EXPECT_EQ(intake.recording.has_value(), intake.findings.empty());
    std::vector<std::string> complaints;
    for (const IntakeFinding& finding : intake.findings) complaints.push_back(finding.text("a.csv"));
    return complaints;
  }
};

TEST(CsvRecording, HoldsTheValuesOfTheFile) {
  ExampleCsv csv;
  csv.row(1) += "\r";
  const Intake intake = read_csv_recording("\xEF\xBB\xBF" + csv.text() + "\n\n", "a.csv");
  ASSERT_TRUE(intake.recording.has_value()) << intake.findings.front().text("a.csv");
  const Recording& recording = *intake.recording;
  EXPECT_EQ(recording.file, "a.csv");
  EXPECT_EQ(recording.samples, std::size_t{kRows});
  EXPECT_DOUBLE_EQ(recording.sample_period_s, 0.001);
  ASSERT_THAT(recording.dofs, SizeIs(1));
  EXPECT_FALSE(recording.dofs[0].has(Channel::target_displacement));
  // Seven digits behind the point were written.
  EXPECT_NEAR(recording.dofs[0].of(Channel::command_displacement)[20], 0.02 * std::sin(1.2), 0.5e-7);
  EXPECT_NEAR(recording.dofs[0].of(Channel::measured_force)[99], 1900.0 * std::sin(5.74), 0.5e-3);
}

std::string with_inputs(const std::string& names, const std::string& cells) {
  std::string text = "time_s,measured_force_n," + names + "\n";
  for (int i = 0; i < 20; ++i) text += fmt::format("{},{},{}\n", 0.01 * i, i, cells);
  return text;
}

TEST(CsvRecording, ReadsInputsBesideTheMotionInAnyUnit) {
  const Intake intake = read_csv_recording(with_inputs("input_temperature_c,input_current_a", "-20,1e9"), "a.csv");
  ASSERT_TRUE(intake.recording.has_value()) << intake.findings.front().text("a.csv");
  ASSERT_THAT(intake.recording->inputs, SizeIs(2));  // constant ones are allowed
  EXPECT_EQ(intake.recording->inputs[0].name, "current_a");
  EXPECT_EQ(intake.recording->inputs[0].samples, std::vector<double>(20, 1e9));
  EXPECT_EQ(intake.recording->inputs[1].name, "temperature_c");
  EXPECT_TRUE(intake.recording->has_input("temperature_c"));
  EXPECT_FALSE(intake.recording->has_input("input_temperature_c"));
}

TEST(CsvRecording, FindsWhatIsWrongWithAnInputByRow) {
  std::string text = with_inputs("input_current_a", "1.0");
  text.replace(text.find("0.03,3,1.0"), 10, "0.03,3,nan");
  text.replace(text.find("0.05,5,1.0"), 10, "0.05,5,");
  const std::vector<std::string> complaints = ExampleCsv::complaints_about(text);
  ASSERT_THAT(complaints, SizeIs(2));
  EXPECT_THAT(complaints[0], HasSubstr("a.csv:5: column 'input_current_a': 'nan': not a finite number"));
  EXPECT_THAT(complaints[1], HasSubstr("a.csv:7: column 'input_current_a': empty cell"));
}

TEST(CsvRecording, RefusesInputsTwiceAndWithoutAPlainName) {
  const std::vector<std::string> twice = ExampleCsv::complaints_about(with_inputs("input_a,input_a", "1,2"));
  ASSERT_THAT(twice, SizeIs(1));
  EXPECT_THAT(twice[0], HasSubstr("column 'input_a': two columns have this name"));
  for (const std::string name : {"input_", "input_Current", "input_2", "current_a"}) {
    const std::vector<std::string> unknown = ExampleCsv::complaints_about(with_inputs(name, "1"));
    ASSERT_THAT(unknown, SizeIs(1)) << name;
    EXPECT_THAT(unknown[0], HasSubstr("unknown column"));
    EXPECT_THAT(unknown[0], HasSubstr("headed input_"));
  }
}

TEST(CsvRecording, ReadsDofSuffixesAndExportedTables) {
  std::string text =
      "sample,time_s,model_time_s,target_displacement_m_1,measured_force_n_1,compensated_force_n_1,"
      "target_displacement_m_2,measured_force_n_2,compensated_force_n_2,energy_error_j,faults\n";
  for (int i = 0; i < 20; ++i) text += fmt::format("{0},{1},{1},{2},3,4,5e-3,6,7,8,9\n", i, 0.01 * i, 1e-3 * i);
  const Intake intake = read_csv_recording(text, "control.csv");
  ASSERT_TRUE(intake.recording.has_value()) << intake.findings.front().text("control.csv");
  ASSERT_THAT(intake.recording->dofs, SizeIs(2));
  EXPECT_EQ(intake.recording->dofs[0].of(Channel::target_displacement)[7], 7e-3);
  EXPECT_EQ(intake.recording->dofs[1].of(Channel::measured_force)[7], 6.0);
  EXPECT_FALSE(intake.recording->dofs[1].has(Channel::measured_displacement));
}

TEST(CsvRecording, TimeStampsRoundedToMicrosecondsAreAccepted) {
  std::string text = "time_s,measured_force_n\n";
  for (int i = 0; i < 28'000; ++i) text += fmt::format("{:.6f},1\n", i / 1024.0);
  const Intake intake = read_csv_recording(text, "a.csv");
  ASSERT_TRUE(intake.recording.has_value()) << intake.findings.front().text("a.csv");
  // Two roundings of half a microsecond over 27 999 intervals.
  EXPECT_NEAR(intake.recording->sample_period_s, 1.0 / 1024.0, 1e-6 / 27'999);
}

/// One spoiled place and what must be said of it.
struct Spoiled {
  const char* name;
  void (*spoil)(ExampleCsv&);
  const char* complaint;
};

class OneThingWrong : public testing::TestWithParam<Spoiled> {};

TEST_P(OneThingWrong, NamesRowColumnAndValue) {
  ExampleCsv csv;
  GetParam().spoil(csv);
  const auto complaints = csv.complaints();
  ASSERT_THAT(complaints, SizeIs(1)) << testing::PrintToString(complaints);
  EXPECT_THAT(complaints[0], HasSubstr(GetParam().complaint));
}

void replace(std::string& row, const std::string& part, const std::string& by) {
  ASSERT_NE(row.find(part), std::string::npos) << row;
  row.replace(row.find(part), part.size(), by);
}

INSTANTIATE_TEST_SUITE_P(
    Cells, OneThingWrong,
    testing::Values(Spoiled{"nan", [](ExampleCsv& csv) { csv.row(7) = "0.005,nan,0,0"; },
                            "a.csv:7: column 'command_displacement_m': 'nan': not a finite number; expected a number"},
                    Spoiled{"infinite", [](ExampleCsv& csv) { csv.row(8) = "0.006,0,0,-inf"; },
                            "a.csv:8: column 'measured_force_n': '-inf': not a finite number; expected a number"},
                    Spoiled{"too_large", [](ExampleCsv& csv) { csv.row(8) = "0.006,0,0,1e999"; },
                            "a.csv:8: column 'measured_force_n': '1e999': not a number; expected digits"},
                    Spoiled{"empty", [](ExampleCsv& csv) { csv.row(7) = "0.005,,0,0"; },
                            "a.csv:7: column 'command_displacement_m': empty cell; expected a number"},
                    Spoiled{"text", [](ExampleCsv& csv) { csv.row(7) = "0.005,0,0,12 kN"; },
                            "a.csv:7: column 'measured_force_n': '12 kN': not a number; expected digits"},
                    Spoiled{"cells", [](ExampleCsv& csv) { csv.row(7) = "0.005,0,0"; },
                            "a.csv:7: 3 cells in this row; expected 4 as in the header"},
                    Spoiled{"empty_row", [](ExampleCsv& csv) { csv.rows.insert(csv.rows.begin() + 6, ""); },
                            "a.csv:7: empty row; remove it"},
                    Spoiled{"many",
                            [](ExampleCsv& csv) {
                              for (const std::size_t row : {7, 9, 30}) replace(csv.row(row), ",", ",nan");
                            },
                            "a.csv:7: column 'command_displacement_m': 'nan"}),
    [](const auto& param_info) { return param_info.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Time, OneThingWrong,
    testing::Values(Spoiled{"gap", [](ExampleCsv& csv) { csv.rows.erase(csv.rows.begin() + 9, csv.rows.begin() + 14); },
                            "a.csv:10: column 'time_s': '0.013': gap before this row: about 5 samples are missing"},
                    Spoiled{"reversed_file",
                            [](ExampleCsv& csv) { std::reverse(csv.rows.begin() + 1, csv.rows.end()); },
                            "a.csv: column 'time_s': time does not advance"},
                    Spoiled{"drift",
                            [](ExampleCsv& csv) {
                              csv.rows.resize(1);
                              // The period grows by 0.9 % in the middle, each interval by less than a hundredth.
                              for (int i = 0; i < 2000; ++i) {
                                const double time_s = 0.001 * i + (i > 1000 ? 9e-6 * (i - 1000) : 0.0);
                                csv.rows.push_back(fmt::format("{:.7f},0,0,0", time_s));
                              }
                            },
                            "uneven sampling: the sample period changes during the recording"}),
    [](const auto& param_info) { return param_info.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Header, OneThingWrong,
    testing::Values(
        Spoiled{"misspelt", [](ExampleCsv& csv) { replace(csv.row(1), "measured_force_n", "mesured_force_n"); },
                "a.csv:1: column 'mesured_force_n': unknown column; did you mean 'measured_force_n'?"},
        Spoiled{"unit",
                [](ExampleCsv& csv) { replace(csv.row(1), "measured_displacement_m", "measured_displacement_mm"); },
                "unknown column; did you mean 'measured_displacement_m'?"},
        Spoiled{"acceleration_without_time",
                [](ExampleCsv& csv) {
                  replace(csv.row(1), "time_s", "sample");
                  replace(csv.row(1), "measured_force_n", "measured_acceleration_m_per_s2");
                },
                "a.csv: column 'measured_acceleration_m_per_s2': a recording without time is quasi-static"},
        Spoiled{"steps_back",
                [](ExampleCsv& csv) {
                  replace(csv.row(1), "time_s", "step");
                  replace(csv.row(20), "0.018", "0.016");
                },
                "a.csv:20: column 'step': '0.016': step is not larger than the one before"},
        Spoiled{"twice", [](ExampleCsv& csv) { replace(csv.row(1), "command_dis", "measured_dis"); },
                "a.csv:1: column 'measured_displacement_m': two columns have this name"},
        Spoiled{"hole",
                [](ExampleCsv& csv) {
                  csv.row(1) = "time_s,command_displacement_m,measured_displacement_m,measured_force_n_3";
                },
                "a.csv: columns of degree of freedom 2 are missing"},
        Spoiled{"no_channel", [](ExampleCsv& csv) { csv.row(1) = "time_s,sample,model_time_s,faults"; },
                "a.csv: no data column"},
        Spoiled{"semicolons", [](ExampleCsv& csv) { std::ranges::replace(csv.row(1), ',', ';'); },
                "a.csv:1: columns are separated by semicolons or tabs; expected commas"},
        Spoiled{"header_only", [](ExampleCsv& csv) { csv.rows.resize(1); }, "a.csv: a header without data"},
        Spoiled{"short", [](ExampleCsv& csv) { csv.rows.resize(10); }, "a.csv: 9 rows of data; expected at least 16"},
        Spoiled{"nothing", [](ExampleCsv& csv) { csv.rows.clear(); }, "a.csv: the file is empty"}),
    [](const auto& param_info) { return param_info.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Units, OneThingWrong,
    testing::Values(Spoiled{"millimetres_beside_metres", [](ExampleCsv& csv) { csv = ExampleCsv{1000.0}; },
                            "column 'measured_displacement_m': '-18.9994497': seems to be in millimetres: its range is "
                            "37.99, 950 times"},
                    Spoiled{"inches_beside_metres", [](ExampleCsv& csv) { csv = ExampleCsv{39.3701}; },
                            "seems to be in inches"},
                    Spoiled{"all_in_millimetres",
                            [](ExampleCsv& csv) {
                              csv.rows = {"time_s,measured_displacement_m"};
                              for (int i = 0; i < 1000; ++i)
                                csv.rows.push_back(fmt::format("{},{}", 0.001 * i, 20.0 * std::sin(0.01 * i)));
                            },
                            "seems to be in millimetres: the largest displacement accepted is 10 m; expected metres"},
                    Spoiled{"small_and_fast",
                            [](ExampleCsv& csv) {
                              csv.rows = {"time_s,measured_displacement_m"};
                              // 3 mm at 1 Hz read as metres: 18.8 m/s.
                              for (int i = 0; i < 1000; ++i) {
                                csv.rows.push_back(fmt::format("{},{}", 0.001 * i, 3.0 * std::sin(6.2832 * 0.001 * i)));
                              }
                            },
                            "read in metres its speed is 18.8 m/s"}),
    [](const auto& param_info) { return param_info.param.name; });

/// A command of an unstable compensator, beside an actuator that did not follow it; control: with nothing measured
/// beside it, it is taken for millimetres.
TEST(CsvRecording, CommandMayAskForASpeedThatNoActuatorReaches) {
  const auto recorded = [](bool has_measured) {
    std::string text =
        has_measured ? "time_s,command_displacement_m,measured_displacement_m\n" : "time_s,command_displacement_m\n";
    for (int i = 0; i < 1000; ++i) {
      const double growth = std::pow(1.004, i) / std::pow(1.004, 1000);
      text += fmt::format("{},{:.6f}", 0.001 * i, 0.2 * growth * std::sin(0.1 * i));  // up to 20 m/s
      text += has_measured ? fmt::format(",{:.6f}\n", 0.02 * std::sin(0.01 * i)) : "\n";
    }
    return ExampleCsv::complaints_about(text);
  };
  EXPECT_THAT(recorded(true), testing::IsEmpty());
  EXPECT_THAT(recorded(false), testing::ElementsAre(HasSubstr("the largest speed accepted is 10 m/s")));
}

TEST(CsvRecording, NamesRowsOfInvalidTimeStamps) {
  ExampleCsv csv;
  csv.row(10).replace(0, 5, "0.007");  // as the row before
  csv.row(20).replace(0, 5, "0.016");  // before the row before
  csv.row(30).replace(0, 5, "0.0284");
  const auto complaints = csv.complaints();
  ASSERT_THAT(complaints, SizeIs(testing::Ge(3U)));
  EXPECT_THAT(complaints, testing::Contains(HasSubstr("a.csv:10: column 'time_s': '0.007': time stamp repeated")));
  EXPECT_THAT(
      complaints,
      testing::Contains(HasSubstr("a.csv:20: column 'time_s': '0.016': time stamp is earlier than the one before")));
  EXPECT_THAT(complaints, testing::Contains(HasSubstr("a.csv:30: column 'time_s': '0.0284': uneven sampling")));
}

TEST(CsvRecording, RepeatedErrorIsReportedOnce) {
  ExampleCsv csv;
  for (const std::size_t row : {7, 9, 30}) csv.row(row) = "0.001,nan,0,0";
  const auto complaints = csv.complaints();
  ASSERT_THAT(complaints, SizeIs(1));
  EXPECT_THAT(complaints[0], HasSubstr("(and in 2 more rows, the last 30)"));
}

TEST(CsvRecording, RestingChannelIsNotAWrongUnit) {
  std::string text = "time_s,command_displacement_m,measured_displacement_m\n";
  for (int i = 0; i < 1000; ++i) {
    // Noise of ±5 um under a motion of ±5 mm: 1000 times as wide, and nothing to do with it.
    text += fmt::format("{:.3f},{:.7f},{:.7f}\n", 0.001 * i, 0.005 * std::sin(0.02 * i), (i * 7919 % 11 - 5) * 1e-6);
  }
  EXPECT_THAT(ExampleCsv::complaints_about(text), SizeIs(0));
}

TEST(CsvRecording, ReadsMeasuredRecordings) {
  const std::filesystem::path folder = shared_data("measured");
  HYBRIDTEST_NEEDS_DATA(folder);
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator{folder}) {
    if (entry.path().extension() != ".csv") continue;
    std::ifstream stream{entry.path(), std::ios::binary};
    const std::string text{std::istreambuf_iterator<char>{stream}, std::istreambuf_iterator<char>{}};
    const Intake intake = read_csv_recording(text, entry.path().filename().string());
    ASSERT_TRUE(intake.recording.has_value()) << intake.findings.front().text(entry.path().string());
    const bool has_time = text.substr(0, text.find('\n')).find("time_s") != std::string::npos;
    EXPECT_EQ(intake.recording->is_quasi_static, !has_time) << entry.path();
    if (!has_time) continue;
    const double rate_hz = 1.0 / intake.recording->sample_period_s;
    EXPECT_NEAR(rate_hz, rate_hz > 1010.0 ? 1024.0 : 1000.0, 1e-3) << entry.path();
    ++files;
  }
  EXPECT_GE(files, 12);
}

}  // namespace
}  // namespace hybridtest
