#include "mechanics/laws/power.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace hybridtest {
namespace {

TEST(PowerOf, IsThatOfTheStandardLibraryWithinItsRounding) {
  constexpr double kUnit = std::numeric_limits<double>::epsilon();
  for (const double exponent : {-7.5, -1.0, 0.2, 1.0, 1.7, 2.0, 20.0, 100.0}) {
    for (double base = 1e-9; base < 3.0; base *= 1.37) {
      const double exact = std::pow(base, exponent);
      // Below the smallest normal number digits are lost.
      if (exact < std::numeric_limits<double>::min()) continue;
      EXPECT_NEAR(power_of(base, exponent) / exact, 1.0, (1.0 + std::abs(std::log2(exact))) * kUnit)
          << base << " to the power " << exponent;
    }
  }
}

TEST(PowerOf, NothingIsNothing) {
  EXPECT_EQ(power_of(0.0, 0.2), 0.0);
  EXPECT_EQ(power_of(0.0, 3.0), 0.0);
}

}  // namespace
}  // namespace hybridtest
