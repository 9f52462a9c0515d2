#include "compensation/polynomial_displacement.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <string>

#include "core/config_error.hpp"
#include "core/random.hpp"
#include "tests/unit/compensation/frequency_response.hpp"

namespace hybridtest {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr Duration kPeriod = 1ms;
constexpr double kPeriod_s = 1e-3;

double command(PolynomialDisplacement& compensator, double target_m) {
  CompensatorInput input;
  input.target_m = target_m;
  return compensator.command(input);
}

TEST(PolynomialDisplacement, IsTheIdentityAtZeroDelay) {
  for (int order = 1; order <= 4; ++order) {
    PolynomialDisplacement compensator{order, 0ms, kPeriod};
    for (int i = 0; i < 50; ++i) {
      const double target_m = std::sin(0.7 * i * i);
      ASSERT_EQ(command(compensator, target_m), target_m);
    }
  }
}

TEST(PolynomialDisplacement, HasThePublishedWeights) {
  // Horiuchi et al. (1999): extrapolation by one spacing, newest point first.
  constexpr std::array<std::array<double, 5>, 4> kPublished{
      {{2.0, -1.0}, {3.0, -3.0, 1.0}, {4.0, -6.0, 4.0, -1.0}, {5.0, -10.0, 10.0, -5.0, 1.0}}};
  constexpr int kSpacing = 20;
  for (int order = 1; order <= 4; ++order) {
    PolynomialDisplacement compensator{order, 20ms, kPeriod};
    EXPECT_DOUBLE_EQ(compensator.point_spacing_s(), 0.020);
    for (int i = 0; i < order * kSpacing; ++i) static_cast<void>(command(compensator, 0.0));
    // An impulse passes by: each weight in turn, nothing between the points.
    for (int i = 0; i <= (order + 1) * kSpacing; ++i) {
      const double answer = command(compensator, i == 0 ? 1.0 : 0.0);
      const auto point = static_cast<std::size_t>(i / kSpacing);
      const double expected =
          i % kSpacing == 0 && i / kSpacing <= order ? kPublished[static_cast<std::size_t>(order - 1)][point] : 0.0;
      ASSERT_DOUBLE_EQ(answer, expected) << "order " << order << ", sample " << i;
    }
    EXPECT_DOUBLE_EQ(compensator.noise_gain(), std::pow(2.0, order + 1) - 1.0);
  }
}

TEST(PolynomialDisplacement, IsExactForPolynomialsOfItsOrder) {
  const auto polynomial = [](int order, double time_s) {
    double value = 0.0;
    for (int k = order; k >= 0; --k) value = value * time_s + 1.0 / (k + 1.0);
    return value;
  };
  for (const Duration delay : {Duration{0ms}, Duration{400us}, Duration{7ms}, Duration{20480us}, Duration{40ms}}) {
    for (int order = 1; order <= 4; ++order) {
      PolynomialDisplacement compensator{order, delay, kPeriod, 5ms};
      for (int i = 0; i < 200; ++i) {
        const double time_s = kPeriod_s * i;
        const double command_m = command(compensator, polynomial(order, time_s));
        if (i < order * 5) continue;
        // Rounding, as the weights amplify it.
        ASSERT_NEAR(command_m, polynomial(order, time_s + to_seconds(delay)), 1e-15 * compensator.noise_gain());
      }
    }
  }
}

TEST(PolynomialDisplacement, IsNotExactForTheNextOrder) {
  PolynomialDisplacement compensator{2, 5ms, kPeriod};
  double command_m = 0.0;
  for (int i = 0; i <= 30; ++i) command_m = command(compensator, std::pow(kPeriod_s * i, 3));
  // The error of extrapolating t^3 by one spacing T from three points is 3! T^3.
  EXPECT_NEAR(command_m, std::pow(0.035, 3) - 6.0 * std::pow(0.005, 3), 1e-18);
}

TEST(PolynomialDisplacement, HasTheFrequencyResponseOfBackwardDifferences) {
  constexpr int kSpacing = 8;
  for (const double ahead : {0.25, 1.0, 1.3}) {
    for (int order = 1; order <= 4; ++order) {
      const PolynomialDisplacement::Parameters parameters{order, ahead * kSpacing * kPeriod_s, 8e-3};
      // Newton's form: H = sum of binomial(s + i - 1, i) (1 - z)^i with z = exp(-i omega T).
      const auto closed_form = [&](double omega) {
        const Complex difference = 1.0 - std::polar(1.0, -omega * kSpacing * kPeriod_s);
        Complex response = 1.0;
        Complex term = 1.0;
        for (int i = 1; i <= order; ++i) {
          term *= (ahead + i - 1) / i * difference;
          response += term;
        }
        return response;
      };
      expect_frequency_response(
          [&] {
            return PolynomialDisplacement{parameters, kPeriod_s};
          },
          closed_form, [](double) { return 1e-12; },  // rounding, times a noise gain up to 60
          kPeriod_s, order * kSpacing);
    }
  }
}

TEST(PolynomialDisplacement, AmplifiesWhiteNoiseByTheRootOfItsSquaredWeights) {
  // (4, -6, 4, -1): variance 69, sum of magnitudes 15.
  PolynomialDisplacement compensator{{3, 5e-3, 5e-3}, kPeriod_s};
  EXPECT_DOUBLE_EQ(compensator.noise_gain(), 15.0);
  Random random{7};
  constexpr int kSamples = 200'000;
  double square = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double answer = command(compensator, random.normal());
    square += answer * answer;
  }
  // Four standard deviations of the variance's estimate. Answers at point distance are correlated by -52, 22
  // and -4 in 69, whose squares, twice, and one make 2.35.
  EXPECT_NEAR(square / kSamples, 69.0, 69.0 * 4.0 * std::sqrt(2.35 * 2.0 / kSamples));
}

