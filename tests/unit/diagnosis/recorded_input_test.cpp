// Inputs that are recorded beside the motion: the current of a damper, a temperature.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "core/random.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/identification/segment.hpp"
#include "diagnosis/page/diagnosis_json.hpp"
#include "diagnosis/page/wording.hpp"
#include "diagnosis/replay.hpp"
#include "mechanics/laws/presliding_element.hpp"
#include "tests/unit/diagnosis/answers.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

namespace hybridtest {
namespace {

using report::Verdict;
using testing::HasSubstr;

constexpr double kPresliding_m = 1e-4;

/// From 0.5 A to 1.5 A and back, not in step with the motion.
double current_a(double time_s) { return 1.0 - 0.5 * std::cos(2.0 * std::numbers::pi * time_s / 5.3); }

/// A current that is switched at random, by the seed.
std::vector<double> switched(std::uint64_t seed, std::size_t samples) {
  Random random{seed};
  std::vector<double> values;
  double value = random.uniform();
  for (std::size_t i = 0; i < samples; ++i) {
    if (random.uniform() < 0.004) value = random.uniform();
    values.push_back(value);
  }
  return values;
}

std::vector<double> sampled(double (*input)(double), std::size_t samples) {
  std::vector<double> values;
  for (std::size_t i = 0; i < samples; ++i) values.push_back(input(kSitePeriod_s * static_cast<double>(i)));
  return values;
}

/// A spring, and beside it `beside(time, sliding share, current)`.
Recording recording_of(const std::function<double(double, double, double)>& beside, std::uint64_t seed = 3) {
  PreslidingElement element{kPresliding_m};
  Recording recording = made_recording(
      made_motion_m,
      [&](double t) {
        return kMadeStiffness_n_per_m * made_motion_m(t) + beside(t, element.share(made_motion_m(t)), current_a(t));
      },
      20.0, seed);
  recording.inputs = {{"current_a", sampled(current_a, recording.samples)}};
  return recording;
}

SiteModel model_with_friction(double friction_force_n) {
  SiteModel model = made_model();
  model.effects = {
      {find_effect(EffectInterface::specimen, "coulomb_friction"), {friction_force_n, 0.0, kPresliding_m, 0.0}}};
  return model;
}

const report::RankedCause& cause_named(const Diagnosis& diagnosis, std::string_view effect) {
  const auto& ranking = diagnosis.report.ranking;
  const auto found = std::ranges::find(ranking, effect, &report::RankedCause::effect);
  if (found == ranking.end()) throw std::runtime_error{"not ranked: " + std::string{effect}};
  return *found;
}

void expect_number(const report::RankedCause& cause, double value, double within) {
  const report::ReportedParameter& slope = cause.parameters.front();
  EXPECT_NEAR(slope.value, value, within * std::abs(value)) << slope.name;
  ASSERT_TRUE(slope.ci95.has_value());
  EXPECT_LT(slope.ci95->low, value);
  EXPECT_GT(slope.ci95->high, value);
}

TEST(RecordedInput, FrictionThatGrowsWithCurrentIsNamed) {
  const Recording recording = recording_of([](double, double z, double u) { return (2000.0 + 4000.0 * u) * z; });
  const Diagnosis diagnosis = diagnose(model_with_friction(4000.0), {&recording, 1}, {});
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named) << report::verdict_sentence(diagnosis.report);
  EXPECT_EQ(causes_of(diagnosis), std::vector<std::string>{"friction_with_input:current_a"});
  expect_number(cause_named(diagnosis, "friction_with_input"), 4000.0, 0.02);
  EXPECT_THAT(report::verdict_sentence(diagnosis.report), HasSubstr("the friction force grows by"));
  EXPECT_THAT(report::verdict_sentence(diagnosis.report), HasSubstr("per unit of current_a"));
  EXPECT_THAT(diagnosis_json(diagnosis), HasSubstr("\"input\": \"current_a\""));
}

TEST(RecordedInput, FrictionThatTheModelLacksIsTwoCauses) {
  const Recording recording = recording_of([](double, double z, double u) { return (2000.0 + 4000.0 * u) * z; });
  const Diagnosis diagnosis = diagnose(made_model(), {&recording, 1}, {});
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named) << report::verdict_sentence(diagnosis.report);
  EXPECT_EQ(causes_of(diagnosis), (std::vector<std::string>{"coulomb_friction", "friction_with_input:current_a"}));
  expect_number(cause_named(diagnosis, "friction_with_input"), 4000.0, 0.03);
  expect_number(cause_named(diagnosis, "coulomb_friction"), 4000.0, 0.03);
}

