#include "diagnosis/sanity/relation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "mechanics/laws/bilinear.hpp"
#include "mechanics/laws/presliding_element.hpp"
#include "tests/unit/diagnosis/made_signals.hpp"

namespace hybridtest {
namespace {

constexpr std::size_t kSamples = 5000;
constexpr double kRate_hz = 250.0;
constexpr std::size_t kShift = 12;

/// Band noise about `frequency_hz`, as of an earthquake that a structure filters.
std::vector<double> band_noise(double frequency_hz, std::uint64_t stream) {
  const std::vector<double> noise = white_noise(kSamples, 1.0, stream);
  std::vector<double> values(kSamples);
  const double turn = 2.0 * std::numbers::pi * frequency_hz / kRate_hz;
  const double damped = 1.0 - 0.05 * turn;
  for (std::size_t i = 2; i < kSamples; ++i) {
    values[i] = 2.0 * damped * std::cos(turn) * values[i - 1] - damped * damped * values[i - 2] + noise[i];
  }
  return values;
}

std::vector<double> sine_motion() {
  std::vector<double> values(kSamples);
  for (std::size_t i = 0; i < kSamples; ++i) values[i] = sine(1.3, static_cast<double>(i) / kRate_hz);
  return values;
}

std::vector<double> noisy(std::vector<double> values, double share) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  const std::vector<double> noise = white_noise(values.size(), share * largest, 9);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += noise[i];
  return values;
}

using Specimen = std::function<std::vector<double>(const std::vector<double>&)>;

std::vector<double> driven(const std::vector<double>& motion, const std::function<double(std::size_t)>& force) {
  std::vector<double> values(motion.size());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = force(i);
  return values;
}

std::vector<double> damped(const std::vector<double>& x) {
  return driven(x, [&](std::size_t i) { return i == 0 ? 0.0 : x[i] - x[i - 1]; });
}

std::vector<double> heavy(const std::vector<double>& x) {
  return driven(x, [&](std::size_t i) { return i < 2 ? 0.0 : x[i] - 2.0 * x[i - 1] + x[i - 2]; });
}

std::vector<double> rubbing(const std::vector<double>& x) {
  PreslidingElement element{1e-3};
  return driven(x, [&](std::size_t i) { return element.share(x[i]); });
}

std::vector<double> yielding(const std::vector<double>& x) {
  const double peak = std::abs(*std::ranges::max_element(x));
  Bilinear law{{.stiffness_n_per_m = 1.0, .yield_force_n = 0.2 * peak, .hardening_ratio = 0.0}};
  return driven(x, [&](std::size_t i) {
    const double force = law.trial(x[i], 0.0);
    law.commit();
    return force;
  });
}

std::vector<double> touching_once(const std::vector<double>& x) {
  const double peak = *std::ranges::max_element(x);
  return driven(x, [&](std::size_t i) { return std::max(0.0, x[i] - 0.9 * peak); });
}

std::vector<double> breaking_early(const std::vector<double>& x) {
  return driven(x, [&](std::size_t i) { return i < x.size() / 5 ? x[i] : 0.0; });
}

std::vector<double> late(const std::vector<double>& x) {
  return driven(x, [&](std::size_t i) { return i < kShift ? 0.0 : x[i - kShift]; });
}

std::vector<double> drifting(const std::vector<double>& x) {
  return driven(x, [&](std::size_t i) { return x[i] + 0.5e-3 * static_cast<double>(i); });
}

TEST(Relation, IsSeenForEveryKindOfSpecimen) {
  const std::vector<std::pair<const char*, Specimen>> specimens{{"damped", damped},
                                                                {"heavy", heavy},
                                                                {"rubbing", rubbing},
                                                                {"yielding", yielding},
                                                                {"touching_once", touching_once},
                                                                {"breaking_early", breaking_early},
                                                                {"late", late},
                                                                {"drifting", drifting}};
  for (const std::vector<double>& motion : {sine_motion(), band_noise(0.7, 1), band_noise(3.0, 2)}) {
    for (const auto& [name, specimen] : specimens) {
      const Relation relation = relation_between(motion, noisy(specimen(motion), 0.02), kShift);
      EXPECT_FALSE(relation.is_none()) << name << ": " << relation.fitted << ", " << relation.held_out;
    }
  }
}

TEST(Relation, IsNoneForNoiseHumAndTheForceOfAnotherTest) {
  int seen = 0;
  int draws = 0;
  for (std::uint64_t stream = 10; stream < 40; stream += 2) {
    for (const std::vector<double>& motion : {sine_motion(), band_noise(0.7, stream), band_noise(3.0, stream)}) {
      std::vector<double> hum(kSamples);
      for (std::size_t i = 0; i < kSamples; ++i) hum[i] = sine(50.0, static_cast<double>(i) / kRate_hz);
      for (const std::vector<double>& force :
           {white_noise(kSamples, 1.0, stream + 1), hum, band_noise(0.7, stream + 1), band_noise(2.0, stream + 1)}) {
        ++draws;
        if (!relation_between(motion, force, kShift).is_none()) ++seen;
      }
    }
  }
  EXPECT_LE(seen, draws / 20) << "of " << draws;
}

TEST(FarLag, IsFoundBeyondTheSearchOfFits) {
  const std::vector<double> motion = band_noise(0.7, 3);
  std::vector<double> later(kSamples);
  for (std::size_t i = 300; i < kSamples; ++i) later[i] = motion[i - 300];
  EXPECT_EQ(far_lag(motion, later), 300);
  EXPECT_EQ(far_lag(later, motion), -300);
  EXPECT_FALSE(far_lag(motion, band_noise(0.7, 4)).has_value());
}

TEST(Sense, TellsAReversedSpringFromAMass) {
  const std::vector<double> motion = band_noise(1.0, 5);
  std::vector<double> acceleration = heavy(motion);
  std::rotate(acceleration.begin(), acceleration.begin() + 1, acceleration.end());  // of the sample itself
  std::vector<double> reversed = motion;
  for (double& value : reversed) value *= -1.0;
  const Sense sense = sense_of(motion, reversed, acceleration);
  EXPECT_NEAR(sense.slope, -1.0, 1e-3);
  EXPECT_NEAR(sense.correlation, -1.0, 1e-9);
  EXPECT_LT(sense.leaves, 1e-6);
  EXPECT_GT(sense.mass_leaves, 0.05);
  const Sense mass = sense_of(motion, acceleration, acceleration);
  EXPECT_LT(mass.mass_leaves, 1e-6);
  EXPECT_GT(mass.leaves, 0.05);
}

TEST(Sense, MeasuresAShiftOfPartOfASample) {
  std::vector<double> motion(kSamples);
  std::vector<double> later(kSamples);
  for (std::size_t i = 0; i < kSamples; ++i) {
    motion[i] = sine(1.3, static_cast<double>(i) / kRate_hz);
    later[i] = sine(1.3, (static_cast<double>(i) - 0.4) / kRate_hz);
  }
  EXPECT_NEAR(sense_of(motion, later, {}).shift, 0.4, 0.01);
}

TEST(WorkShare, IsNoneForASpringAndAllForFriction) {
  const std::vector<double> motion = sine_motion();
  EXPECT_NEAR(work_share(motion, motion), 0.0, 0.05);
  std::vector<double> friction = rubbing(motion);
  EXPECT_NEAR(work_share(motion, friction), 1.0, 0.01);
  for (double& value : friction) value *= -1.0;
  EXPECT_NEAR(work_share(motion, friction), -1.0, 0.01);
}

}  // namespace
}  // namespace hybridtest
