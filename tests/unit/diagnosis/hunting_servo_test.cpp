#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/random.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/identification/effect_fit.hpp"
#include "diagnosis/identification/smoothing_choice.hpp"
#include "tests/unit/diagnosis/answers.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

/// Motion of the actuator that does not follow from its command. It looks like noise of the displacement transducer,
/// but the specimen answers it.
namespace hybridtest {
namespace {

using report::Verdict;

constexpr double kHunting_m = 1e-4;  // amplitude; the stroke is 20 mm

/// An oscillation of 12 Hz whose phase wanders, at the time of every sample.
std::function<double(double)> hunting() {
  Random random{11};
  std::vector<double> values;
  double phase = 0.0;
  for (std::size_t i = 0; i < 6000; ++i) {
    values.push_back(kHunting_m * std::sin(phase));
    phase += 2.0 * std::numbers::pi * 12.0 * kSitePeriod_s + 0.1 * random.normal();
  }
  return [values](double t) {
    const auto i = static_cast<std::size_t>(std::lround(std::max(0.0, t) / kSitePeriod_s));
    return values[std::min(i, values.size() - 1)];
  };
}

/// @param force_n   of the specimen, from what the actuator does without hunting and from what it does with it.
Recording site_with(double gain, const std::function<double(double, double)>& force_n) {
  const auto wanders_m = hunting();
  const auto follows_m = [gain](double t) { return gain * made_motion_m(t); };
  const auto moved_m = [=](double t) { return follows_m(t) + wanders_m(t); };
  return made_recording(moved_m, [=](double t) { return force_n(follows_m(t), moved_m(t)); });
}

double of_motion(double /*follows_m*/, double moved_m) { return kMadeStiffness_n_per_m * moved_m; }
double of_command(double follows_m, double /*moved_m*/) { return kMadeStiffness_n_per_m * follows_m; }

/// Noise that is taken into account at the measured displacement, averaged samples [m].
double floor_m(const Recording& recording) {
  IdentificationProblem problem = make_problem(made_model(), modelled_segments(made_model(), recording, 0, 0));
  settle_noise(problem, fit_nothing(problem, false));
  for (const FitSegment& fit : problem.segments) {
    if (fit.segment.to == Channel::measured_displacement) return fit.floor;
  }
  return 0.0;
}

std::optional<Verdict> verdict_at(const Diagnosis& diagnosis, std::string_view interface) {
  for (const report::InterfaceGap& gap : diagnosis.report.where) {
    if (gap.interface == interface) return gap.verdict;
  }
  return {};
}

TEST(HuntingServo, MotionThatTheSpecimenAnswersIsNoNoise) {
  const double rms_m = kHunting_m / std::numbers::sqrt2;
  EXPECT_LT(floor_m(site_with(1.0, of_motion)), 0.4 * rms_m);
  // Control: the same in the readings alone. Nothing coherent but by chance: 8 to 15 averages.
  EXPECT_NEAR(floor_m(site_with(1.0, of_command)), rms_m, 0.15 * rms_m);
}

TEST(HuntingServo, IsUnknownAtTheTransferSystem) {
  const Diagnosis diagnosis = diagnosis_of(made_model(), site_with(1.0, of_motion));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::unknown);
  EXPECT_EQ(verdict_at(diagnosis, "transfer_system"), Verdict::unknown);
  // It does not come back with the command.
  ASSERT_TRUE(diagnosis.report.where.front().recurrence);
  EXPECT_FALSE(diagnosis.report.where.front().recurrence->is_seen());
  EXPECT_LT(diagnosis.report.where.front().recurrence->removed_by_function, 0.05);
  EXPECT_THAT(diagnosis.report.next_experiment, testing::StartsWith("Repeat this test"));
}

TEST(HuntingServo, IsUnknownBesideANumberThatIsCorrected) {
  const Diagnosis diagnosis = diagnosis_of(
      made_model(), site_with(1.02, [](double, double moved_m) { return 1.015 * kMadeStiffness_n_per_m * moved_m; }));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::unknown);
  EXPECT_EQ(verdict_at(diagnosis, "transfer_system"), Verdict::unknown);
  EXPECT_EQ(verdict_at(diagnosis, "specimen"), std::nullopt);
  EXPECT_EQ(diagnosis.report.corrections.size(), 2U);
}

}  // namespace
}  // namespace hybridtest
