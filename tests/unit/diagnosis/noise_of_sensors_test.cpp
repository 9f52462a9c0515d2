#include "diagnosis/identification/noise_of_sensors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "diagnosis/signals/signals.hpp"
#include "tests/unit/diagnosis/made_noise.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

namespace hybridtest {
namespace {

constexpr double kNoise_n = 50.0;
constexpr double kCorrelation = 0.9;

double spring_n(double time_s) { return kMadeStiffness_n_per_m * made_motion_m(time_s); }

/// An ideal actuator on a spring, with noise of the load cell.
Recording with_noise_of(const MadeNoise& kind, const std::function<double(double)>& force_n, std::uint64_t draw) {
  Recording recording = made_recording(made_motion_m, force_n, 0.0, draw);
  std::vector<double>& force = recording.dofs[0].of(Channel::measured_force);
  const std::vector<double> noise = made_noise(kind, force.size(), kNoise_n, kSitePeriod_s, draw);
  for (std::size_t i = 0; i < force.size(); ++i) force[i] += noise[i];
  return recording;
}

SensorNoise told(const Recording& recording) {
  const SiteModel model = made_model();
  return noise_of_sensors({&model, 1}, recording);
}

TEST(NoiseOfSensors, WhiteNoiseIsThatOfTheChannel) {
  for (std::uint64_t draw = 1; draw <= 4; ++draw) {
    const Recording recording = with_noise_of({}, spring_n, draw);
    const SensorNoise noise = told(recording);
    EXPECT_EQ(noise.force_noise_n, typical_white_noise(recording.dofs[0].of(Channel::measured_force)));
    EXPECT_EQ(noise.displacement_noise_m, typical_white_noise(recording.dofs[0].of(Channel::measured_displacement)));
    EXPECT_EQ(noise.force_coloured_noise_n, 0.0) << draw;
    EXPECT_EQ(noise.displacement_coloured_noise_m, 0.0) << draw;
  }
}

TEST(NoiseOfSensors, FindsColouredNoiseOfTheLoadCell) {
  std::vector<double> size;
  std::vector<double> time;
  for (std::uint64_t draw = 1; draw <= 8; ++draw) {
    const SensorNoise noise = told(with_noise_of({.correlation = kCorrelation}, spring_n, draw));
    EXPECT_EQ(noise.displacement_coloured_noise_m, 0.0) << draw;
    size.push_back(noise.force_coloured_noise_n / kNoise_n);
    time.push_back(noise.force_correlation_time_s * -std::log(kCorrelation) / kSitePeriod_s);
  }
  EXPECT_NEAR(upper_median(size), 1.0, 0.1);
  EXPECT_NEAR(upper_median(time), 1.0, 0.25);
}

// A gap that follows from the motion: a friction that the model lacks, smaller than the noise or larger. Its jumps are
// as correlated as slow noise.
TEST(NoiseOfSensors, TakesNoMisfitForNoise) {
  for (const double friction_n : {0.3, 1.0, 3.0, 10.0}) {
    const auto rubs_n = [&](double time_s) {
      return spring_n(time_s) + friction_n * kNoise_n * std::tanh(made_velocity_m_per_s(time_s) / 0.002);
    };
    for (std::uint64_t draw = 1; draw <= 2; ++draw) {
      EXPECT_EQ(told(with_noise_of({}, rubs_n, draw)).force_coloured_noise_n, 0.0) << friction_n << ", draw " << draw;
    }
  }
}

TEST(NoiseOfSensors, TakesNoErrorOfTheActuatorForNoise) {
  const auto late = [](double behind_s, double (*signal)(double)) {
    return [behind_s, signal](double time_s) { return signal(time_s - behind_s); };
  };
  for (const double behind_s : {1e-4, 5e-4, 4e-3}) {
    const Recording recording = made_recording(late(behind_s, made_motion_m), late(behind_s, spring_n), kNoise_n);
    EXPECT_EQ(told(recording).force_coloured_noise_n, 0.0) << behind_s;
    EXPECT_EQ(told(recording).displacement_coloured_noise_m, 0.0) << behind_s;
  }
}

TEST(NoiseOfSensors, WithoutCommandOrModelNoiseIsWhite) {
  Recording recording = with_noise_of({.correlation = kCorrelation}, spring_n, 1);
  SiteModel without_force = made_model();
  without_force.make_law = {};
  EXPECT_EQ(noise_of_sensors({&without_force, 1}, recording).force_coloured_noise_n, 0.0);
  EXPECT_GT(told(recording).force_coloured_noise_n, 0.0) << "control";
  recording.dofs[0].of(Channel::command_displacement).clear();
  EXPECT_EQ(told(recording).force_coloured_noise_n, 0.0);
  EXPECT_GT(told(recording).force_noise_n, 0.0);
}

}  // namespace
}  // namespace hybridtest
