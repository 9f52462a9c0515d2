#include "compensation/low_pass.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "core/config_error.hpp"
#include "tests/unit/compensation/frequency_response.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1.0 / 4096.0;

TEST(LowPass, HasTheFrequencyResponseOfButterworthsPoles) {
  // Poles of the fourth order on the unit circle at 112.5, 157.5, 202.5 and 247.5 degrees; the bilinear
  // transform takes w to tan(w T / 2).
  const double corner = std::tan(std::numbers::pi * 20.0 * kPeriod_s);
  for (const double frequency_hz : twenty_frequencies_hz(0.5, 200.0)) {
    const double omega = 2.0 * std::numbers::pi * frequency_hz;
    const Complex s{0.0, std::tan(0.5 * omega * kPeriod_s) / corner};
    Complex response = 1.0;
    for (const double degrees : {112.5, 157.5, 202.5, 247.5}) {
      const Complex pole = std::polar(1.0, degrees * std::numbers::pi / 180.0);
      response *= -pole / (s - pole);
    }
    LowPass filter{20.0, kPeriod_s};
    for (int i = 0; i < 4096; ++i) {
      const Complex phasor = std::polar(1.0, omega * kPeriod_s * i);
      const double out = filter.filter(phasor.imag());
      // After 0.8 s its slowest pole, 0.38 of 126 per second, has faded to 2e-17.
      if (i <= 3300) continue;
      ASSERT_NEAR(out, (response * phasor).imag(), 1e-12) << frequency_hz;
    }
  }
}

TEST(LowPass, ResetRestoresInitialState) {
  LowPass used{20.0, kPeriod_s};
  LowPass fresh{20.0, kPeriod_s};
  for (int i = 0; i < 100; ++i) static_cast<void>(used.filter(i));
  used.reset();
  for (int i = 0; i < 100; ++i) ASSERT_EQ(used.filter(std::sin(i)), fresh.filter(std::sin(i)));
}

TEST(LowPass, RejectsCornerAboveSampleRate) {
  EXPECT_THROW((LowPass{2000.0, kPeriod_s}), ConfigError);
  EXPECT_THROW((LowPass{0.0, kPeriod_s}), ConfigError);
  EXPECT_THROW((LowPass{20.0, 0.0}), ConfigError);
}

}  // namespace
}  // namespace hybridtest
