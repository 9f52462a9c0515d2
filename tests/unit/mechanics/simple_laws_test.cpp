#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace hybridtest