TEST(RecordedInput, DampingThatGrowsWithCurrentIsNamed) {
  const Recording recording =
      recording_of([](double t, double, double u) { return 4.0e4 * (u - 0.5) * made_velocity_m_per_s(t); });
  const Diagnosis diagnosis = diagnose(made_model(), {&recording, 1}, {});
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named) << report::verdict_sentence(diagnosis.report);
  EXPECT_EQ(causes_of(diagnosis), std::vector<std::string>{"damping_with_input:current_a"});
  expect_number(cause_named(diagnosis, "damping_with_input"), 4.0e4, 0.03);
}

TEST(RecordedInput, ForceThatFallsWithTemperatureIsNamed) {
  Recording recording = recording_of(
      [](double t, double, double u) { return -0.2 * (u - 0.5) * kMadeStiffness_n_per_m * made_motion_m(t); });
  recording.inputs.front().name = "temperature_c";
  const Diagnosis diagnosis = diagnose(made_model(), {&recording, 1}, {});
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named) << report::verdict_sentence(diagnosis.report);
  EXPECT_EQ(causes_of(diagnosis), std::vector<std::string>{"force_with_input:temperature_c"});
  expect_number(cause_named(diagnosis, "force_with_input"), -0.2, 0.02);
  EXPECT_THAT(report::verdict_sentence(diagnosis.report), HasSubstr("the force falls by 20"));
}

/// The model that is completed has the input where the recordings begin as reference, and its mean for a rig without
/// it.
TEST(RecordedInput, CauseSaysWhereItIsAbsentAndWhatARigTakes) {
  const Recording recording = recording_of([](double, double z, double u) { return (2000.0 + 4000.0 * u) * z; });
  const Diagnosis diagnosis = diagnose(model_with_friction(4000.0), {&recording, 1}, {});
  ASSERT_EQ(diagnosis.causes.size(), 1U);
  const EffectSetting& cause = diagnosis.causes.front();
  EXPECT_EQ(cause.type, &with_input(*find_effect(EffectInterface::specimen, "friction_with_input"), "current_a"));
  EXPECT_EQ(cause.values[2], 0.5);
  EXPECT_NEAR(cause.values[3], 1.0, 0.15);
  SiteModel completed = model_with_friction(4000.0);
  add_effect(completed, cause);
  const std::vector<ReplayedChannel> replayed = replay(completed, recording, 0);
  EXPECT_LT(replayed.back().nrmse, 0.002);
}

class UnrelatedInput : public testing::TestWithParam<std::uint64_t> {};

/// The control: inputs that have nothing to do with the force are never named, and change no answer.
TEST_P(UnrelatedInput, IsNotNamedAndChangesNothing) {
  Recording without = recording_of([](double, double z, double) { return 3000.0 * z; }, GetParam());
  without.inputs.clear();
  Recording with = without;
  with.inputs = {{"current_a", switched(GetParam(), with.samples)}, {"temperature_c", {}}};
  for (std::size_t i = 0; i < with.samples; ++i) {
    with.inputs[1].samples.push_back(20.0 + 1e-3 * static_cast<double>(i));  // warms up
  }
  const Diagnosis expected = diagnose(made_model(), {&without, 1}, {});
  const Diagnosis diagnosis = diagnose(made_model(), {&with, 1}, {});
  EXPECT_EQ(causes_of(diagnosis), causes_of(expected));
  EXPECT_EQ(diagnosis.report.verdict, expected.report.verdict);
}

