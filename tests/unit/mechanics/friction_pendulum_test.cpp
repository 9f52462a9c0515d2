#include "mechanics/laws/friction_pendulum.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

constexpr FrictionPendulum::Parameters kIsolator{.weight_n = 1.0e6,
                                                 .radius_m = 2.0,
                                                 .friction_coefficient = 0.08,
                                                 .slow_friction_ratio = 0.25,
                                                 .friction_rate_s_per_m = 40.0,
                                                 .presliding_displacement_m = 0.001};

double force_after_sliding(double displacement_m, double velocity_m_per_s) {
  FrictionPendulum isolator{kIsolator};
  return isolator.trial(displacement_m, velocity_m_per_s);
}

TEST(FrictionPendulum, FrictionGrowsWithTheVelocity) {
  // Weight over radius times displacement, plus mu(v) times the weight.
  EXPECT_NEAR(force_after_sliding(0.1, 0.0), 5.0e4 + 2.0e4, 1e-8);
  EXPECT_NEAR(force_after_sliding(0.1, 0.025), 5.0e4 + 8.0e4 - 6.0e4 * std::exp(-1.0), 1e-8);
  EXPECT_NEAR(force_after_sliding(0.1, 1.0), 5.0e4 + 8.0e4, 1e-8);
  EXPECT_NEAR(force_after_sliding(-0.1, -1.0), -5.0e4 - 8.0e4, 1e-8);
}

TEST(FrictionPendulum, HoldsElasticallyBeforeItSlides) {
  EXPECT_NEAR(force_after_sliding(0.0002, 1.0), 1.0e2 + 0.2 * 8.0e4, 1e-8);
  // Slow friction is overcome after a quarter of the pre-sliding displacement.
  EXPECT_NEAR(force_after_sliding(0.0002, 0.0), 1.0e2 + 0.2 * 8.0e4, 1e-8);
  EXPECT_NEAR(force_after_sliding(0.0003, 0.0), 1.5e2 + 2.0e4, 1e-8);
}

TEST(FrictionPendulum, SlidesBackAfterTwiceThePresliding) {
  FrictionPendulum isolator{kIsolator};
  static_cast<void>(isolator.trial(0.1, 1.0));
  isolator.commit();
  EXPECT_NEAR(isolator.trial(0.0985, -1.0), 0.0985 * 5.0e5 - 0.5 * 8.0e4, 1e-7);
  EXPECT_NEAR(isolator.trial(0.098, -1.0), 0.098 * 5.0e5 - 8.0e4, 1e-7);
  EXPECT_NEAR(isolator.trial(0.0, -1.0), -8.0e4, 1e-7);
}

TEST(FrictionPendulum, RejectsParametersOutOfRange) {
  auto parameters = kIsolator;
  parameters.radius_m = 0.0;
  EXPECT_THROW(FrictionPendulum{parameters}, ConfigError);
  parameters = kIsolator;
  parameters.slow_friction_ratio = 1.1;
  EXPECT_THROW(FrictionPendulum{parameters}, ConfigError);
}

}  // namespace
}  // namespace hybridtest
