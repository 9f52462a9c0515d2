#include "diagnosis/intake/units.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "diagnosis/intake/intake.hpp"
#include "plant/transfer_systems/delay.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

namespace hybridtest {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kStandardGravity_m_per_s2 = 9.80665;

double made_acceleration_m_per_s2(double time_s) {
  constexpr double kHalf_s = 1e-3;
  return (made_motion_m(time_s + kHalf_s) - 2.0 * made_motion_m(time_s) + made_motion_m(time_s - kHalf_s)) /
         (kHalf_s * kHalf_s);
}

/// Displacement and acceleration, the latter in a unit of its own, time in one of its own.
RawRecording raw_recording(double acceleration_unit_m_per_s2, double time_unit_s = 1.0) {
  RawRecording raw;
  raw.file = "made.csv";
  raw.first_row = 2;
  raw.columns = {{"measured_displacement_m", Channel::measured_displacement, 0, {}},
                 {"measured_acceleration_m_per_s2", Channel::measured_acceleration, 0, {}}};
  Random random{9};
  for (int i = 0; i < 4000; ++i) {
    const double time_s = kSitePeriod_s * i;
    raw.time_s.push_back(time_s / time_unit_s);
    raw.columns[0].values.push_back(made_motion_m(time_s) + 1e-6 * random.normal());
    raw.columns[1].values.push_back((made_acceleration_m_per_s2(time_s) + 0.02 * random.normal()) /
                                    acceleration_unit_m_per_s2);
  }
  return raw;
}

std::vector<std::string> complaints_of(const RawRecording& raw) {
  std::vector<std::string> texts;
  for (const IntakeFinding& finding : check_recording(raw).findings) texts.push_back(finding.text(raw.file));
  return texts;
}

TEST(AccelerationUnits, AreCheckedAgainstTheDisplacement) {
  EXPECT_THAT(complaints_of(raw_recording(1.0)), IsEmpty());
  EXPECT_THAT(complaints_of(raw_recording(kStandardGravity_m_per_s2)), ElementsAre(HasSubstr("seems to be in g: ")));
  EXPECT_THAT(complaints_of(raw_recording(1e-3)), ElementsAre(HasSubstr("seems to be in mm/s2: ")));
  EXPECT_THAT(complaints_of(raw_recording(1e-2)), ElementsAre(HasSubstr("seems to be in cm/s2: ")));
}

TEST(AccelerationUnits, FindingNamesRowOfLargestValue) {
  const RawRecording raw = raw_recording(kStandardGravity_m_per_s2);
  const auto findings = check_recording(raw).findings;
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].column, "measured_acceleration_m_per_s2");
  double largest = 0.0;
  for (const double value : raw.columns[1].values) largest = std::max(largest, std::abs(value));
  EXPECT_EQ(std::abs(raw.columns[1].values[findings[0].row - 2]), largest);
}

TEST(AccelerationUnits, DetectTimeInMilliseconds) {
  EXPECT_THAT(complaints_of(raw_recording(1.0, 1e-3)),
              ElementsAre(testing::AllOf(HasSubstr("column 'time_s'"), HasSubstr("seems to be in milliseconds"))));
}

TEST(AccelerationUnits, SkippedForSensorAtAnotherPlace) {
  // It does not go with this displacement, whatever its size.
  RawRecording raw = raw_recording(1.0);
  for (std::size_t i = 0; i < raw.columns[1].values.size(); ++i) {
    raw.columns[1].values[i] = 0.1 * std::sin(0.05 * static_cast<double>(i));
  }
  EXPECT_THAT(complaints_of(raw), IsEmpty());
}

/// Command and measured displacement, the latter in a unit of its own.
RawRecording moved(const std::function<double(double)>& measured_m, double unit_m = 1.0) {
  RawRecording raw;
  raw.file = "made.csv";
  raw.first_row = 2;
  raw.columns = {{"command_displacement_m", Channel::command_displacement, 0, {}},
                 {"measured_displacement_m", Channel::measured_displacement, 0, {}}};
  Random random{9};
  for (int i = 0; i < 4000; ++i) {
    const double time_s = kSitePeriod_s * i;
    raw.time_s.push_back(time_s);
    raw.columns[0].values.push_back(made_motion_m(time_s));
    raw.columns[1].values.push_back((measured_m(time_s) + 1e-6 * random.normal()) / unit_m);
  }
  return raw;
}

/// A thousandth of the command, half of it with the command, half of it as it likes.
double stuck_m(double time_s) { return 6e-4 * (made_motion_m(time_s) + made_motion_m(0.55 * time_s)); }

TEST(DisplacementUnits, StuckActuatorIsNotAWrongUnit) {
  const RawRecording raw = moved(stuck_m);
  EXPECT_THAT(complaints_of(raw), IsEmpty());
  // It moves as little as one in metres beside a command in millimetres; only the shape tells.
  const auto span_of = [&](std::size_t column) {
    const auto [low, high] = std::ranges::minmax(raw.columns[column].values);
    return high - low;
  };
  EXPECT_NEAR(span_of(0) / span_of(1), 1000.0, 100.0);
}

