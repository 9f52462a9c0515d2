#include "diagnosis/signals/between_steps.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/random.hpp"
#include "tests/unit/diagnosis/answers.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"
#include "tests/unit/diagnosis/made_signals.hpp"

/// The motion behind the readings of a coarse converter.
namespace hybridtest {
namespace {

constexpr double kStep = 0.5;

/// Largest difference, apart from so many samples at both ends.
double largest_error(const std::vector<double>& found, const std::vector<double>& motion, std::size_t apart) {
  double largest = 0.0;
  for (std::size_t i = apart; i + apart < found.size(); ++i) {
    largest = std::max(largest, std::abs(found[i] - motion[i]));
  }
  return largest;
}

double rms_error(const std::vector<double>& found, const std::vector<double>& motion) {
  double squares = 0.0;
  for (std::size_t i = 0; i < found.size(); ++i) squares += std::pow(found[i] - motion[i], 2);
  return std::sqrt(squares / static_cast<double>(found.size()));
}

/// `steps_in_amplitude` steps of a converter in the amplitude, 400 samples in a cycle.
std::vector<double> sine(double steps_in_amplitude) {
  std::vector<double> motion(4000);
  for (std::size_t i = 0; i < motion.size(); ++i) {
    motion[i] = steps_in_amplitude * kStep * std::sin(2.0 * std::numbers::pi * static_cast<double>(i) / 400.0);
  }
  return motion;
}

TEST(BetweenSteps, StraightMotionIsFoundToHalfASample) {
  // A reading changes between two samples: when is not known better than by half a period.
  const double per_sample = kStep / 20.5;
  std::vector<double> motion(1000);
  for (std::size_t i = 0; i < motion.size(); ++i) motion[i] = per_sample * static_cast<double>(i);
  const std::vector<double> readings = in_steps(motion, kStep);
  EXPECT_LE(largest_error(between_steps(readings, kStep), motion, 21), 0.5 * per_sample * (1.0 + 1e-9));
  EXPECT_GT(largest_error(readings, motion, 21), 0.45 * kStep);
}

TEST(BetweenSteps, SineIsFoundToASmallPartOfAStep) {
  const std::vector<double> motion = sine(20.3);
  const std::vector<double> readings = in_steps(motion, kStep);
  // Of an error that is uniform over a step; within a tenth, as a sine dwells at its peaks.
  EXPECT_NEAR(rms_error(readings, motion), kStep / std::sqrt(12.0), 0.1 * kStep / std::sqrt(12.0));
  // A step lasts three samples where the motion is fastest: half a sample is a sixth of a step at most, and evenly
  // spread 0.1 of one.
  EXPECT_LT(rms_error(between_steps(readings, kStep), motion), 0.1 * kStep);
}

TEST(BetweenSteps, ReversalIsWithinAStepOfItsReading) {
  // Just past the middle between two steps, and just short of the next one.
  for (const double steps : {5.52, 5.75, 6.0, 6.25, 6.48}) {
    const std::vector<double> motion = sine(steps);
    EXPECT_LT(largest_error(between_steps(in_steps(motion, kStep), kStep), motion, 0), 0.6 * kStep) << steps;
  }
}

TEST(BetweenSteps, RestStaysWithinHalfAStepOfItsReading) {
  std::vector<double> motion;
  for (std::size_t i = 0; i < 200; ++i) motion.push_back(0.01 * static_cast<double>(i));
  motion.insert(motion.end(), 2000, motion.back());
  for (std::size_t i = 200; i-- > 0;) motion.push_back(0.01 * static_cast<double>(i));
  const std::vector<double> readings = in_steps(motion, kStep);
  EXPECT_LE(largest_error(between_steps(readings, kStep), readings, 0), 0.5 * kStep);
}

TEST(BetweenSteps, UnevenStepsAndNoiseBehindTheConverterAreFollowed) {
  std::vector<double> readings = sine(20.3);
  const std::vector<double> motion = readings;
  Random random{5};
  for (double& value : readings) {
    const double step = std::round(value / kStep);
    // Each second step a tenth wider.
    value = kStep * (step + (std::fmod(std::abs(step), 2.0) == 1.0 ? 0.05 : -0.05)) + 0.02 * kStep * random.normal();
  }
  EXPECT_LT(rms_error(between_steps(readings, kStep), motion), 0.12 * kStep);
}

TEST(BetweenSteps, MotionOfMoreThanAStepInASampleStaysAsItIsRead) {
  const std::vector<double> fast{0.0, 1.0, 2.5, 3.5, 5.0, 4.0, 2.0};
  EXPECT_EQ(between_steps(fast, kStep), fast);
}

TEST(BetweenSteps, FewReadingsStayAsTheyAre) {
  const std::vector<double> readings{0.0, 0.0, 0.5, 0.5};
  EXPECT_EQ(between_steps(readings, kStep), readings);
}

/// Of a specimen that is 2 % stiffer than its model, which has no damping; by what the transducer reads at least.
class DampingBehindSteps : public testing::TestWithParam<double> {};

TEST_P(DampingBehindSteps, IsFoundAndNothingElse) {
  constexpr double kDamping_n_s_per_m = 3.0e4;
  const auto force_n = [](double t) {
    return 1.02 * kMadeStiffness_n_per_m * made_motion_m(t) + kDamping_n_s_per_m * made_velocity_m_per_s(t);
  };
  const Recording recording =
      made_recording([](double t) { return GetParam() * std::round(made_motion_m(t) / GetParam()); }, force_n);
  const Diagnosis diagnosis = diagnosis_of(made_model(), recording);
  EXPECT_THAT(causes_of(diagnosis), testing::UnorderedElementsAre("quantization", "viscous_damping"));
  for (const report::RankedCause& cause : diagnosis.report.ranking) {
    if (cause.effect != "viscous_damping") continue;
    // A motion that is late by 0.15 ms, a thirteenth of a sample, is as much of a spring's force as 1 % of the damping.
    EXPECT_NEAR(cause.parameters.front().value, kDamping_n_s_per_m, 0.01 * kDamping_n_s_per_m);
  }
}

/// The load cell is read in steps, whose error of 1.7 kN is 1.7 times what the damping changes.
TEST(DampingBehindStepsOfTheForce, IsFoundAndNothingElse) {
  constexpr double kStep_n = 6000.0;
  constexpr double kDamping_n_s_per_m = 0.9e4;
  const Recording recording = made_recording(made_motion_m, [](double t) {
    const double force_n = kMadeStiffness_n_per_m * made_motion_m(t) + kDamping_n_s_per_m * made_velocity_m_per_s(t);
    return kStep_n * std::round(force_n / kStep_n);
  });
  const Diagnosis diagnosis = diagnosis_of(made_model(), recording);
  EXPECT_THAT(causes_of(diagnosis), testing::UnorderedElementsAre("quantization", "viscous_damping"));
  for (const report::RankedCause& cause : diagnosis.report.ranking) {
    if (cause.effect != "viscous_damping") continue;
    // Over half a cycle, of which there are 22 here, the error of a step is of one sign.
    const double error_n_s_per_m = kStep_n / std::sqrt(12.0 * 22.0) / 0.114;  // rms velocity
    EXPECT_NEAR(cause.parameters.front().value, kDamping_n_s_per_m, 2.0 * error_n_s_per_m);
  }
}

/// Of a motion of 28 mm: steps that last for many samples, and that last for one.
INSTANTIATE_TEST_SUITE_P(SlowAndFast, DampingBehindSteps, testing::Values(0.0014, 0.0004, 0.0001));

}  // namespace
}  // namespace hybridtest
