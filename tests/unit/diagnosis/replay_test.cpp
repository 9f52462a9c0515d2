#include "diagnosis/replay.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "diagnosis/intake/intake.hpp"
#include "mechanics/laws/elastic.hpp"
#include "plant/transfer_systems/delay.hpp"
#include "tests/unit/diagnosis/made_signals.hpp"

namespace hybridtest {
namespace {

constexpr std::size_t kSamples = 8000;
constexpr std::size_t kDelay = 12;  // samples
constexpr double kStiffness_n_per_m = 3e5;

/// An actuator that is 12 ms late under a spring, recorded without noise.
Recording recording() {
  Recording made;
  made.file = "made";
  made.sample_period_s = kMadePeriod_s;
  made.samples = kSamples;
  made.dofs.resize(1);
  DofRecording& dof = made.dofs[0];
  dof.of(Channel::command_displacement) = sampled(kSamples, [](double t) { return 0.01 * sine(1.0, t); });
  dof.of(Channel::measured_displacement).resize(kSamples);
  dof.of(Channel::measured_force).resize(kSamples);
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double measured_m = i < kDelay ? 0.0 : dof.of(Channel::command_displacement)[i - kDelay];
    dof.of(Channel::measured_displacement)[i] = measured_m;
    dof.of(Channel::measured_force)[i] = kStiffness_n_per_m * measured_m;
  }
  return made;
}

SiteModel model(double delay_s, double stiffness_n_per_m) {
  SiteModel site;
  site.make_transfer_system = [delay_s](double period_s, double) {
    return std::make_unique<Delay>(from_seconds(delay_s), from_seconds(period_s));
  };
  site.make_law = [stiffness_n_per_m] { return std::make_unique<Elastic>(stiffness_n_per_m); };
  return site;
}

TEST(Replay, TrueModelHasNoGap) {
  const auto channels = replay(model(0.012, kStiffness_n_per_m), recording(), 0);
  ASSERT_EQ(channels.size(), 2U);
  EXPECT_EQ(channels[0].interface, "transfer_system");
  EXPECT_EQ(channels[0].to, Channel::measured_displacement);
  EXPECT_LT(channels[0].nrmse, 1e-12);
  EXPECT_EQ(channels[1].interface, "specimen");
  // The measured displacement is smoothed before it drives the specimen; its kink at 12 ms is rounded off.
  EXPECT_LT(channels[1].nrmse, 2e-3);
}

TEST(Replay, GapIsLimitedToItsOwnStage) {
  const auto late = replay(model(0.0, kStiffness_n_per_m), recording(), 0);
  // Two sines 12 ms apart: 2 sin(w tau / 2), but for the first 12 ms.
  EXPECT_NEAR(late[0].nrmse, 2.0 * std::sin(std::numbers::pi * 0.012), 1e-3);
  EXPECT_LT(late[1].nrmse, 2e-3) << "driven with the measured displacement: the delay does not reach it";
  EXPECT_GT(late[0].share, 0.99);
  const auto soft = replay(model(0.012, 0.9 * kStiffness_n_per_m), recording(), 0);
  EXPECT_LT(soft[0].nrmse, 1e-12);
  EXPECT_NEAR(soft[1].nrmse, 0.1, 1e-3);
  EXPECT_GT(soft[1].share, 0.99);
}

TEST(Replay, ModelWithoutForceDoesNotJudgeSpecimen) {
  SiteModel site = model(0.012, kStiffness_n_per_m);
  site.make_law = {};
  const auto channels = replay(site, recording(), 0);
  ASSERT_EQ(channels.size(), 1U);
  EXPECT_EQ(channels[0].interface, "transfer_system");
}

TEST(ReplayCsv, HoldsRecordingAndPredictions) {
  const Recording made = recording();
  const auto channels = replay(model(0.0, kStiffness_n_per_m), made, 0);
  const std::string csv = replay_csv(made, {channels});
  EXPECT_THAT(csv, testing::StartsWith("time_s,command_displacement_m,measured_displacement_m,measured_force_n,"
                                       "predicted_measured_displacement_m,predicted_measured_force_n\n"));
  const Intake again = read_csv_recording(csv, "again");
  ASSERT_TRUE(again.recording.has_value());
  EXPECT_EQ(again.recording->dofs[0].samples, made.dofs[0].samples);
  EXPECT_EQ(again.recording->samples, kSamples);
}

}  // namespace
}  // namespace hybridtest
