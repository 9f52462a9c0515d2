#include "diagnosis/identification/quasi_static.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/random.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/intake/intake.hpp"
#include "diagnosis/page/diagnosis_json.hpp"
#include "diagnosis/page/diagnosis_page.hpp"
#include "diagnosis/replay.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "mechanics/laws/viscous.hpp"
#include "tests/unit/diagnosis/answers.hpp"
#include "tests/unit/diagnosis/made_noise.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

namespace hybridtest {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double kPeak_m = 0.03;
constexpr std::size_t kPoints = 400;

/// Eight cycles of growing amplitude, a point every few millimetres.
std::vector<double> slow_path() {
  std::vector<double> path_m;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double cycles = 8.0 * static_cast<double>(i) / static_cast<double>(kPoints - 1);
    path_m.push_back(kPeak_m * (0.2 + 0.1 * cycles) * std::asin(std::sin(2.0 * std::numbers::pi * cycles)) / 1.5708);
  }
  return path_m;
}

/// A specimen that yields at 20 kN, with 50 N of noise.
std::vector<double> yielding_n(const std::vector<double>& path_m) {
  Bilinear law{{.stiffness_n_per_m = kMadeStiffness_n_per_m, .yield_force_n = 20e3, .hardening_ratio = 0.03}};
  Random random{5};
  std::vector<double> force_n;
  for (const double place_m : path_m) {
    force_n.push_back(law.trial(place_m, 0.0) + 50.0 * random.normal());
    law.commit();
  }
  return force_n;
}

/// A CSV whose first column is `name` with `value(i)`; no such column without a name.
std::string slow_test(const std::string& name, const std::function<double(std::size_t)>& value) {
  const std::vector<double> path_m = slow_path();
  const std::vector<double> force_n = yielding_n(path_m);
  std::string text = (name.empty() ? "" : name + ",") + "measured_displacement_m,measured_force_n\n";
  for (std::size_t i = 0; i < path_m.size(); ++i) {
    if (!name.empty()) text += fmt::format("{:.6f},", value(i));
    text += fmt::format("{:.9f},{:.4f}\n", path_m[i], force_n[i]);
  }
  return text;
}

double uneven_s(std::size_t i) {
  Random random{17};
  double time_s = 0.0;
  for (std::size_t k = 0; k < i; ++k) time_s += 0.5 + random.uniform();
  return time_s;
}

/// The travelled path as time, as many programs write it.
double path_as_time(std::size_t i) {
  const std::vector<double> path_m = slow_path();
  double time_s = 0.0;
  for (std::size_t k = 1; k <= i; ++k) time_s += 1e3 * std::abs(path_m[k] - path_m[k - 1]);
  return time_s;
}

double even_s(std::size_t i) { return 0.01 * static_cast<double>(i); }

Recording accepted(const std::string& text, TimeBase time = TimeBase::recorded) {
  Intake intake = read_csv_recording(text, "slow.csv", time);
  EXPECT_TRUE(intake.recording.has_value()) << intake.findings.front().text("slow.csv");
  return intake.recording.value();
}

TEST(QuasiStaticRecording, AnswerIsTheSameWithEveryTimeBase) {
  const Recording recording = accepted(slow_test("", nullptr));
  ASSERT_TRUE(recording.is_quasi_static);
  const Diagnosis diagnosis = diagnose(made_model(), {&recording, 1}, {});
  const std::string expected = diagnosis_json(diagnosis);
  for (const Recording& other :
       {accepted(slow_test("step", [](std::size_t i) { return 1.0 + static_cast<double>(i); })),
        accepted(slow_test("time_s", uneven_s)), accepted(slow_test("time_s", path_as_time)),
        accepted(slow_test("time_s", even_s), TimeBase::quasi_static)}) {
    EXPECT_TRUE(other.is_quasi_static);
    EXPECT_EQ(diagnosis_json(diagnose(made_model(), {&other, 1}, {})), expected);
  }
  for (const report::RankedCause& cause : diagnosis.report.ranking) {
    const auto known = std::ranges::find_if(effect_library(), [&](const EffectType& type) {
      return name_of(type.interface) == cause.interface && type.name == cause.effect;
    });
    // A law in place of the specimen's own is not in the library, and follows the displacement alone.
    EXPECT_FALSE(known != effect_library().end() && known->traits.needs_time) << cause.effect;
  }
  EXPECT_THAT(diagnosis.report.notes, testing::Contains(HasSubstr("Path takes the place of time")));
  EXPECT_THAT(expected, HasSubstr("\"quasi_static\": true"));
  const std::string page = report::diagnosis_page(diagnosis.report);
  EXPECT_THAT(page, HasSubstr("cycles over the whole range"));
  EXPECT_THAT(page, Not(HasSubstr("time [s]")));
  EXPECT_THAT(page, Not(HasSubstr("frequency [Hz]")));
}

