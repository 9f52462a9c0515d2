#include "core/ground_motion_facts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hybridtest {
namespace {

TEST(GroundMotionFacts, WarnsOutsidePlausiblePeaksOnly) {
  const auto warning = [](double peak_g) {
    return ground_motion_warning({.peak_m_per_s2 = peak_g * kStandardGravity_m_per_s2});
  };
  for (const double peak_g : {0.0101, 0.3, 2.99}) EXPECT_EQ(warning(peak_g), "") << peak_g;
  EXPECT_THAT(warning(0.0099), testing::HasSubstr("a peak of 0.0099 g, expected 0.01 to 3 g; check excitation.unit"));
  EXPECT_THAT(warning(3.01), testing::HasSubstr("a peak of 3.01 g"));
  EXPECT_THAT(warning(0.0), testing::HasSubstr("a peak of 0 g"));
}

}  // namespace
}  // namespace hybridtest
