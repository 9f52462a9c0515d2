#include "diagnosis/response_shrink.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/random.hpp"

namespace hybridtest {
namespace {

constexpr double kStep_s = 0.01;
constexpr double kRounding = 1e-12;
const std::array<std::string, 1> kFloor{"floor_1"};

/// One degree of freedom, four steps. Rows of a Hadamard matrix are orthogonal: squares of sums are sums of squares.
TestResponse made_response(double recorded_m, double missing_m, double noise_m) {
  TestResponse response;
  response.step_s = kStep_s;
  response.displacement_m.resize(1, 4);
  response.displacement_m << recorded_m + missing_m + noise_m, recorded_m - missing_m + noise_m,
      recorded_m + missing_m - noise_m, recorded_m - missing_m - noise_m;
  response.velocity_m_per_s = Eigen::MatrixXd::Constant(1, 4, 1.0);
  response.restoring_force_n = Eigen::MatrixXd::Constant(1, 4, 100.0);
  response.applied_force_n = Eigen::MatrixXd::Constant(1, 4, 200.0);
  return response;
}

/// The completed model is at 1; the given one lacks 0.2 of it.
const TestResponse kCompleted = made_response(1.0, 0.0, 0.0);
const TestResponse kGiven = made_response(1.0, 0.2, 0.0);

/// Tests whose noise has these sizes.
std::vector<PossibleTest> tests_with(const std::vector<double>& noises_m) {
  std::vector<PossibleTest> tests;
  for (const double noise_m : noises_m) {
    tests.push_back(possible_test(made_response(1.0, 0.0, noise_m), kCompleted));
  }
  return tests;
}

TEST(ResponseShrink, FloorIsTheRootMeanSquareOfTheNoise) {
  const TestResponse recorded = made_response(1.0, 0.0, 0.02);
  const report::ResponseShrink shrink =
      response_shrink(recorded, kGiven, kCompleted, {.of_noise = tests_with({0.01, 0.03}), .of_both = {}}, kFloor);
  // Each relative to its own test, of root mean square sqrt(1 + noise^2).
  const double floor = std::sqrt(0.5 * (1e-4 / (1.0 + 1e-4) + 9e-4 / (1.0 + 9e-4)));
  EXPECT_NEAR(shrink.floor_nrmse.value(), floor, kRounding);
  const double before = (0.04 + 4e-4) / (1.0 + 4e-4);
  const double after = 4e-4 / (1.0 + 4e-4);
  EXPECT_NEAR(shrink.variance_removed, 1.0 - after / before, kRounding);
  EXPECT_LT(after, floor * floor);
  EXPECT_EQ(shrink.explainable_fraction.value(), 1.0);
  EXPECT_EQ(shrink.unknown_share.value(), 0.0);
  EXPECT_FALSE(shrink.ci95.has_value()) << "no parameters were drawn";
  EXPECT_TRUE(shrink.peaks.empty());
}

TEST(ResponseShrink, UnknownIsWhatIsLeftAboveTheFloor) {
  const TestResponse recorded = made_response(1.0, -0.1, 0.02);  // the other way: the completed model lacks 0.1
  const report::ResponseShrink shrink =
      response_shrink(recorded, kGiven, kCompleted, {.of_noise = tests_with({0.02}), .of_both = {}}, kFloor);
  const double whole = 1.0 + 0.01 + 4e-4;
  const double before = (0.09 + 4e-4) / whole;
  const double floor = 4e-4 / (1.0 + 4e-4);
  EXPECT_NEAR(shrink.unknown_share.value(), ((0.01 + 4e-4) / whole - floor) / before, kRounding);
  EXPECT_NEAR(shrink.explainable_fraction.value(), (before - (0.01 + 4e-4) / whole) / (before - floor), kRounding);
}

TEST(ResponseShrink, IntervalsAreTheExtremesOfTheDraws) {
  const TestResponse recorded = made_response(1.0, 0.0, 0.02);
  const PossibleTests possible{.of_noise = tests_with({0.01}), .of_both = tests_with({0.02, 0.03, 0.04})};
  const report::ResponseShrink shrink = response_shrink(recorded, kGiven, kCompleted, possible, kFloor);
  ASSERT_EQ(shrink.peaks.size(), 1U);
  EXPECT_EQ(shrink.peaks[0].of, "floor_1");
  EXPECT_NEAR(shrink.peaks[0].recorded, 1.02, kRounding);
  EXPECT_NEAR(shrink.peaks[0].predicted, 1.0, kRounding);
  EXPECT_NEAR(shrink.peaks[0].ci95.low, 1.01, kRounding);
  EXPECT_NEAR(shrink.peaks[0].ci95.high, 1.04, kRounding);
  // Of 1.01, 1.02, 1.03 and 1.04.
  EXPECT_NEAR(shrink.peak_error_after, 0.02 / 1.02, kRounding);
  EXPECT_NEAR(shrink.peak_error_after_ci95.value().low, 0.01 / 1.01, kRounding);
  EXPECT_NEAR(shrink.peak_error_after_ci95.value().high, 0.04 / 1.04, kRounding);
  // 100 N over 3 cm, in each of them.
  EXPECT_NEAR(shrink.energy_error_after_ci95.value().high, 0.0, kRounding);
  EXPECT_NEAR(shrink.energy_taken.value().recorded, 3.0, kRounding);
  EXPECT_NEAR(shrink.energy_taken.value().ci95.high, 3.0, kRounding);
  const auto left = [](double noise_m) { return noise_m * noise_m / (1.0 + noise_m * noise_m); };
  EXPECT_NEAR(shrink.nrmse_after_ci95.value().low, std::sqrt(left(0.01)), kRounding);
  EXPECT_NEAR(shrink.nrmse_after_ci95.value().high, std::sqrt(left(0.04)), kRounding);
  const double before = (0.04 + 4e-4) / (1.0 + 4e-4);
  EXPECT_NEAR(shrink.ci95.value().low, 1.0 - left(0.04) / before, kRounding);
  EXPECT_NEAR(shrink.ci95.value().high, 1.0 - left(0.01) / before, kRounding);
}

TEST(ResponseShrink, WhatRepeatsWidensTheLowerEnd) {
  const PossibleTests possible{.of_noise = tests_with({0.01}), .of_both = tests_with({0.01, 0.01})};
  const auto shrink_at = [&](double missing_m) {
    return response_shrink(made_response(1.0, missing_m, 0.01), kGiven, kCompleted, possible, kFloor);
  };
  const report::ResponseShrink right = shrink_at(0.0);
  EXPECT_NEAR(right.ci95.value().low, right.ci95.value().high, kRounding) << "control: nothing repeats";
  const report::ResponseShrink wrong = shrink_at(-0.1);
  EXPECT_NEAR(wrong.nrmse_after_ci95.value().low, 0.01 / std::sqrt(1.0 + 1e-4), kRounding);
  EXPECT_NEAR(wrong.nrmse_after_ci95.value().high, wrong.nrmse_after, kRounding);
  EXPECT_NEAR(wrong.ci95.value().low, wrong.variance_removed, kRounding);
  EXPECT_NEAR(right.peak_error_after_ci95.value().high, 0.01 / 1.01, kRounding) << "control";
  EXPECT_NEAR(wrong.peak_error_after_ci95.value().low, 0.01 / 1.01, kRounding);
  EXPECT_NEAR(wrong.peak_error_after_ci95.value().high, wrong.peak_error_after, kRounding) << "1.11 and not 1";
  EXPECT_EQ(wrong.peaks[0].ci95.high, right.peaks[0].ci95.high);
}

TEST(ResponseShrink, ExtremesHoldOneMoreDrawIn95Percent) {
  Random random{5};
  const auto held_by = [&](std::size_t draws) {
    constexpr int kTimes = 4000;
    int held = 0;
    for (int i = 0; i < kTimes; ++i) {
      std::vector<double> drawn(draws);
      std::ranges::generate(drawn, [&] { return std::exp(random.normal()); });
      const auto [least, most] = std::ranges::minmax(drawn);
      const double further = std::exp(random.normal());
      held += further >= least && further <= most ? 1 : 0;
    }
    return held / static_cast<double>(kTimes);
  };
  EXPECT_NEAR(held_by(draws_for_95()), 0.95, 0.0104);  // three deviations of 4000
  EXPECT_NEAR(held_by(19), 0.90, 0.0143) << "control";
}

}  // namespace
}  // namespace hybridtest
