#include "coordinator/excitation/read_ground_motion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "core/config_error.hpp"
#include "tests/support/shared_data.hpp"

namespace hybridtest {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr double kG = 9.80665;

std::string at2(const std::string& sampling, const std::string& values) {
  return "SOMEWHERE\nEARTHQUAKE 01/02/34, STATION 5\nACCELERATION TIME HISTORY IN UNITS OF G\n" + sampling + "\n" +
         values;
}

GroundMotion parse(const std::string& text, const GroundMotionOptions& options = {}) {
  return parse_ground_motion(text, "motion.txt", options);
}

/// The message of a refusal; empty when accepted.
std::string complaint(const std::string& text, const GroundMotionOptions& options = {},
                      const std::string& name = "motion.txt") {
  try {
    static_cast<void>(parse_ground_motion(text, name, options));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return {};
}

GroundMotionOptions in_g() { return {.scale = 1.0, .unit = AccelerationUnit::g, .dt_s = {}}; }

TEST(At2, ReadsBothKindsOfHeader) {
  for (const char* sampling :
       {"NPTS= 3, DT= .02000 SEC", "NPTS=      3, DT= .02000 SEC,", "3  .0200 NPTS, DT", "     3    0.0200    NPTS, DT",
        "NPTS=3 DT=0.02", "npts = 3 , dt = 2.0E-02 sec", "DT= .02 SEC, NPTS= 3"}) {
    const GroundMotion motion = parse(at2(sampling, "  .1E+00  -.2500000E-01\n 1.0\n"));
    EXPECT_EQ(motion.dt_s, 0.02) << sampling;
    ASSERT_EQ(motion.acceleration_m_per_s2.size(), 3U) << sampling;
    EXPECT_DOUBLE_EQ(motion.acceleration_m_per_s2[0], 0.1 * kG);
    EXPECT_DOUBLE_EQ(motion.acceleration_m_per_s2[1], -0.025 * kG);
    EXPECT_DOUBLE_EQ(motion.acceleration_m_per_s2[2], kG);
  }
}

TEST(At2, ReadsEveryLineEnding) {
  const std::string text = at2("NPTS= 4, DT= .01 SEC", "1 2\n3\n\n4");
  const GroundMotion expected = parse(text);
  for (const char* end : {"\r\n", "\r\r\n", "\r"}) {
    std::string other;
    for (const char c : text) other += c == '\n' ? std::string{end} : std::string{c};
    EXPECT_EQ(parse(other).acceleration_m_per_s2, expected.acceleration_m_per_s2);
    EXPECT_EQ(parse(other + end + end).acceleration_m_per_s2, expected.acceleration_m_per_s2);
  }
}

TEST(At2, ReadsFortranNumbers) {
  const GroundMotion motion = parse(at2("NPTS= 4, DT= .01 SEC", "+.5 -.25D-01 1.d0 2e+1"));
  EXPECT_DOUBLE_EQ(motion.acceleration_m_per_s2[1], -0.025 * kG);
  EXPECT_DOUBLE_EQ(motion.acceleration_m_per_s2[3], 20.0 * kG);
}

TEST(At2, AcceptsAnyTextInHeaderLines) {
  const GroundMotion motion = parse("1559 points\n0.1 0.2 0.3\nThe units are (g)\nNPTS= 2, DT= .01 SEC\n1 2\n");
  EXPECT_EQ(motion.acceleration_m_per_s2.size(), 2U);
  EXPECT_EQ(parse("\n\n\n2 .01 NPTS, DT\n1 2").acceleration_m_per_s2.size(), 2U);
}

TEST(At2, AppliesScaleAndUnit) {
  const std::string text = at2("NPTS= 1, DT= .01 SEC", "2.0");
  EXPECT_DOUBLE_EQ(parse(text, {.scale = -0.5, .unit = {}, .dt_s = {}}).acceleration_m_per_s2[0], -kG);
  EXPECT_DOUBLE_EQ(
      parse(text, {.scale = 1.0, .unit = AccelerationUnit::cm_per_s2, .dt_s = {}}).acceleration_m_per_s2[0], 0.02);
}

TEST(At2, RejectsCountThatDisagreesWithHeader) {
  EXPECT_EQ(complaint(at2("NPTS= 4, DT= .01 SEC", "1 2\n3\n")),
            "motion.txt:6: the file ends after 3 values, expected 4 values, as given in line 4");
  EXPECT_EQ(complaint(at2("NPTS= 4, DT= .01 SEC", "1 2\n3 4\n5\n6")),
            "motion.txt:7: more values follow, expected 4 values, as given in line 4");
  EXPECT_THAT(complaint(at2("NPTS= 4, DT= .01 SEC", "")), HasSubstr("after 0 values, expected 4"));
}

TEST(At2, RejectsTextBetweenNumbers) {
  EXPECT_EQ(complaint(at2("NPTS= 3, DT= .01 SEC", "1 2\nabc\n")),
            "motion.txt:6: found 'abc', expected an acceleration value");
  for (const char* word : {"nan", "inf", "1.0.0", "1,2", "0x10", "1e999", "--1", "+-1", "*******"}) {
    EXPECT_THAT(complaint(at2("NPTS= 1, DT= .01 SEC", word)), StartsWith("motion.txt:5: found '")) << word;
  }
}

TEST(At2, RejectsHeaderWithoutStepOrCount) {
  EXPECT_THAT(complaint(at2("NPTS= 3", "1 2 3")), AllOf(StartsWith("motion.txt:4: "), HasSubstr("no step DT")));
  EXPECT_THAT(complaint(at2("NPTS, DT= .01", "1 2 3")), HasSubstr("no number of points"));
  EXPECT_THAT(complaint(at2("NPTS= 3, DT= SEC", "1 2 3")), HasSubstr("no step DT"));
  EXPECT_THAT(complaint(at2("NPTS= 3, DT= 0.0", "1 2 3")), HasSubstr("not positive"));
  EXPECT_THAT(complaint(at2("NPTS= 0, DT= .01", "1 2 3")), HasSubstr("NPTS is out of range"));
  EXPECT_THAT(complaint(at2("NPTS= 2.5, DT= .01", "1 2 3")), HasSubstr("NPTS is out of range"));
  EXPECT_THAT(complaint(at2("NPTS= 1e300, DT= .01", "1 2 3")), HasSubstr("NPTS is out of range"));
  EXPECT_THAT(complaint("a\nb\nc\n1 2 3\n4 5\n", {}, "record.At2"),
              AllOf(StartsWith("record.At2:4: "), HasSubstr("'NPTS= 1559, DT= .02000 SEC'"), HasSubstr("'1 2 3'")));
  EXPECT_THAT(complaint("only one line", {}, "record.AT2"), StartsWith("record.AT2:1: "));
}

TEST(At2, RejectsOtherQuantitiesAndUnits) {
  EXPECT_THAT(complaint("a\nb\nVELOCITY TIME HISTORY IN UNITS OF CM/S\nNPTS= 1, DT= .01 SEC\n1\n"),
              AllOf(StartsWith("motion.txt:3: "), HasSubstr("expected an acceleration")));
  const std::string in_gal = "a\nb\nACCELERATION TIME HISTORY IN UNITS OF CM/S/S\nNPTS= 1, DT= .01 SEC\n1\n";
  EXPECT_THAT(complaint(in_gal), AllOf(StartsWith("motion.txt:3: "), HasSubstr("'CM/S/S', expected G")));
  EXPECT_EQ(complaint(in_gal, {.scale = 1.0, .unit = AccelerationUnit::cm_per_s2, .dt_s = {}}), "");
}

TEST(Columns, ReadTwoWithAHeaderOfNames) {
  const GroundMotion motion = parse("time_s,ground_acceleration_m_per_s2\n0,1\n0.02,2\n0.04,-3\n");
  EXPECT_DOUBLE_EQ(motion.dt_s, 0.02);
  EXPECT_EQ(motion.acceleration_m_per_s2, (std::vector<double>{1.0, 2.0, -3.0}));
  EXPECT_DOUBLE_EQ(parse("time_s,acceleration_g\n0,1\n1,2\n").acceleration_m_per_s2[1], 2.0 * kG);
  EXPECT_DOUBLE_EQ(parse("time_s a_cm_per_s2\n0 1\n1 2\n").acceleration_m_per_s2[1], 0.02);
}

TEST(Columns, ReadTwoWithBlanksCommentsAndWithoutAHeader) {
  const GroundMotion motion =
      parse("# recorded somewhere\n\n 0.00 \t 0.1\r\n 0.01,0.2 # strong\r\n\n0.02 , 0.3", in_g());
  EXPECT_DOUBLE_EQ(motion.dt_s, 0.01);
  EXPECT_EQ(motion.start_s, 0.0);
  ASSERT_EQ(motion.acceleration_m_per_s2.size(), 3U);
  EXPECT_DOUBLE_EQ(motion.acceleration_m_per_s2[2], 0.3 * kG);
}

TEST(Columns, KeepLateStart) {
  const GroundMotion motion = parse("0.02 1\n0.04 2\n0.06 3", in_g());
  EXPECT_EQ(motion.start_s, 0.02);
  EXPECT_DOUBLE_EQ(motion.at(0.03), 1.5 * kG);
  EXPECT_THAT(complaint("-0.02 1\n0 2", in_g()), AllOf(StartsWith("motion.txt:1: "), HasSubstr("first time")));
}

TEST(Columns, ComputeStepOfRoundedTimesFromWholeRecord) {
  std::string text;
  char line[64];
  for (int i = 0; i < 2000; ++i) {
    std::snprintf(line, sizeof line, "%.6f 1\n", i / 1024.0);
    text += line;
  }
  EXPECT_NEAR(parse(text, in_g()).dt_s, 1.0 / 1024.0, 1e-9);
}

TEST(Columns, RejectUnevenSpacingAtItsLine) {
  EXPECT_THAT(complaint("0 1\n0.01 2\n0.02 3\n0.04 4\n0.05 5", in_g()),
              AllOf(StartsWith("motion.txt:4: "), HasSubstr("equally spaced")));
  EXPECT_THAT(complaint("0 1\n0.01 2\n0.01 3\n", in_g()), StartsWith("motion.txt:3: "));
  EXPECT_THAT(complaint("0 1\n-0.01 2\n", in_g()), AllOf(StartsWith("motion.txt:2: "), HasSubstr("increasing")));
  EXPECT_THAT(complaint("0 1\n", in_g()), HasSubstr("at least two"));
}

TEST(Columns, ReadOneWithTheStepGiven) {
  const GroundMotion motion = parse("acceleration_m_per_s2\n1\n2\n3", {.scale = 2.0, .unit = {}, .dt_s = 0.005});
  EXPECT_EQ(motion.dt_s, 0.005);
  EXPECT_EQ(motion.acceleration_m_per_s2, (std::vector<double>{2.0, 4.0, 6.0}));
  EXPECT_THAT(complaint("1\n2\n3", in_g()), AllOf(StartsWith("motion.txt:1: "), HasSubstr("give its step")));
}

TEST(Columns, RejectUnknownUnit) {
  EXPECT_THAT(complaint("0 1\n1 2"), HasSubstr("unit of the acceleration is unknown"));
  EXPECT_THAT(complaint("time_s,acceleration\n0,1\n1,2"), StartsWith("motion.txt:1: the unit"));
  EXPECT_THAT(complaint("time_s,a_m_per_s2\n0,1\n1,2", in_g()), HasSubstr("another unit"));
  EXPECT_THAT(complaint("milliseconds,a_g\n0,1\n1,2"), HasSubstr("expected 'time_s'"));
}

TEST(Columns, RejectTextAndOtherColumnCounts) {
  EXPECT_EQ(complaint("0 1\n1 x\n", in_g()), "motion.txt:2: found 'x', expected a number");
  EXPECT_THAT(complaint("0 1\n1 2 3\n", in_g()), StartsWith("motion.txt:2: found 3 columns, expected 2"));
  EXPECT_THAT(complaint("0 1 2\n", in_g()), HasSubstr("one (acceleration) or two"));
  EXPECT_THAT(complaint("0,,1\n", in_g()), StartsWith("motion.txt:1: "));
  EXPECT_THAT(complaint("0,\n", in_g()), StartsWith("motion.txt:1: "));
  EXPECT_THAT(complaint("# nothing\n", in_g()), HasSubstr("holds no values"));
}

TEST(GroundMotionFile, RejectsEmptyFilesAndOptionsOutOfRange) {
  for (const char* text : {"", "\n\r\n", "  \t\n", "\xEF\xBB\xBF"}) {
    EXPECT_THAT(complaint(text), StartsWith("motion.txt:1: the file is empty, expected"));
  }
  EXPECT_THAT(complaint("0 1\n1 2", {.scale = std::numeric_limits<double>::infinity(), .unit = {}, .dt_s = {}}),
              HasSubstr("scale"));
  EXPECT_THAT(complaint("1\n", {.scale = 1.0, .unit = AccelerationUnit::g, .dt_s = 0.0}), HasSubstr("not positive"));
  EXPECT_THAT(complaint(at2("NPTS= 1, DT= .01 SEC", "1"), {.scale = 1.0, .unit = {}, .dt_s = 0.02}),
              HasSubstr("the step given for the file is 0.02 s"));
  EXPECT_THAT(complaint("0 1e300\n1 2", {.scale = 1e300, .unit = AccelerationUnit::g, .dt_s = {}}),
              HasSubstr("above 1e6 m/s2"));
}

TEST(GroundMotionFile, ReportsFileThatCannotBeRead) {
  try {
    static_cast<void>(read_ground_motion("no_such_folder/motion.AT2"));
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("no_such_folder/motion.AT2"),
                                    HasSubstr("cannot be read: no such file; expected a ground motion")));
  }
  EXPECT_THROW(static_cast<void>(read_ground_motion(std::filesystem::temp_directory_path())), ConfigError);
}