TEST(PolynomialDisplacement, StartsWithOrderThatHistoryAllows) {
  PolynomialDisplacement compensator{3, 2ms, kPeriod};  // points 2 samples apart
  const auto cubic = [](double time_s) { return 0.1 + 3.0 * time_s; };
  for (int i = 0; i < 20; ++i) {
    const double time_s = kPeriod_s * i;
    const double command_m = command(compensator, cubic(time_s));
    // No jump from a history that never was: the target itself, then the straight line exactly.
    ASSERT_NEAR(command_m, i < 2 ? cubic(time_s) : cubic(time_s + 2e-3), 1e-15);
  }
}

TEST(PolynomialDisplacement, ResetForgetsHistory) {
  PolynomialDisplacement compensator{4, 3ms, kPeriod};
  for (int i = 0; i < 100; ++i) static_cast<void>(command(compensator, 1.0 * i));
  compensator.reset();
  for (int i = 0; i < 40; ++i) ASSERT_NEAR(command(compensator, 7.0), 7.0, 1e-13);
}

TEST(PolynomialDisplacement, FollowsAChangedDelayWithinItsBounds) {
  PolynomialDisplacement compensator{2, 10ms, kPeriod};
  for (int i = 0; i < 50; ++i) static_cast<void>(command(compensator, kPeriod_s * i));
  compensator.set_delay(4e-3);
  EXPECT_NEAR(command(compensator, 0.05), 0.054, 1e-15);
  compensator.set_delay(-3e-3);
  EXPECT_EQ(compensator.delay_s(), 0.0);
  EXPECT_EQ(command(compensator, 0.051), 0.051);
  compensator.set_delay(10.0);
  EXPECT_DOUBLE_EQ(compensator.delay_s(), 0.080);
  EXPECT_NEAR(command(compensator, 0.052), 0.052 + 0.08, 1e-14);
  compensator.set_delay(std::nan(""));
  EXPECT_DOUBLE_EQ(compensator.delay_s(), 0.080);
  compensator.reset();
  EXPECT_DOUBLE_EQ(compensator.delay_s(), 0.010);
}

TEST(PolynomialDisplacement, SpacesItsPointsByTheRoundedDelay) {
  constexpr double kPeriod1024_s = 1.0 / 1024.0;
  const auto spacing_s = [](double delay_s, double spacing) {
    return PolynomialDisplacement{{3, delay_s, spacing}, kPeriod1024_s}.point_spacing_s();
  };
  EXPECT_DOUBLE_EQ(spacing_s(20e-3, 0.0), 20 * kPeriod1024_s);
  EXPECT_DOUBLE_EQ(spacing_s(100e-6, 0.0), kPeriod1024_s);
  EXPECT_DOUBLE_EQ(spacing_s(20e-3, 7 * kPeriod1024_s), 7 * kPeriod1024_s);
  EXPECT_DOUBLE_EQ(spacing_s(20e-3, 4e-3), 4 * kPeriod1024_s);
}

std::string refusal(int order, Duration delay, Duration period, Duration spacing = Duration::zero()) {
  try {
    const PolynomialDisplacement compensator{order, delay, period, spacing};
  } catch (const ConfigError& error) {
    return error.what();
  }
  return {};
}

TEST(PolynomialDisplacement, RejectsParametersOutOfRangeAndSaysWhy) {
  EXPECT_EQ(refusal(0, 1ms, 1ms), "order is 0; expected an integer from 1 to 4");
  EXPECT_EQ(refusal(5, 1ms, 1ms), "order is 5; expected an integer from 1 to 4");
  EXPECT_THAT(refusal(1, -1ms, 1ms), HasSubstr("delay is -0.001 s; expected at least 0 s"));
  EXPECT_THAT(refusal(1, 1ms, 0ms), HasSubstr("control period"));
  EXPECT_THAT(refusal(1, 1ms, 1ms, -1ms), HasSubstr("point spacing is -0.001 s"));
  EXPECT_EQ(refusal(1, 16ms, 1ms, 2ms), "");
  EXPECT_THAT(refusal(1, 17ms, 1ms, 2ms), HasSubstr("delay is 0.017 s; expected at most 8 point spacings of 0.002 s"));
  EXPECT_EQ(refusal(1, 10s, 1ms), "");
  EXPECT_THAT(refusal(1, 11s, 1ms), HasSubstr("delay is 11 s; expected at most 10000 control periods"));
}

}  // namespace
}  // namespace hybridtest
