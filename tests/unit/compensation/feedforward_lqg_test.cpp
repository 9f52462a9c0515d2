#include "compensation/feedforward_lqg.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/config_error.hpp"
#include "tests/unit/compensation/frequency_response.hpp"
#include "tests/unit/compensation/transfer_system_plant.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1.0 / 4096.0;

FeedforwardLqg::Parameters feedforward_alone() {
  FeedforwardLqg::Parameters parameters;
  parameters.has_feedback = false;
  return parameters;
}

TEST(FeedforwardLqg, FeedsForwardTheInverseUpToTheJerk) {
  // The inverse's first four coefficients, from its values on a small circle about s = 0: a sum over n points
  // leaves only the coefficients of order n and above, of which there are none.
  const TransferSystemModel model;
  constexpr int kPoints = 16;
  constexpr double kRadius = 200.0;
  std::array<double, 4> coefficients{};
  for (int i = 0; i < kPoints; ++i) {
    const Complex unit = std::polar(1.0, 2.0 * std::numbers::pi * i / kPoints);
    const Complex value = inverse_transfer_function(model, kRadius * unit);
    for (int k = 0; k < 4; ++k) {
      coefficients[static_cast<std::size_t>(k)] += (value / std::pow(kRadius * unit, k)).real() / kPoints;
    }
  }
  constexpr int kDifference = 16;  // 4 ms
  const auto closed_form = [&](double omega) {
    const Complex iw{0.0, omega};
    const Complex jerk = iw * iw * (1.0 - std::exp(-iw * (kDifference * kPeriod_s))) / (kDifference * kPeriod_s);
    return coefficients[0] + coefficients[1] * iw + coefficients[2] * iw * iw + coefficients[3] * jerk;
  };
  expect_frequency_response(
      [] {
        return FeedforwardLqg{feedforward_alone(), kPeriod_s};
      },
      closed_form, [](double) { return 1e-11; },  // rounding of terms up to 20, and of differences over 4 ms
      kPeriod_s, kDifference);
}

double worst_error(FeedforwardLqg&& compensator, const TransferSystemModel& plant_model) {
  TransferSystemPlant plant{plant_model};
  const double omega = 2.0 * std::numbers::pi * 3.0;
  const double amplitude_m = 2e-3;
  double measured_m = 0.0;
  double worst_m = 0.0;
  for (int i = 0; i < 3 * 4096; ++i) {
    CompensatorInput input = harmonic_input(omega, amplitude_m * std::polar(1.0, omega * kPeriod_s * i));
    input.measured_displacement_m = measured_m;
    measured_m = plant.displacement_m();
    if (i > 4096) worst_m = std::max(worst_m, std::abs(plant.displacement_m() - input.target_m));
    plant.advance(compensator.command(input), kPeriod_s);
  }
  return worst_m / amplitude_m;
}

TEST(FeedforwardLqg, TracksKnownPlant) {
  // Left over: half a period of hold, w T / 2 = 2.3e-3; the jerk late by 2 ms, a3 w^3 w 2 ms = 1.0e-4; the fourth
  // derivative, a4 w^4 = 7e-5.
  EXPECT_LT(worst_error(FeedforwardLqg{feedforward_alone(), kPeriod_s}, {}), 2.5e-3);
  EXPECT_LT(worst_error(FeedforwardLqg{{}, kPeriod_s}, {}), 2.5e-3);
}

TEST(FeedforwardLqg, FeedbackReducesTheErrorOfAWrongModel) {
  TransferSystemModel stiff;
  stiff.stiffness_n_per_m *= 1.1;
  stiff.a3_per_s = 5.0;
  const double without = worst_error(FeedforwardLqg{feedforward_alone(), kPeriod_s}, stiff);
  const double with = worst_error(FeedforwardLqg{{}, kPeriod_s}, stiff);
  // How much follows from weight and noises; on the benchmark, from 2.0 to 1.2 %.
  EXPECT_GT(without, 0.012);
  EXPECT_LT(with, 0.7 * without);
}

TEST(FeedforwardLqg, RejectsParametersOutOfRange) {
  const auto refuses = [](auto change) {
    FeedforwardLqg::Parameters parameters;
    change(parameters);
    EXPECT_THROW((FeedforwardLqg{parameters, kPeriod_s}), ConfigError);
  };
  refuses([](auto& p) { p.regulator_weight = 0.0; });
  refuses([](auto& p) { p.input_noise_m = 0.0; });
  refuses([](auto& p) { p.displacement_noise_m = -1.0; });
  refuses([](auto& p) { p.jerk_difference_s = 1e-5; });
  refuses([](auto& p) { p.model.mass_kg = 0.0; });
  EXPECT_THROW((FeedforwardLqg{{}, 0.0}), ConfigError);
}

}  // namespace
}  // namespace hybridtest
