#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/config_error.hpp"
#include "mechanics/laws/friction.hpp"
#include "mechanics/laws/gap_spring.hpp"
#include "mechanics/laws/viscous.hpp"

/// Laws of one line: friction, gap, viscous.
namespace hybridtest {
namespace {

double impose(Law& law, double displacement_m) {
  const double force_n = law.trial(displacement_m, 0.0);
  law.commit();
  return force_n;
}

TEST(Friction, SticksThenSlides) {
  Friction law{{.friction_force_n = 100.0, .presliding_displacement_m = 0.001}};
  EXPECT_DOUBLE_EQ(impose(law, 0.0005), 50.0);
  EXPECT_DOUBLE_EQ(impose(law, 0.01), 100.0);
  EXPECT_NEAR(impose(law, 0.009), 0.0, 1e-9);
  EXPECT_DOUBLE_EQ(impose(law, 0.0), -100.0);
  EXPECT_THROW((Friction{{.friction_force_n = 1.0, .presliding_displacement_m = 0.0}}), ConfigError);
}

TEST(GapSpring, ActsBeyondTheGap) {
  GapSpring law{{.stiffness_n_per_m = 1.0e3, .gap_m = 0.01}};
  EXPECT_EQ(impose(law, 0.0099), 0.0);
  EXPECT_NEAR(impose(law, 0.03), 20.0, 1e-12);
  EXPECT_NEAR(impose(law, -0.02), -10.0, 1e-12);
  EXPECT_THROW((GapSpring{{.stiffness_n_per_m = 0.0, .gap_m = 0.01}}), ConfigError);
}

TEST(Viscous, FollowsThePowerOfTheVelocity) {
  Viscous linear{{.damping_n_s_per_m = 200.0}};
  Viscous fluid{{.damping_n_s_per_m = 200.0, .exponent = 0.5}};
  EXPECT_EQ(linear.trial(0.3, -0.25), -50.0);
  EXPECT_EQ(fluid.trial(0.3, -0.25), -100.0);
  EXPECT_EQ(fluid.trial(0.3, 0.0), 0.0);
  EXPECT_THROW((Viscous{{.damping_n_s_per_m = -1.0}}), ConfigError);
}

TEST(Viscous, DissipatesTheClosedFormEnergyPerCycle) {
  // 2^(2 + n) G(1 + n/2)^2 / G(2 + n) c u^(1 + n) w^n with the gamma function G (Seleemah and Constantinou,
  // NCEER-97-0004, 1997); pi c w u^2 for n = 1.
  constexpr double kDamping = 200.0;
  constexpr double kAmplitude_m = 0.05;
  constexpr double kRate_rad_per_s = 4.0;
  constexpr int kSteps = 20000;
  for (const double exponent : {0.3, 0.5, 1.0, 1.5, 2.0}) {
    Viscous damper{{.damping_n_s_per_m = kDamping, .exponent = exponent}};
    double energy_j = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      const double phase = 2.0 * std::numbers::pi * (i + 0.5) / kSteps;
      const double velocity_m_per_s = kAmplitude_m * kRate_rad_per_s * std::cos(phase);
      const double force_n = damper.trial(kAmplitude_m * std::sin(phase), velocity_m_per_s);
      energy_j += force_n * velocity_m_per_s * 2.0 * std::numbers::pi / kRate_rad_per_s / kSteps;
    }
    const double shape =
        std::pow(2.0, 2.0 + exponent) * std::pow(std::tgamma(1.0 + exponent / 2.0), 2) / std::tgamma(2.0 + exponent);
    const double expected_j =
        shape * kDamping * std::pow(kAmplitude_m, 1.0 + exponent) * std::pow(kRate_rad_per_s, exponent);
    EXPECT_NEAR(energy_j / expected_j, 1.0, 1e-5) << exponent;
  }
}

}  // namespace
}  // namespace hybridtest