/// The model is 3 % too stiff and its strength 2 % too small, and the load cell has a zero of 1.3 % of the largest
/// force that drifts by half of that: none of them by itself explains most of the gap.
TEST(QuasiStaticRecording, WrongNumbersBesideAZeroThatDriftsAreCorrected) {
  constexpr double kReached_m = 0.0125;
  constexpr double kStrength_n = 0.4 * kMadeStiffness_n_per_m * kReached_m;
  Recording recording = accepted(slow_test("", nullptr));
  std::vector<double>& place_m = recording.dofs[0].of(Channel::measured_displacement);
  std::vector<double>& force_n = recording.dofs[0].of(Channel::measured_force);
  recording.samples = 1440;
  place_m.clear();
  force_n.clear();
  Bilinear specimen{
      {.stiffness_n_per_m = kMadeStiffness_n_per_m, .yield_force_n = kStrength_n, .hardening_ratio = 0.022}};
  Random random{5};
  // Five cycles, each larger than the one before by as much as the first is.
  for (std::size_t cycle = 1; cycle <= 5; ++cycle) {
    const std::size_t points = 96 * cycle;
    for (std::size_t i = 1; i <= points; ++i) {
      const double turned = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(points);
      place_m.push_back(kReached_m * 0.2 * static_cast<double>(cycle) * std::asin(std::sin(turned)) / 1.5708);
      force_n.push_back(specimen.trial(place_m.back(), 0.0) + 30.0 * random.normal() + 135.0 +
                        0.05 * static_cast<double>(place_m.size()));
      specimen.commit();
    }
  }
  SiteModel model = made_model();
  model.make_law = [] {
    return std::make_unique<Bilinear>(Bilinear::Parameters{.stiffness_n_per_m = 1.03 * kMadeStiffness_n_per_m,
                                                           .yield_force_n = 0.98 * kStrength_n,
                                                           .hardening_ratio = 0.0215});
  };
  const Diagnosis diagnosis = diagnose(model, {&recording, 1}, {});
  EXPECT_EQ(diagnosis.report.verdict, report::Verdict::named);
  EXPECT_THAT(causes_of(diagnosis), testing::ElementsAre("bias"));
  // In the middle of the recording, to half of what it drifts.
  EXPECT_NEAR(diagnosis.report.ranking.front().parameters.front().value, 171.0, 36.0);
}

/// Readings that follow each other share most of their noise, of both sensors.
TEST(QuasiStaticRecording, RightLawIsNoneBesideSlowNoise) {
  Recording recording = accepted(slow_test("", nullptr));
  std::vector<double>& place_m = recording.dofs[0].of(Channel::measured_displacement);
  std::vector<double>& force_n = recording.dofs[0].of(Channel::measured_force);
  recording.samples = 4200;
  const std::vector<double> noise_m = made_noise({.correlation = 0.7}, recording.samples, 5e-6, 1.0, 1);
  const std::vector<double> noise_n = made_noise({.correlation = 0.7}, recording.samples, 25.0, 1.0, 2);
  place_m.clear();
  force_n.clear();
  Bilinear specimen{{.stiffness_n_per_m = kMadeStiffness_n_per_m, .yield_force_n = 2e4, .hardening_ratio = 0.03}};
  for (std::size_t i = 0; i < recording.samples; ++i) {
    const double way = static_cast<double>(i) / 300.0;  // cycles
    const double moved_m = 0.002 * (1.0 + way) * std::asin(std::sin(2.0 * std::numbers::pi * way)) / 1.5708;
    place_m.push_back(moved_m + noise_m[i]);
    force_n.push_back(specimen.trial(moved_m, 0.0) + noise_n[i]);
    specimen.commit();
  }
  SiteModel model = made_model();
  model.make_law = [] {
    return std::make_unique<Bilinear>(Bilinear::Parameters{
        .stiffness_n_per_m = 1.02 * kMadeStiffness_n_per_m, .yield_force_n = 0.985 * 2e4, .hardening_ratio = 0.03});
  };
  const Diagnosis diagnosis = diagnose(model, {&recording, 1}, {});
  EXPECT_EQ(diagnosis.report.verdict, report::Verdict::none);
  EXPECT_EQ(diagnosis.report.corrections.size(), 2U) << "stiffness and strength";
}

TEST(QuasiStaticRecording, EvenTimeIsTimeUnlessTheModelSaysNot) {
  EXPECT_FALSE(accepted(slow_test("time_s", even_s)).is_quasi_static);
}