TEST(DisplacementUnits, FoundThoughTheActuatorIsLate) {
  // 45 ms: at a correlation below that of a scaled copy where nothing is shifted.
  const auto late_m = [](double time_s) { return 0.9 * made_motion_m(std::max(0.0, time_s - 0.045)); };
  EXPECT_THAT(complaints_of(moved(late_m)), IsEmpty());
  for (const auto& [unit_m, name] : {std::pair{1e-3, "millimetres"}, {1e-2, "centimetres"}, {0.0254, "inches"}}) {
    EXPECT_THAT(complaints_of(moved(late_m, unit_m)), ElementsAre(HasSubstr(std::string{"seems to be in "} + name)));
  }
  // The same from the other side: the command is in millimetres beside what was measured in metres.
  EXPECT_THAT(complaints_of(moved([&](double time_s) { return 1e-3 * late_m(time_s); })),
              ElementsAre(testing::AllOf(HasSubstr("column 'command_displacement_m'"), HasSubstr("in millimetres"))));
}

double spring_n(double time_s) { return kMadeStiffness_n_per_m * made_motion_m(time_s); }

Recording with_force_unit(double newtons, double softer = 1.0) {
  Recording recording = made_recording(made_motion_m, [&](double time_s) { return spring_n(time_s) / softer; });
  for (double& force : recording.dofs[0].of(Channel::measured_force)) force /= newtons;
  recording.first_row = 2;
  return recording;
}

std::vector<std::string> complaints_of(const SiteModel& model, const Recording& recording) {
  std::vector<std::string> texts;
  for (const IntakeFinding& finding : check_units_against(model, recording, 0)) {
    texts.push_back(finding.text(recording.file));
  }
  return texts;
}

TEST(ForceUnits, AreCheckedAgainstTheModel) {
  EXPECT_THAT(complaints_of(made_model(), with_force_unit(1.0)), IsEmpty());
  EXPECT_THAT(complaints_of(made_model(), with_force_unit(1e3)),
              ElementsAre(testing::AllOf(HasSubstr("made.csv:"), HasSubstr("column 'measured_force_n'"),
                                         HasSubstr("seems to be in kilonewtons"))));
  EXPECT_THAT(complaints_of(made_model(), with_force_unit(1e6)), ElementsAre(HasSubstr("in meganewtons")));
  EXPECT_THAT(complaints_of(made_model(), with_force_unit(4448.22)), ElementsAre(HasSubstr("in kips")));
  EXPECT_THAT(complaints_of(made_model(), with_force_unit(9.80665)), ElementsAre(HasSubstr("in kilograms of force")));
  EXPECT_THAT(complaints_of(made_model(), with_force_unit(4.44822)), ElementsAre(HasSubstr("in pounds of force")));
}

TEST(ForceUnits, DetectsKilonewtonsBesideWrongStiffness) {
  EXPECT_THAT(complaints_of(made_model(), with_force_unit(1e3, 2.0)), ElementsAre(HasSubstr("in kilonewtons")));
  EXPECT_THAT(complaints_of(made_model(), with_force_unit(1e3, 0.5)), ElementsAre(HasSubstr("in kilonewtons")));
}

TEST(ForceUnits, DetectsKilonewtonsBesideMissingFriction) {
  // Most of what this specimen does: its force goes with the model's at a correlation of about a half.
  Recording recording = made_recording(made_motion_m, [](double time_s) {
    const double forward = made_motion_m(time_s + 1e-3) > made_motion_m(time_s - 1e-3) ? 1.0 : -1.0;
    return 0.3 * spring_n(time_s) + 1.5e4 * forward;
  });
  EXPECT_THAT(complaints_of(made_model(), recording), IsEmpty());
  for (double& force : recording.dofs[0].of(Channel::measured_force)) force /= 1e3;
  EXPECT_THAT(complaints_of(made_model(), recording), ElementsAre(HasSubstr("in kilonewtons")));
}

TEST(ForceUnits, DisconnectedLoadCellIsNotAWrongUnit) {
  // Noise alone, a thousandth of what the model predicts.
  EXPECT_THAT(complaints_of(made_model(), made_recording(made_motion_m, [](double) { return 0.0; })), IsEmpty());
}

TEST(ForceUnits, WrongStiffnessIsNotAWrongUnit) {
  for (const double softer : {0.1, 0.5, 2.0, 5.0, 9.0, 50.0, 200.0}) {
    EXPECT_THAT(complaints_of(made_model(), with_force_unit(1.0, softer)), IsEmpty()) << softer;
  }
}

/// Late by 20 ms.
SiteModel late_model() {
  SiteModel model = made_model();
  model.make_transfer_system = [](double period_s, double) {
    return std::make_unique<Delay>(from_seconds(0.02), from_seconds(period_s));
  };
  return model;
}

Recording late_recording(double sample_period_s) {
  // Ten samples of 2 ms late, whatever the time stamps say.
  Recording recording = made_recording([](double time_s) { return made_motion_m(std::max(0.0, time_s - 0.02)); },
                                       [](double time_s) { return spring_n(std::max(0.0, time_s - 0.02)); });
  recording.sample_period_s = sample_period_s;
  return recording;
}

TEST(TimeUnits, AreCheckedAgainstModelForCoarseSamples) {
  EXPECT_THAT(complaints_of(late_model(), late_recording(2.0)),
              ElementsAre(testing::AllOf(HasSubstr("column 'time_s': '2'"), HasSubstr("seems to be in milliseconds"))));
  EXPECT_THAT(complaints_of(late_model(), late_recording(2000.0)), ElementsAre(HasSubstr("in microseconds")));
}

TEST(TimeUnits, AreAcceptedWhenTheModelFits) {
  EXPECT_THAT(complaints_of(late_model(), late_recording(0.002)), IsEmpty());
  // A slow test, logged every other second: 20 ms are nothing to it.
  Recording slow = made_recording(made_motion_m, spring_n);
  slow.sample_period_s = 2.0;
  EXPECT_THAT(complaints_of(late_model(), slow), IsEmpty());
}

}  // namespace
}  // namespace hybridtest
