#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "validation/studies/compensator_character/frequency_response.hpp"
#include "validation/studies/compensator_character/loop_damping.hpp"
#include "validation/studies/compensator_character/noise_gain.hpp"

namespace hybridtest::character {
namespace {

CompensationMethod method(std::string_view name) {
  const auto methods = compensation_methods();
  return *std::ranges::find(methods, name, &CompensationMethod::name);
}

/// Of the cubic through points a delay apart, evaluated the delay ahead, behind that delay.
std::complex<double> cubic_behind_delay(double angle) {
  constexpr double kWeights[] = {4.0, -6.0, 4.0, -1.0};
  std::complex<double> sum = 0.0;
  for (int j = 0; j < 4; ++j) sum += kWeights[j] * std::polar(1.0, -(j + 1) * angle);
  return sum;
}

TEST(FrequencyResponse, PureDelayHasItsPhase) {
  const StandKind stand = pure_delay_stand();
  for (const double frequency_hz : {0.7, 3.0, 11.0}) {
    const auto response = measured_response(method("none"), stand, frequency_hz);
    EXPECT_NEAR(std::abs(response), 1.0, 1e-9);
    EXPECT_NEAR(effective_delay_s(response, frequency_hz), 0.020, 1e-9);
  }
}

TEST(FrequencyResponse, PolynomialsMatchSumOfWeights) {
  for (const char* name : {"polynomial_displacement", "polynomial_force"}) {
    for (const double frequency_hz : {1.0, 4.0, 9.0}) {
      const auto response = measured_response(method(name), pure_delay_stand(), frequency_hz);
      const auto wanted = cubic_behind_delay(2.0 * std::numbers::pi * frequency_hz * 0.020);
      EXPECT_NEAR(std::abs(response - wanted), 0.0, 1e-8) << name << ", " << frequency_hz << " Hz";
    }
  }
}

TEST(FrequencyResponse, NewmarkKinematicsMatchTaylorSeries) {
  const double angle = 2.0 * std::numbers::pi * 5.0 * 0.020;
  const auto response = measured_response(method("newmark_kinematics"), pure_delay_stand(), 5.0);
  const auto wanted = std::complex{1.0 - angle * angle / 2.0, angle} * std::polar(1.0, -angle);
  EXPECT_NEAR(std::abs(response - wanted), 0.0, 1e-8);
}

TEST(FrequencyResponse, BenchmarkActuatorIncludesLoopDelay) {
  // The nominal delay is that at 3.5 Hz with half a period of hold; the structure gets the force one period late and
  // holds it, which is one and a half more.
  const StandKind stand = benchmark_stand();
  const auto response = measured_response(method("none"), stand, 3.5);
  EXPECT_NEAR(effective_delay_s(response, 3.5), stand.delay_s + 1.5 * stand.period_s, 2e-6);
}

TEST(NoiseGain, PolynomialsMatchRootOfSquaredWeights) {
  const double wanted = std::sqrt(16.0 + 36.0 + 16.0 + 1.0);
  // 8 s at 4096 Hz: the square root of a mean of 32768 squares scatters by 0.4 %.
  EXPECT_NEAR(measured_noise_gain(method("polynomial_displacement"), benchmark_stand()).target_to_command, wanted,
              0.02 * wanted);
  EXPECT_NEAR(measured_noise_gain(method("polynomial_force"), benchmark_stand()).force_to_force, wanted, 0.02 * wanted);
}

TEST(NoiseGain, IsOneWithoutCompensation) {
  const NoiseGain gain = measured_noise_gain(method("newmark_kinematics"), benchmark_stand());
  EXPECT_NEAR(gain.target_to_command, 1.0, 0.02);
  EXPECT_NEAR(gain.force_to_force, 1.0, 0.02);
  EXPECT_EQ(gain.displacement_to_command, 0.0);
}

/// Damping ratio of the root of s^2 + 2 zeta s + exp(-s angle) = 0 near i, in units of omega.
double delayed_damping(double damping, double angle) {
  std::complex<double> s{-damping, 1.0};
  for (int i = 0; i < 50; ++i) {
    const auto value = s * s + 2.0 * damping * s + std::exp(-s * angle);
    s -= value / (2.0 * s + 2.0 * damping - angle * std::exp(-s * angle));
  }
  return -s.real();
}

TEST(LoopDamping, UncompensatedMatchesCharacteristicRoot) {
  for (const double angle : {0.02, 0.1, 0.3, 0.6}) {
    // The step of the integration, 1 ms over 20 ms of delay: (omega dt)^2 / 24 in frequency and a like share in
    // damping.
    const double wanted = delayed_damping(0.02, angle);
    EXPECT_NEAR(measured_loop_damping(method("none"), angle, 0.02), wanted, 2e-3 * std::abs(wanted) + 1e-4) << angle;
  }
}

TEST(LoopDamping, EqualsStructureDampingWithGoodCompensation) {
  // The cubic leaves (omega delay)^4 of the amplitude.
  EXPECT_NEAR(measured_loop_damping(method("polynomial_displacement"), 0.1, 0.02), 0.02, 1e-4);
  EXPECT_NEAR(measured_loop_damping(method("polynomial_force"), 0.1, 0.02), 0.02, 1e-4);
}

TEST(LoopDamping, IsNegativeForUnstableMethod) {
  EXPECT_LT(measured_loop_damping(method("polynomial_displacement"), 1.0, 0.02), 0.0);
  EXPECT_LT(measured_loop_damping(method("none"), 2.0, 0.02), 0.0);
}

TEST(StabilityLimit, InterpolatesBetweenDecayAndGrowth) {
  const StabilityLimit limit = stability_limit({1.0, 2.0, 3.0, 4.0}, {0.02, 0.01, -0.03, 0.5});
  EXPECT_TRUE(limit.is_reached);
  EXPECT_DOUBLE_EQ(limit.omega_delay, 2.25);
  EXPECT_FALSE(stability_limit({1.0, 2.0}, {0.02, 0.01}).is_reached);
  EXPECT_DOUBLE_EQ(stability_limit({1.0, 2.0}, {-0.02, 0.01}).omega_delay, 1.0);
}

}  // namespace
}  // namespace hybridtest::character