struct Recorded {
  const char* file;
  std::size_t points;
  double dt_s;
  double peak_m_per_s2;  // found in the file with another program
};

void PrintTo(const Recorded& recorded, std::ostream* stream) { *stream << recorded.file; }

class RecordedMotion : public ::testing::TestWithParam<Recorded> {};

TEST_P(RecordedMotion, IsReadWhole) {
  const auto file = shared_data("ground_motions") / GetParam().file;
  HYBRIDTEST_NEEDS_DATA(file);
  const GroundMotion motion = read_ground_motion(file);
  EXPECT_EQ(motion.acceleration_m_per_s2.size(), GetParam().points);
  EXPECT_NEAR(motion.dt_s, GetParam().dt_s, 1e-12);
  EXPECT_EQ(motion.start_s, 0.0);
  EXPECT_NEAR(motion.peak_m_per_s2(), GetParam().peak_m_per_s2, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(All, RecordedMotion,
                         ::testing::Values(Recorded{"elcentro_1940_ns.AT2", 1559, 0.02, 0.31882 * kG},
                                           Recorded{"northridge_1994_arleta_360.AT2", 2000, 0.02, 0.3080574 * kG},
                                           Recorded{"chichi_1999_kau054_n.AT2", 18000, 0.005, 0.08031736 * kG},
                                           Recorded{"A-LVL090.AT2", 4396, 0.005, 0.07425657 * kG},
                                           Recorded{"rths_benchmark_elcentro.csv", 2060, 0.02, 3.134930197},
                                           Recorded{"rths_benchmark_kobe.csv", 5095, 0.01, 6.329845419},
                                           Recorded{"rths_benchmark_morgan.csv", 7995, 0.005, 2.38917149}));

}  // namespace
}  // namespace hybridtest
