#include "validation/studies/rths_benchmark/plant.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/random.hpp"
#include "plant/transfer_systems/linear_servo_hydraulic.hpp"
#include "validation/studies/rths_benchmark/constants.hpp"

namespace hybridtest::rths {
namespace {

TEST(Plant, SettlesAtItsEquilibrium) {
  const TransferSystemModel p = plant_parameters(3, 11);
  Plant plant{p};
  for (int i = 0; i < 4 * 4096; ++i) plant.step(0.004);
  // a1beta0 (gain u - x) = beta2 z, z = a3 F, F = k x.
  const double open = p.beta2_per_s2 * p.a3_per_s * p.stiffness_n_per_m / p.a1beta0_n_per_m_s3;
  const double wanted_m = p.gain * 0.004 / (1.0 + open);
  EXPECT_NEAR(plant.displacement_m(), wanted_m, 1e-12);
  EXPECT_NEAR(plant.force_n(), p.stiffness_n_per_m * wanted_m, 1e-6);
}

TEST(Plant, SineResponseMatchesTransferFunction) {
  for (const double frequency_hz : {1.0, 4.0, 16.0}) {
    Plant plant{TransferSystemModel{}};
    const double omega = 2.0 * std::numbers::pi * frequency_hz;
    double sine = 0.0;
    double cosine = 0.0;
    const int cycle = static_cast<int>(4096.0 / frequency_hz);  // whole
    const int measured = 4 * cycle;
    for (int i = 0; i < 40 * cycle + measured; ++i) {
      const double angle = omega * i * kPeriodS;
      if (i >= 40 * cycle) {
        sine += 2.0 / measured * plant.displacement_m() * std::sin(angle);
        cosine += 2.0 / measured * plant.displacement_m() * std::cos(angle);
      }
      plant.step(0.003 * std::sin(angle));
    }
    std::complex<double> inverse = 0.0;
    const auto coefficients = TransferSystemModel{}.inverse_coefficients();
    for (auto c = coefficients.rbegin(); c != coefficients.rend(); ++c)
      inverse = inverse * std::complex{0.0, omega} + *c;
    // The hold: sinc in amplitude (3e-5 at 16 Hz), half a period of delay.
    const std::complex<double> wanted = 0.003 * std::polar(1.0, -0.5 * omega * kPeriodS) / inverse;
    EXPECT_NEAR(std::abs(std::complex{sine, cosine} / wanted - 1.0), 0.0, 4e-5) << frequency_hz << " Hz";
  }
}

TEST(Plant, AgreesWithTheTransferSystemOfScenarios) {
  // Exact there, Runge-Kutta of order 4 here: a tenth of a radian of the fastest mode in a step, to the fifth over 120.
  Plant plant{TransferSystemModel{}};
  LinearServoHydraulic of_scenarios{{}, from_seconds(kPeriodS)};
  Random random{9, 0};
  double command_m = 0.0;
  double largest_m = 0.0;
  for (int i = 0; i < 40'000; ++i) {
    command_m = 0.998 * command_m + 1e-4 * random.normal();
    largest_m = std::max(largest_m, std::abs(plant.displacement_m()));
    // Periods are whole nanoseconds there: 1.5e-6 longer.
    ASSERT_NEAR(of_scenarios.step(command_m), plant.displacement_m(), 2e-8) << i;
    ASSERT_NEAR(of_scenarios.specimen_force_n(), plant.force_n(), 0.2) << i;
    plant.step(command_m);
  }
  EXPECT_GT(largest_m, 1e-3);
}

TEST(PlantParameters, NominalEqualsPublishedForEverySeed) {
  const TransferSystemModel nominal;
  for (const std::uint64_t seed : {1ULL, 2ULL}) {
    EXPECT_EQ(plant_parameters(0, seed).stiffness_n_per_m, nominal.stiffness_n_per_m);
    EXPECT_EQ(plant_parameters(0, seed).a3_per_s, nominal.a3_per_s);
  }
}

TEST(PlantParameters, DependOnIndexAndSeed) {
  EXPECT_EQ(plant_parameters(7, 1).stiffness_n_per_m, plant_parameters(7, 1).stiffness_n_per_m);
  EXPECT_NE(plant_parameters(7, 1).stiffness_n_per_m, plant_parameters(8, 1).stiffness_n_per_m);
  EXPECT_NE(plant_parameters(7, 1).stiffness_n_per_m, plant_parameters(7, 2).stiffness_n_per_m);
}

TEST(PlantParameters, ScatterByTheBenchmarksStandardDeviations) {
  constexpr int kPlants = 4000;
  const TransferSystemModel nominal;
  double mean[4] = {};
  double square[4] = {};
  for (int i = 1; i <= kPlants; ++i) {
    const TransferSystemModel p = plant_parameters(i, 5);
    const double z[4] = {(p.stiffness_n_per_m - nominal.stiffness_n_per_m) / 5e4,
                         (p.beta1_per_s - nominal.beta1_per_s) / 3.3, (p.beta2_per_s2 - nominal.beta2_per_s2) / 3.3e3,
                         (p.a3_per_s - nominal.a3_per_s) / 1.3};
    for (int k = 0; k < 4; ++k) {
      mean[k] += z[k] / kPlants;
      square[k] += z[k] * z[k] / kPlants;
    }
    EXPECT_EQ(p.gain, nominal.gain);
    EXPECT_EQ(p.mass_kg, nominal.mass_kg);
  }
  for (int k = 0; k < 4; ++k) {
    // Four standard errors of a mean and of a variance.
    EXPECT_NEAR(mean[k], 0.0, 4.0 / std::sqrt(kPlants));
    EXPECT_NEAR(square[k], 1.0, 4.0 * std::sqrt(2.0 / kPlants));
  }
}

}  // namespace
}  // namespace hybridtest::rths
