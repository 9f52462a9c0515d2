#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/identification/segment.hpp"
#include "diagnosis/localisation/sensor_checks.hpp"
#include "diagnosis/verdict/where.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

/// What is told of a recording beside its gap.
namespace hybridtest {
namespace {

using testing::HasSubstr;

double spring_n(double time_s) { return kMadeStiffness_n_per_m * made_motion_m(time_s); }

report::InterfaceGap judged(std::string interface) {
  report::InterfaceGap gap;
  gap.interface = std::move(interface);
  gap.is_judged = true;
  return gap;
}

std::string why_not(const SiteModel& model, const Recording& recording, std::string_view interface) {
  std::vector<report::InterfaceGap> where{judged("transfer_system")};
  add_unjudged(model, {&recording, 1}, 0, where);
  EXPECT_EQ(where.size(), 7U) << "every interface of the chain";
  EXPECT_TRUE(where.front().is_judged) << "what is judged stays so";
  return std::ranges::find(where, interface, &report::InterfaceGap::interface)->why_not;
}

TEST(Unjudged, NamesMissingColumns) {
  const Recording recording = made_recording(made_motion_m, spring_n);
  EXPECT_EQ(why_not(made_model(), recording, "network"),
            "sent_displacement_m and target_displacement_m were not recorded");
  EXPECT_EQ(why_not(made_model(), recording, "compensator"), "target_displacement_m was not recorded");
  Recording forceless = recording;
  forceless.dofs[0].of(Channel::measured_force).clear();
  EXPECT_EQ(why_not(made_model(), forceless, "specimen"), "measured_force_n was not recorded");
  EXPECT_THAT(why_not(made_model(), recording, "numerical_substructure"), HasSubstr("a run directory"));
}

TEST(Unjudged, ReportsMissingModel) {
  SiteModel actuator = made_model();
  actuator.make_law = nullptr;
  EXPECT_EQ(why_not(actuator, made_recording(made_motion_m, spring_n), "specimen"),
            "the model has no law for the force of the specimen");
}

constexpr double kCycle_hz = 1.0;

/// Twelve cycles of one amplitude, read with noise; the force has in each cycle `wander_n` of its own.
Recording cycles(double wander_n, std::uint64_t seed) {
  const auto motion_m = [](double time_s) { return 0.02 * std::sin(2.0 * std::numbers::pi * kCycle_hz * time_s); };
  Random random{seed};
  std::vector<double> wanders;
  for (int i = 0; i < 13; ++i) wanders.push_back(wander_n * random.normal());
  return made_recording(motion_m, [=](double time_s) {
    return kMadeStiffness_n_per_m * motion_m(time_s) + wanders[static_cast<std::size_t>(time_s * kCycle_hz)];
  });
}

std::vector<report::InterfaceGap> with_repeatability(const std::vector<Recording>& recordings) {
  std::vector<Segment> segments;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    for (const Segment& segment : segments_of(recordings[i], 0, i)) segments.push_back(segment);
  }
  std::vector<report::InterfaceGap> where{judged("transfer_system"), judged("specimen")};
  add_repeatability(made_model(), segments, where);
  return where;
}

TEST(Repeatability, CyclesShowMoreThanNoise) {
  const double output_n = kMadeStiffness_n_per_m * 0.02 / std::sqrt(2.0);
  const report::InterfaceGap steady = with_repeatability({cycles(0.0, 1)})[1];
  ASSERT_TRUE(steady.repeatability.has_value());
  EXPECT_EQ(steady.repeatability->source, "repeated cycles");
  // Noise of 20 N; of the displacement's, 1 um, smoothing leaves a good half, 1 N.
  EXPECT_NEAR(steady.repeatability->nrmse, 20.0 / output_n, 0.05 * 20.0 / output_n);
  const report::InterfaceGap wandering = with_repeatability({cycles(500.0, 1)})[1];
  ASSERT_TRUE(wandering.repeatability.has_value());
  EXPECT_GT(wandering.repeatability->nrmse, 0.5 * 500.0 / output_n) << "eleven draws are seldom half as far apart";
}

TEST(Repeatability, ComparesRecordingsWithTheSameInput) {
  const auto once = with_repeatability({made_recording(made_motion_m, spring_n)});
  EXPECT_FALSE(once[1].repeatability.has_value()) << "this motion has no cycles";
  const auto twice = with_repeatability({made_recording(made_motion_m, spring_n),
                                         made_recording(made_motion_m, [](double t) { return 1.01 * spring_n(t); })});
  ASSERT_TRUE(twice[1].repeatability.has_value());
  EXPECT_EQ(twice[1].repeatability->source, "repeated recordings");
  // A hundredth between the two, over the square root of two for each.
  EXPECT_NEAR(twice[1].repeatability->nrmse, 0.01 / std::sqrt(2.0), 2e-4);
}

TEST(SensorFacts, ReportClippingStepsAndRest) {
  Recording recording = made_recording(
      [](double time_s) { return time_s < 2.0 ? 0.0 : made_motion_m(time_s - 2.0); },
      [](double time_s) { return std::clamp(time_s < 2.0 ? 0.0 : spring_n(time_s - 2.0), -3e4, 3e4) + 150.0; }, 0.0);
  std::vector<double>& command_m = recording.dofs[0].of(Channel::command_displacement);
  for (std::size_t i = command_m.size(); i-- > 1000;) command_m[i] = command_m[i - 1000];
  std::fill(command_m.begin(), command_m.begin() + 1000, 0.0);
  report::DiagnosisReport report;
  add_sensor_facts(recording, 0, report);
  ASSERT_EQ(report.sensors.size(), 2U) << "commands have no sensor";
  const report::SensorFacts& force = report.sensors[1];
  EXPECT_EQ(force.column, "measured_force_n");
  EXPECT_GT(force.clipped_share, 0.05);
  EXPECT_EQ(report.sensors[0].clipped_share, 0.0);
  ASSERT_TRUE(force.at_rest.has_value());
  EXPECT_NEAR(force.at_rest->first, 150.0, 1e-9);
}

TEST(SensorFacts, ReportLateLoadCell) {
  for (const double late_s : {0.0, 0.01}) {
    report::DiagnosisReport report;
    add_sensor_facts(made_recording(made_motion_m, [&](double t) { return spring_n(std::max(0.0, t - late_s)); }), 0,
                     report);
    ASSERT_TRUE(report.sensors[1].lag_s.has_value());
    // The noise of both, in differences from sample to sample, makes the top of the correlation flat.
    EXPECT_NEAR(*report.sensors[1].lag_s, late_s, kSitePeriod_s);
    EXPECT_FALSE(report.sensors[0].lag_s.has_value());
  }
}

}  // namespace
}  // namespace hybridtest
