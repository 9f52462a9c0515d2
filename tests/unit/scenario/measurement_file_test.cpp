#include "scenario/measurement_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "core/config_error.hpp"
#include "tests/unit/recording/temporary_directory.hpp"

namespace hybridtest {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

class MeasurementFile : public testing::Test {
 protected:
  [[nodiscard]] RecordedMeasurement read(const std::string& text, int actuators = 1) const {
    std::ofstream{directory_ / "measured.csv"} << text;
    return read_measurement(directory_ / "measured.csv", actuators);
  }
  void expect_refused(const std::string& text, const char* where, const char* why) const {
    EXPECT_THAT([&] { static_cast<void>(read(text)); },
                ThrowsMessage<ConfigError>(AllOf(HasSubstr(std::string{"measured.csv"} + where), HasSubstr(why))));
  }

 private:
  TemporaryDirectory directory_;
};

const std::string kHeader = "sample,time_s,measured_force_n,measured_displacement_m\n";

TEST_F(MeasurementFile, ReadsColumnsByNameAndIgnoresOthers) {
  const RecordedMeasurement record = read(kHeader + "0,0.5,100,1e-3\r\n1,0.75,-2.5e3,0.25\n");
  EXPECT_THAT(record.time_s, ElementsAre(0.5, 0.75));
  EXPECT_EQ(record.displacement_m[1], (SiteVector{{0.25}}));
  EXPECT_EQ(record.force_n[0], (SiteVector{{100.0}}));
}

TEST_F(MeasurementFile, NumbersTheColumnsOfSeveralActuators) {
  const RecordedMeasurement record = read(
      "time_s,measured_displacement_m_2,measured_displacement_m_1,measured_force_n_1,measured_force_n_2\n0,2,1,3,4\n",
      2);
  EXPECT_EQ(record.displacement_m[0], (SiteVector{{1.0, 2.0}}));
  EXPECT_EQ(record.force_n[0], (SiteVector{{3.0, 4.0}}));
}

TEST_F(MeasurementFile, ReportsErrorWithItsPlace) {
  expect_refused("", "", "empty");
  expect_refused(kHeader, "", "no rows");
  expect_refused("time_s,measured_force_n\n0,1\n", "", "no column 'measured_displacement_m'");
  expect_refused("time_s,time_s,measured_force_n,measured_displacement_m\n0,0,1,1\n", "", "twice");
  expect_refused(kHeader + "0,0,1,1\n1,0.1,1\n", ":3", "3 values for 4 columns");
  expect_refused(kHeader + "0,0,1,1\n1,0.1,nan,1\n", ":3", "expected a finite number, found 'nan'");
  expect_refused(kHeader + "0,0,1,1\n1,0.1,12x,1\n", ":3", "'12x'");
  expect_refused(kHeader + "0,0.1,1,1\n1,0.1,1,1\n", ":3", "not later");
}

TEST_F(MeasurementFile, ReportsMissingFile) {
  EXPECT_THAT([&] { static_cast<void>(read_measurement("nowhere/measured.csv", 1)); },
              ThrowsMessage<ConfigError>(HasSubstr("cannot be read")));
}

}  // namespace
}  // namespace hybridtest