TEST(QuasiStaticRecording, FewUnevenStampsAndJitterStayErrors) {
  const auto complaint = [](const std::function<double(std::size_t)>& time_s) {
    const Intake intake = read_csv_recording(slow_test("time_s", time_s), "slow.csv");
    std::string text;
    for (const IntakeFinding& finding : intake.findings) text += finding.what + "\n";
    return intake.recording ? std::string{} : text;
  };
  EXPECT_THAT(complaint([](std::size_t i) { return even_s(i) + (i % 10 == 5 ? 0.002 : 0.0); }), HasSubstr("uneven"));
  const auto jitter = [](std::size_t i) { return even_s(i) + 0.0005 * static_cast<double>(i * 7919 % 5); };
  EXPECT_THAT(complaint(jitter), HasSubstr("uneven"));
  EXPECT_THAT(complaint([](std::size_t i) { return uneven_s(i) - (i == 50 ? 3.0 : 0.0); }), HasSubstr("earlier"));
}

TEST(QuasiStaticRecording, OtherUnevenChannelsStayAnError) {
  std::string text = slow_test("time_s", uneven_s);
  text.replace(text.find("measured_displacement_m"), 23, "command_displacement_m");
  EXPECT_FALSE(read_csv_recording(text, "slow.csv").recording.has_value());
}

/// The sign of the velocity that it is given.
class Direction final : public Law {
 public:
  double trial(double /*displacement_m*/, double velocity_m_per_s) noexcept override {
    return velocity_m_per_s == 0.0 ? 0.0 : std::copysign(1.0, velocity_m_per_s);
  }
  void commit() noexcept override {}
  void revert() noexcept override {}
  void reset() noexcept override {}
  [[nodiscard]] double initial_stiffness_n_per_m() const noexcept override { return 0.0; }
};

TEST(QuasiStaticRecording, VelocityIsNothingButADirection) {
  const Recording recording = accepted(slow_test("", nullptr));
  const std::vector<double>& path_m = recording.dofs[0].of(Channel::measured_displacement);
  SiteModel model = made_model();
  model.make_law = [] { return std::make_unique<Direction>(); };
  const std::vector<ReplayedChannel> directions = replay(model, recording, 0);
  ASSERT_EQ(directions.size(), 1U);
  for (std::size_t i = 1; i < path_m.size(); ++i) {
    ASSERT_EQ(directions[0].predicted[i], path_m[i] > path_m[i - 1] ? 1.0 : -1.0) << i;
  }
  model.make_law = [] {
    return std::make_unique<Viscous>(Viscous::Parameters{.damping_n_s_per_m = 1e9, .exponent = 0.5});
  };
  const std::vector<ReplayedChannel> damped = replay(model, recording, 0);
  EXPECT_TRUE(std::ranges::all_of(damped[0].predicted, [](double force_n) { return std::abs(force_n) < 1e-100; }));
}

TEST(QuasiStaticRecording, EffectsOfTimeInTheModelAreLeftOut) {
  const Recording recording = accepted(slow_test("", nullptr));
  SiteModel model = made_model();
  const std::vector<ReplayedChannel> without = replay(model, recording, 0);
  model.effects.push_back({find_effect(EffectInterface::specimen, "viscous_damping"), {1e6}});
  model.effects.push_back({find_effect(EffectInterface::force_sensor, "drift"), {1e3}});
  EXPECT_EQ(replay(model, recording, 0)[0].predicted, without[0].predicted);
  EXPECT_THAT(diagnose(model, {&recording, 1}, {}).report.notes,
              testing::Contains(HasSubstr("because it needs time: viscous_damping and drift")));
}

TEST(QuasiStaticRecording, ReplayIsReadAsOneAgain) {
  const Recording recording = accepted(slow_test("", nullptr));
  const std::string csv = replay_csv(recording, {replay(made_model(), recording, 0)});
  EXPECT_TRUE(csv.starts_with("step,measured_displacement_m"));
  const Recording again = accepted(csv);
  EXPECT_TRUE(again.is_quasi_static);
  EXPECT_EQ(again.sample_period_s, recording.sample_period_s);
}

TEST(QuasiStaticRecording, ASecondIsACycleOverTheWholeRange) {
  std::string text = "measured_displacement_m,measured_force_n\n";
  for (int i = 0; i <= 300; ++i) text += fmt::format("{:.9f},0\n", 0.01 * std::sin(std::numbers::pi * i / 50.0));
  EXPECT_NEAR(accepted(text).sample_period_s, 3.0 / 300.0, 1e-6);
}

TEST(NoiseAlongPath, IsThatOfTheForceBesideYielding) {
  const std::vector<double> path_m = slow_path();
  EXPECT_NEAR(noise_along_path(path_m, yielding_n(path_m)), 50.0, 15.0);
  EXPECT_EQ(noise_along_path({}, {}), 0.0);
}

}  // namespace
}  // namespace hybridtest
