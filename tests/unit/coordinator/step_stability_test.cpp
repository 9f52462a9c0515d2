#include "coordinator/preflight/step_stability.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/config_error.hpp"
#include "tests/support/structures.hpp"

namespace hybridtest {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(StepStability, IsTheShortestPeriodOverPi) {
  const VibrationModes modes = vibration_modes(test::two_storeys());
  EXPECT_NEAR(step_stability(modes).step_s_max, modes.period_s(1) / std::numbers::pi, 1e-16);
  EXPECT_EQ(step_stability(modes).highest_frequency_rad_per_s, modes.frequency_rad_per_s[1]);
}

TEST(StepStability, RejectsOnlyStepsAboveTheLimit) {
  const VibrationModes modes = vibration_modes(test::oscillator(1.0, 0.0, 400.0));  // 20 rad/s, limit 0.1 s
  EXPECT_NO_THROW(require_stable_step(modes, 0.0999999));
  EXPECT_THROW(require_stable_step(modes, 0.1000001), ConfigError);
}

TEST(StepStability, ErrorNamesFrequencyLimitAndStep) {
  const VibrationModes modes = vibration_modes(test::oscillator(1.0, 0.0, 400.0));
  try {
    require_stable_step(modes, 0.25);
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("step of 0.25 s"), HasSubstr("20 rad/s"), HasSubstr("= 0.1 s")));
  }
}

TEST(StepStability, StructureWithoutStiffnessHasNoLimit) {
  EXPECT_NO_THROW(require_stable_step(vibration_modes(test::oscillator(1.0, 0.0, 0.0)), 100.0));
}

}  // namespace
}  // namespace hybridtest
