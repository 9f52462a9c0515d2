#include "compensation/upper_bound_delay.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config_error.hpp"
#include "tests/unit/compensation/frequency_response.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1.0 / 1024.0;

TEST(UpperBoundDelay, ExtrapolatesByTheBound) {
  constexpr double kBound_s = 24 * kPeriod_s;
  const auto closed_form = [](double omega) {
    const Complex z = std::polar(1.0, -omega * kBound_s);
    return 4.0 - 6.0 * z + 4.0 * z * z - z * z * z;
  };
  expect_frequency_response(
      [] {
        return UpperBoundDelay{{kBound_s, 3, 0.0}, kPeriod_s};
      },
      closed_form, [](double) { return 1e-12; },  // rounding, 15 times
      kPeriod_s, 72);
}

TEST(UpperBoundDelay, IsTheIdentityAtZero) {
  UpperBoundDelay compensator{{0.0, 3, 0.0}, kPeriod_s};
  for (int i = 0; i < 50; ++i) {
    const double target_m = std::sin(0.7 * i * i);
    ASSERT_EQ(compensator.command({target_m, 0.0, 0.0, 0.0, 0.0}), target_m);
  }
}

TEST(UpperBoundDelay, RejectsParametersOutOfRange) {
  EXPECT_THROW((UpperBoundDelay{{-0.01, 3, 0.0}, kPeriod_s}), ConfigError);
  EXPECT_THROW((UpperBoundDelay{{0.02, 0, 0.0}, kPeriod_s}), ConfigError);
  EXPECT_THROW((UpperBoundDelay{{0.02, 3, 0.001}, kPeriod_s}), ConfigError);
}

}  // namespace
}  // namespace hybridtest