INSTANTIATE_TEST_SUITE_P(Drawn, UnrelatedInput, testing::Range<std::uint64_t>(1, 9));

TEST(RecordedInput, NothingIsNamedWhereTheModelIsRight) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Recording recording = recording_of([](double, double, double) { return 0.0; }, seed);
    recording.inputs.push_back({"temperature_c", switched(seed, recording.samples)});
    EXPECT_EQ(diagnose(made_model(), {&recording, 1}, {}).report.verdict, Verdict::none) << "seed " << seed;
  }
}

/// A test with two inputs, of which one acts.
TEST(RecordedInput, TheRightOneOfTwoInputsIsNamed) {
  Recording recording =
      recording_of([](double t, double, double u) { return 4.0e4 * (u - 0.5) * made_velocity_m_per_s(t); });
  recording.inputs.push_back({"temperature_c", switched(7, recording.samples)});
  const Diagnosis diagnosis = diagnose(made_model(), {&recording, 1}, {});
  EXPECT_EQ(causes_of(diagnosis), std::vector<std::string>{"damping_with_input:current_a"});
}

TEST(RecordedInput, ConstantOneIsNotSearchedAndANoteSaysSo) {
  Recording recording = recording_of([](double t, double, double) { return 3.0e4 * made_velocity_m_per_s(t); });
  recording.inputs.front().samples.assign(recording.samples, 2.0);
  recording.inputs.front().samples.front() = 0.0;  // switched on with the recording
  const Diagnosis diagnosis = diagnose(made_model(), {&recording, 1}, {});
  EXPECT_EQ(causes_of(diagnosis), std::vector<std::string>{"viscous_damping"});
  EXPECT_THAT(diagnosis.report.notes, testing::Contains(HasSubstr("input_current_a hardly changes")));
}

TEST(RecordedInput, TwoTestsAtConstantCurrentsShowWhatItDoes) {
  std::vector<Recording> recordings;
  for (const double current : {0.0, 1.0}) {
    recordings.push_back(
        recording_of([current](double t, double, double) { return 3.0e4 * current * made_velocity_m_per_s(t); }));
    recordings.back().file = fmt::format("{}A.csv", current);
    recordings.back().inputs.front().samples.assign(recordings.back().samples, current);
  }
  const Diagnosis diagnosis = diagnose(made_model(), recordings, {});
  EXPECT_EQ(causes_of(diagnosis), std::vector<std::string>{"damping_with_input:current_a"});
  expect_number(cause_named(diagnosis, "damping_with_input"), 3.0e4, 0.03);
}

/// A magnetorheological damper without and with current: in the first test neither effect acts, which does not speak
/// against the second one.
TEST(RecordedInput, DamperWithAndWithoutCurrentHasBothCauses) {
  std::vector<Recording> recordings;
  for (const double current : {0.0, 1.0}) {
    recordings.push_back(recording_of([current](double t, double z, double) {
      return (500.0 + 3000.0 * current) * z + 2.0e4 * current * made_velocity_m_per_s(t);
    }));
    recordings.back().file = fmt::format("{}A.csv", current);
    recordings.back().inputs.front().samples.assign(recordings.back().samples, current);
  }
  const Diagnosis diagnosis = diagnose(model_with_friction(500.0), recordings, {});
  EXPECT_EQ(causes_of(diagnosis),
            (std::vector<std::string>{"damping_with_input:current_a", "friction_with_input:current_a"}));
  expect_number(cause_named(diagnosis, "friction_with_input"), 3000.0, 0.03);
  expect_number(cause_named(diagnosis, "damping_with_input"), 2.0e4, 0.03);
}

