#include "mechanics/laws/bouc_wen_baber_noori.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/config_error.hpp"
#include "mechanics/laws/bouc_wen.hpp"

namespace hybridtest {
namespace {

constexpr double kStiffness_n_per_m = 4.0e6;

BoucWenBaberNoori::Parameters without_memory() {
  return {.stiffness_n_per_m = kStiffness_n_per_m, .alpha = 0.1, .n = 1.0, .gamma_per_m = 50.0, .beta_per_m = 50.0};
}

double impose(Law& law, double displacement_m) {
  const double force_n = law.trial(displacement_m, 0.0);
  law.commit();
  return force_n;
}

TEST(BoucWenBaberNoori, EqualsBoucWenWithoutDegradationAndPinching) {
  for (const double n : {1.0, 2.0}) {
    auto parameters = without_memory();
    parameters.n = n;
    if (n == 2.0) parameters.gamma_per_m = parameters.beta_per_m = 5.0e3;
    BoucWenBaberNoori extended{parameters};
    BoucWen plain{{.stiffness_n_per_m = kStiffness_n_per_m,
                   .alpha = 0.1,
                   .n = n,
                   .gamma_per_m = parameters.gamma_per_m,
                   .beta_per_m = parameters.beta_per_m}};
    const double ultimate_n = 0.9 * kStiffness_n_per_m * 0.01;
    for (int i = 0; i < 4000; ++i) {
      const double displacement_m = 0.04 * std::sin(0.01 * i) + 0.01 * std::sin(0.13 * i);
      ASSERT_NEAR(impose(extended, displacement_m), impose(plain, displacement_m), 1e-5 * ultimate_n)
          << i;  // as documented
    }
  }
}

TEST(BoucWenBaberNoori, SubstepsAreAsExactAsDocumented) {
  for (const double n : {1.0, 1.7, 4.0}) {
    for (const double level : {0.0, 0.3}) {
      constexpr double kUltimate_m = 0.01;
      const double energy_j = kStiffness_n_per_m * kUltimate_m * kUltimate_m;
      const BoucWenBaberNoori::Parameters parameters{.stiffness_n_per_m = kStiffness_n_per_m,
                                                     .alpha = 0.1,
                                                     .n = n,
                                                     .gamma_per_m = 0.4 * std::pow(kUltimate_m, -n),
                                                     .beta_per_m = 0.6 * std::pow(kUltimate_m, -n),
                                                     .strength_degradation_per_j = 0.01 / energy_j,
                                                     .stiffness_degradation_per_j = 0.02 / energy_j,
                                                     .pinching = 0.8,
                                                     .pinching_rate_per_j = 0.1 / energy_j,
                                                     .pinching_level = level,
                                                     .pinching_width_m = 0.3 * kUltimate_m,
                                                     .width_rate_m_per_j = 0.01 * kUltimate_m / energy_j,
                                                     .width_share = 0.3};
      BoucWenBaberNoori exact{parameters, 1024.0};
      BoucWenBaberNoori usual{parameters};
      BoucWenBaberNoori searched{parameters, 8.0};
      double most_n = 0.0;
      double least_n = 0.0;
      const double unit_n = 0.9 * kStiffness_n_per_m * kUltimate_m;
      for (int i = 0; i < 4000; ++i) {
        const double displacement_m = 0.04 * std::sin(0.05 * i) + 0.01 * std::sin(0.13 * i);
        const double force_n = impose(exact, displacement_m);
        ASSERT_NEAR(impose(usual, displacement_m), force_n, 1e-5 * unit_n) << i;
        ASSERT_NEAR(impose(searched, displacement_m), force_n, 6e-4 * unit_n) << i;
        if (i < 200) most_n = std::max(most_n, force_n);
        if (i > 3800) least_n = std::max(least_n, force_n);
      }
      EXPECT_LT(least_n, 0.9 * most_n);  // control: it does degrade
    }
  }
}

TEST(BoucWenBaberNoori, StrengthFollowsDissipatedEnergy) {
  // n = 1: far along one way z follows zu = 1 / (1 + d e) / (beta + gamma), so d(e) = k z dx gives
  // (1 + d e)^2 = 1 + 2 d k zu0 x, but for the beginning.
  auto parameters = without_memory();
  parameters.alpha = 0.0;
  parameters.strength_degradation_per_j = 1.0e-5;
  BoucWenBaberNoori law{parameters};
  double force_n = 0.0;
  constexpr double kWay_m = 20.0;
  for (int i = 1; i <= 20000; ++i) force_n = impose(law, kWay_m * i / 20000);
  const double full_n = kStiffness_n_per_m * 0.01;
  const double expected_n = full_n / std::sqrt(1.0 + 2.0 * 1.0e-5 * full_n * kWay_m);
  // The beginning dissipates k zu0^2 = 400 J less, and z is late by about zu: parts in a thousand.
  EXPECT_NEAR(force_n, expected_n, 2e-3 * expected_n);
  EXPECT_LT(expected_n, 0.3 * full_n);  // control: it does degrade
}

TEST(BoucWenBaberNoori, GetsSofterWithTheDissipatedEnergy) {
  auto parameters = without_memory();
  parameters.alpha = 0.0;
  parameters.stiffness_degradation_per_j = 1.0e-4;
  BoucWenBaberNoori law{parameters};
  for (int i = 1; i <= 2000; ++i) static_cast<void>(impose(law, 0.5 * i / 2000));
  const double top_n = impose(law, 0.5);
  // Back from the top the slope is k / (1 + d_eta e) for beta = gamma, with e = 0.9.. of force times way.
  const double slope = (top_n - impose(law, 0.5 - 1e-5)) / 1e-5;
  const double energy_j = kStiffness_n_per_m * 0.01 * (0.5 - 0.01);
  EXPECT_NEAR(slope, kStiffness_n_per_m / (1.0 + 1.0e-4 * energy_j), 0.03 * slope);  // loads later, the softer it gets
}

TEST(BoucWenBaberNoori, PinchesWhereItsForceChangesSign) {
  auto parameters = without_memory();
  parameters.alpha = 0.0;
  parameters.pinching = 0.9;
  parameters.pinching_rate_per_j = 1.0;
  parameters.pinching_width_m = 0.002;
  BoucWenBaberNoori law{parameters};
  static_cast<void>(impose(law, 0.05));
  double displacement_m = 0.05;
  double force_n = impose(law, displacement_m);
  double slope_at_zero = 0.0;
  while (force_n > 0.0) {
    const double before_n = force_n;
    displacement_m -= 1e-6;
    force_n = impose(law, displacement_m);
    slope_at_zero = (before_n - force_n) / 1e-6;
  }
  EXPECT_NEAR(slope_at_zero, 0.1 * kStiffness_n_per_m, 0.01 * kStiffness_n_per_m);
}

TEST(BoucWenBaberNoori, RejectsParametersOutOfRange) {
  auto parameters = without_memory();
  parameters.pinching = 1.0;
  EXPECT_THROW(BoucWenBaberNoori{parameters}, ConfigError);
  parameters = without_memory();
  parameters.gamma_per_m = -50.0;
  EXPECT_THROW(BoucWenBaberNoori{parameters}, ConfigError);
}

}  // namespace
}  // namespace hybridtest
