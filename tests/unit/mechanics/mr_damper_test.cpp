#include "mechanics/laws/mr_damper.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config_error.hpp"
#include "core/random.hpp"
#include "mechanics/laws/bouc_wen.hpp"

namespace hybridtest {
namespace {

constexpr MrDamper::Parameters kDamper{.damping_n_s_per_m = 2.0e3,
                                       .stiffness_n_per_m = 500.0,
                                       .hysteretic_force_n = 1.0e3,
                                       .hysteretic_displacement_m = 0.002};

TEST(MrDamper, MovingOneWayItReachesItsHystereticForce) {
  MrDamper damper{kDamper};
  for (const double displacement_m : {0.001, 0.004, 0.05}) {
    const double expected_n = 2.0e3 * 0.1 + 500.0 * displacement_m + 1.0e3 * std::tanh(displacement_m / 0.002);
    EXPECT_NEAR(damper.trial(displacement_m, 0.1), expected_n, 1e-9);
  }
}

TEST(MrDamper, AfterAReversalTheHysteresisUnloadsStraight) {
  MrDamper damper{kDamper};
  static_cast<void>(damper.trial(0.1, 0.1));
  damper.commit();
  const double expected_n = -2.0e3 * 0.1 + 500.0 * 0.0985 + 1.0e3 * (1.0 - 0.0015 / 0.002);
  EXPECT_NEAR(damper.trial(0.0985, -0.1), expected_n, 1e-9);
}

TEST(MrDamper, HysteresisIsThatOfBoucWen) {
  MrDamper damper{{.damping_n_s_per_m = 0.0, .hysteretic_force_n = 1.0e3, .hysteretic_displacement_m = 0.002}};
  BoucWen bouc_wen{{.stiffness_n_per_m = 1.0e3 / 0.002,
                    .alpha = 0.0,
                    .n = 2.0,
                    .gamma_per_m = 0.5 / (0.002 * 0.002),
                    .beta_per_m = 0.5 / (0.002 * 0.002)}};
  Random random{5};
  for (int i = 0; i < 500; ++i) {
    const double displacement_m = random.uniform(-0.01, 0.01);
    // BoucWen integrates to about 1e-9 of the ultimate z.
    ASSERT_NEAR(damper.trial(displacement_m, 0.0), bouc_wen.trial(displacement_m, 0.0), 1e-5);
    damper.commit();
    bouc_wen.commit();
  }
}

TEST(MrDamper, ViscousForceGoesWithTheVelocity) {
  MrDamper damper{kDamper};
  EXPECT_NEAR(damper.trial(0.01, 0.3) - damper.trial(0.01, 0.1), 2.0e3 * 0.2, 1e-9);
}

TEST(MrDamper, RejectsParametersOutOfRange) {
  auto parameters = kDamper;
  parameters.hysteretic_displacement_m = 0.0;
  EXPECT_THROW(MrDamper{parameters}, ConfigError);
  parameters = kDamper;
  parameters.damping_n_s_per_m = -1.0;
  EXPECT_THROW(MrDamper{parameters}, ConfigError);
}

}  // namespace
}  // namespace hybridtest
