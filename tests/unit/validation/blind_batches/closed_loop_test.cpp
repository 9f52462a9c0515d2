#include "validation/blind_batches/plant/closed_loop.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace hybridtest::blind {
namespace {

constexpr double kRateHz = 1000.0;
constexpr double kStiffness = 2e6;

Site elastic_site() {
  Site site;
  site.specimen.stiffness_n_per_m = kStiffness;
  site.rate_hz = kRateHz;
  return site;
}

/// A step of 1 m/s2 from the second sample on.
History step() {
  History ground(4001, 1.0);
  ground[0] = 0.0;
  return ground;
}

std::vector<PlantRecording> run(const ShearBuilding& building, const std::vector<TestedStorey>& tested) {
  RandomStream noise{1, 0, "noise"};
  return run_closed_loop(building, tested, step(), noise);
}

TEST(ClosedLoop, IdealSiteMovesAsTheWholeStructure) {
  const double damping = 0.05;
  const double w = kTwoPi * 1.5;
  const ShearBuilding building = shear_building({kStiffness}, 1.5, damping);
  const PlantRecording recording = run(building, {{elastic_site(), {}}}).front();
  // Chopra (2012), section 4.3: the response to a load that begins suddenly, here half a sample early.
  const double damped = w * std::sqrt(1.0 - damping * damping);
  for (std::size_t i = 100; i < recording.sent_m.size(); i += 131) {
    const double t = (static_cast<double>(i) - 0.5) / kRateHz;
    const double x =
        -1.0 / (w * w) *
        (1.0 - std::exp(-damping * w * t) *
                   (std::cos(damped * t) + damping / std::sqrt(1.0 - damping * damping) * std::sin(damped * t)));
    // The force goes on straight over a step: (w h)^2 / 12 of it, over 2 pi 1.5 4 radians, and half a sample of a
    // tapered beginning.
    EXPECT_NEAR(recording.sent_m[i], x, 2e-3 / (w * w)) << i;
    EXPECT_NEAR(recording.measured_n[i], kStiffness * recording.measured_m[i], 1e-6);
  }
}

TEST(ClosedLoop, CommandFollowsTheMeasuredForce) {
  const ShearBuilding building = shear_building({kStiffness}, 1.5, 0.05);
  const PlantEffects biased{{"force_sensor", "bias", {{"bias_n", 500.0}}}};
  const PlantRecording clean = run(building, {{elastic_site(), {}}}).front();
  const PlantRecording recording = run(building, {{elastic_site(), biased}}).front();
  // A constant force moves the structure by force over stiffness, once it has swung in.
  double mean = 0.0;
  for (std::size_t i = 0; i < clean.sent_m.size(); ++i) mean += recording.sent_m[i] - clean.sent_m[i];
  mean /= static_cast<double>(clean.sent_m.size());
  EXPECT_NEAR(mean, -500.0 / kStiffness, 0.1 * 500.0 / kStiffness);
}

TEST(ClosedLoop, DelayTakesDampingAway) {
  Site late = elastic_site();
  late.transfer_system = {.kind = TransferKind::delay, .delay_s = 0.008};
  const ShearBuilding building = shear_building({kStiffness}, 1.5, 0.02);
  const auto last_swing = [&](const Site& site) {
    const PlantRecording recording = run(building, {{site, {}}}).front();
    const double rest = -1.0 / std::pow(kTwoPi * 1.5, 2);
    double most = 0.0;
    for (std::size_t i = recording.sent_m.size() - 700; i < recording.sent_m.size(); ++i) {
      most = std::max(most, std::abs(recording.sent_m[i] - rest));
    }
    return most;
  };
  // Damping of -w tau / 2 = -0.038 beside 0.02 (Horiuchi et al., 1999): the swing grows instead of fading.
  EXPECT_GT(last_swing(late), 1.0 / std::pow(kTwoPi * 1.5, 2));
  EXPECT_LT(last_swing(elastic_site()), 0.7 / std::pow(kTwoPi * 1.5, 2));
}

TEST(ClosedLoop, StoreysShareOneStructure) {
  const ShearBuilding building = shear_building({kStiffness, kStiffness, kStiffness}, 1.0, 0.05);
  const std::vector<PlantRecording> both = run(building, {{elastic_site(), {}}, {elastic_site(), {}}});
  ASSERT_EQ(both.size(), 2U);
  // Equal masses and stiffnesses under a steady load: drifts as 3 : 2 : 1.
  double first = 0.0;
  double second = 0.0;
  for (std::size_t i = 0; i < both[0].sent_m.size(); ++i) {
    first += both[0].sent_m[i];
    second += both[1].sent_m[i];
  }
  EXPECT_NEAR(second / first, 2.0 / 3.0, 0.02);
}

TEST(Noise, HasItsSizeColourAndHum) {
  RandomStream random{3, 0, "noise"};
  const auto correlation = [](const History& values) {
    double product = 0.0;
    for (std::size_t i = 1; i < values.size(); ++i) product += values[i] * values[i - 1];
    return product / static_cast<double>(values.size()) / std::pow(rms(values), 2);
  };
  constexpr std::size_t kCount = 40000;
  // Four deviations: 4 / sqrt(2 n) of a white one's size, 4 / sqrt(n) of a correlation.
  const History white = noise_of({.standard_deviation = 2.0}, kCount, kRateHz, random);
  EXPECT_NEAR(rms(white), 2.0, 2.0 * 4.0 / std::sqrt(2.0 * kCount));
  EXPECT_NEAR(correlation(white), 0.0, 4.0 / std::sqrt(kCount));
  const History coloured = noise_of({.standard_deviation = 2.0, .memory = 0.9}, kCount, kRateHz, random);
  EXPECT_NEAR(rms(coloured), 2.0, 2.0 * 4.0 * std::sqrt(19.0) / std::sqrt(2.0 * kCount));
  EXPECT_NEAR(correlation(coloured), 0.9, 4.0 / std::sqrt(kCount));
  const NoiseModel humming{.standard_deviation = 2.0, .hum_hz = 50.0};
  EXPECT_NEAR(rms(noise_of(humming, kCount, kRateHz, random)), 2.0 * std::hypot(1.0, 0.5), 0.04);
  EXPECT_DOUBLE_EQ(humming.rms(), 2.0 * std::hypot(1.0, 0.5));
}

TEST(GroundMotion, HasUnitPeakAndRests) {
  RandomStream random{4, 0, "ground"};
  for (int draw = 0; draw < 5; ++draw) {
    const History ground = ground_motion(kRateHz, 15.0, 1.0, random);
    EXPECT_EQ(ground.size(), 15001U);
    EXPECT_NEAR(peak(ground), 1.0, 0.2);  // less where the taper meets the peak
    for (std::size_t i = 0; i < 999; ++i) EXPECT_EQ(ground[i], 0.0);
  }
}

}  // namespace
}  // namespace hybridtest::blind