TEST(RecordedInput, HeldOutRecordingWithoutItIsNoted) {
  const auto growing = [](double, double z, double u) { return (2000.0 + 4000.0 * u) * z; };
  std::vector<Recording> recordings{recording_of(growing), recording_of(growing, 4)};
  recordings[1].role = RecordingRole::held_out;
  recordings[1].file = "other.csv";
  recordings[1].inputs.clear();
  const Diagnosis diagnosis = diagnose(model_with_friction(4000.0), recordings, {});
  EXPECT_EQ(causes_of(diagnosis), std::vector<std::string>{"friction_with_input:current_a"});
  EXPECT_THAT(diagnosis.report.notes, testing::Contains(HasSubstr("Without the column input_current_a: other.csv")));
}

TEST(RecordedInput, QuasiStaticFrictionThatGrowsWithTensionIsNamed) {
  const auto slow = [](const Recording& timed) {
    Recording recording = timed;
    recording.is_quasi_static = true;
    recording.dofs[0].of(Channel::command_displacement).clear();
    const auto thin = [](std::vector<double>& values) {
      std::vector<double> kept;
      for (std::size_t i = 0; i < values.size(); i += 5) kept.push_back(values[i]);
      values = kept;
    };
    for (std::vector<double>& samples : recording.dofs[0].samples) thin(samples);
    thin(recording.inputs.front().samples);
    recording.samples = recording.inputs.front().samples.size();
    recording.sample_period_s *= 5.0;
    return recording;
  };
  const Recording recording = slow(recording_of([](double, double z, double u) { return (2000.0 + 4000.0 * u) * z; }));
  const Diagnosis diagnosis = diagnose(model_with_friction(4000.0), {&recording, 1}, {});
  EXPECT_EQ(causes_of(diagnosis), std::vector<std::string>{"friction_with_input:current_a"});
  expect_number(cause_named(diagnosis, "friction_with_input"), 4000.0, 0.03);
}

Segment force_segment(const Recording& recording) { return segments_of(recording, 0, 0).back(); }

TEST(RecordedInput, GoesAlongWithThinnedAndSmoothedSegments) {
  Recording recording = recording_of([](double, double, double) { return 0.0; });
  recording.inputs.push_back({"temperature_c", std::vector<double>(recording.samples, 20.0)});
  const Segment segment = force_segment(recording);
  ASSERT_EQ(segment.inputs.names, (std::vector<std::string>{"current_a", "temperature_c"}));
  const Segment thin = thinned(segment, 100.0);
  ASSERT_EQ(thin.input.size(), 1200U);
  for (std::size_t i = 0; i < thin.input.size(); ++i) {
    EXPECT_EQ(thin.inputs.at(i)[0], recording.inputs[0].samples[5 * i]);
    EXPECT_EQ(thin.inputs.at(i)[1], 20.0);
  }
  const Segment smooth = smoothed_alike(segment, recording.dofs[0], 5.0);
  for (std::size_t i = smooth.unjudged; i + smooth.unjudged < smooth.input.size(); ++i) {
    ASSERT_NEAR(smooth.inputs.at(i)[0], recording.inputs[0].samples[i], 1e-4);
    ASSERT_NEAR(smooth.inputs.at(i)[1], 20.0, 1e-9);
  }
}

TEST(RecordedInput, EffectTouchesOnlySegmentsWithItsInput) {
  const Recording recording = recording_of([](double, double, double) { return 0.0; });
  const EffectType& force = *find_effect(EffectInterface::specimen, "force_with_input");
  EXPECT_TRUE(force_segment(recording).touched_by(with_input(force, "current_a")));
  EXPECT_FALSE(force_segment(recording).touched_by(with_input(force, "temperature_c")));
}

TEST(RecordedInput, IsAColumnOfTheReplayedFile) {
  const Recording recording = recording_of([](double, double, double) { return 0.0; });
  const std::string text = replay_csv(recording, {replay(made_model(), recording, 0)});
  EXPECT_THAT(text.substr(0, text.find('\n')), HasSubstr(",measured_force_n,input_current_a,predicted_"));
}

}  // namespace
}  // namespace hybridtest
