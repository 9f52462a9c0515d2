#include "mechanics/laws/lead_rubber.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config_error.hpp"
#include "core/random.hpp"
#include "mechanics/laws/bilinear.hpp"

namespace hybridtest {
namespace {

constexpr LeadRubber::Parameters kCold{
    .rubber_stiffness_n_per_m = 1.0e6, .lead_strength_n = 8.0e4, .yield_displacement_m = 0.01};

LeadRubber::Parameters heating(double path_m) {
  auto parameters = kCold;
  parameters.heating_path_m = path_m;
  return parameters;
}

double impose(Law& bearing, double displacement_m) {
  const double force_n = bearing.trial(displacement_m, 0.0);
  bearing.commit();
  return force_n;
}

TEST(LeadRubber, WithoutHeatingItIsBilinear) {
  LeadRubber bearing{kCold};
  Bilinear bilinear{{.stiffness_n_per_m = 9.0e6, .yield_force_n = 9.0e4, .hardening_ratio = 1.0 / 9.0}};
  Random random{8};
  for (int i = 0; i < 500; ++i) {
    const double displacement_m = random.uniform(-0.1, 0.1);
    ASSERT_NEAR(impose(bearing, displacement_m), impose(bilinear, displacement_m), 1e-7);
  }
}

TEST(LeadRubber, LeadLosesStrengthWithItsPlasticPath) {
  LeadRubber bearing{heating(0.5)};
  double path_m = 0.0;
  double before_m = 0.0;
  double elastic_m = 0.0;
  for (const double displacement_m : {0.05, -0.05, 0.05, -0.05, 0.05, -0.05}) {
    const double lead_n = std::abs(impose(bearing, displacement_m) - 1.0e6 * displacement_m);
    // What the lead did not take elastically is plastic path, and the strength belongs to the path.
    const double elastic_now_m = std::copysign(lead_n / 8.0e6, displacement_m);
    path_m += std::abs(displacement_m - before_m - (elastic_now_m - elastic_m));
    EXPECT_NEAR(lead_n, 8.0e4 / (1.0 + path_m / 0.5), 1e-7);
    before_m = displacement_m;
    elastic_m = elastic_now_m;
  }
  EXPECT_GT(path_m, 0.4);  // control: nearly half of the strength is gone
}

TEST(LeadRubber, HeatComesFromTheWorkOfTheLead) {
  // E2 T from the work, by the trapezoidal rule over small steps, against the strength that the law has left.
  LeadRubber bearing{heating(0.5)};
  constexpr int kSteps = 100000;
  double work_j = 0.0;
  double before_n = 0.0;
  double lead_n = 0.0;
  for (int i = 1; i <= kSteps; ++i) {
    const double displacement_m = 1.0 * i / kSteps;
    lead_n = impose(bearing, displacement_m) - 1.0e6 * displacement_m;
    work_j += 0.5 * (before_n + lead_n) / kSteps;
    before_n = lead_n;
  }
  // All work but what is stored elastically becomes heat; C / E2 is L times Q0.
  const double heat_j = work_j - 0.5 * lead_n * lead_n / 8.0e6;
  EXPECT_NEAR(lead_n, 8.0e4 * std::exp(-heat_j / (0.5 * 8.0e4)), 1e-5 * 8.0e4);
}

TEST(LeadRubber, ForceDoesNotDependOnTheStep) {
  LeadRubber once{heating(0.3)};
  LeadRubber finely{heating(0.3)};
  Random random{3};
  double from_m = 0.0;
  for (int turn = 0; turn < 50; ++turn) {
    const double to_m = random.uniform(-0.1, 0.1);
    double force_n = 0.0;
    for (int i = 1; i <= 100; ++i) force_n = impose(finely, from_m + (to_m - from_m) * i / 100);
    ASSERT_NEAR(impose(once, to_m), force_n, 1e-7) << "turn " << turn;
    from_m = to_m;
  }
}

TEST(LeadRubber, RejectsParametersOutOfRange) {
  EXPECT_THROW(LeadRubber{heating(-1.0)}, ConfigError);
  auto parameters = kCold;
  parameters.lead_strength_n = 0.0;
  EXPECT_THROW(LeadRubber{parameters}, ConfigError);
}

}  // namespace
}  // namespace hybridtest
