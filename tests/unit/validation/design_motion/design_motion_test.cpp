#include "validation/design_motion/design_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

#include "coordinator/excitation/read_ground_motion.hpp"
#include "coordinator/integrators/central_difference.hpp"
#include "core/config_error.hpp"
#include "validation/design_motion/baseline.hpp"
#include "validation/design_motion/oscillator.hpp"

namespace hybridtest::design_motion {
namespace {

const std::filesystem::path kShipped =
    std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "launch/scenarios/ground_motions/design_ec8_c.AT2";

double largest(const std::vector<double>& values) {
  double result = 0.0;
  for (const double value : values) result = std::max(result, std::abs(value));
  return result;
}

TEST(ShippedDesignMotion, FitsTheCodeSpectrum) {
  const GroundMotion motion = read_ground_motion(kShipped);
  const auto target = spectral_target(design_spectrum({}), 0.05, 4.0, 317);
  const SpectralFit fit = spectral_fit(motion.acceleration_m_per_s2, motion.dt_s, target);
  // EN 1998-1:2004, 3.2.3.1.2(4): at least 90 % at each period, and the zero-period response.
  EXPECT_GE(fit.lowest, 0.93);
  EXPECT_LE(fit.highest, 1.07);
  EXPECT_GE(motion.peak_m_per_s2(), 0.25 * kStandardGravity_m_per_s2 * 1.15);
  EXPECT_LE(motion.peak_m_per_s2(), 1.25 * 0.25 * kStandardGravity_m_per_s2 * 1.15);
}

TEST(ShippedDesignMotion, HasRequiredDurationAndStrongPhase) {
  const GroundMotion motion = read_ground_motion(kShipped);
  EXPECT_EQ(motion.dt_s, 0.005);
  EXPECT_NEAR(motion.end_s(), 31.0, 1e-12);
  double total = 0.0;
  for (const double value : motion.acceleration_m_per_s2) total += value * value;
  double sum = 0.0;
  int strong_samples = 0;
  for (const double value : motion.acceleration_m_per_s2) {
    sum += value * value;
    if (sum > 0.05 * total && sum < 0.95 * total) ++strong_samples;
  }
  // 3.2.3.1.2(3): at least 10 s of stationary shaking.
  EXPECT_GE(strong_samples * motion.dt_s, 10.0);
}

TEST(ShippedDesignMotion, ComesToRest) {
  const GroundMotion motion = read_ground_motion(kShipped);
  const auto velocity = velocity_m_per_s(motion.acceleration_m_per_s2, motion.dt_s);
  const auto displacement = displacement_m(motion.acceleration_m_per_s2, motion.dt_s);
  // What rounding to 1e-6 g leaves: sums of 6201 steps of 3e-6 m/s2, once and twice over 31 s.
  EXPECT_LT(std::abs(velocity.back()), 5e-6);
  EXPECT_LT(std::abs(displacement.back()), 1e-4);
  EXPECT_LT(largest(displacement), 0.3);
  EXPECT_EQ(motion.acceleration_m_per_s2.front(), 0.0);
  EXPECT_EQ(motion.acceleration_m_per_s2.back(), 0.0);
}

TEST(ShippedDesignMotion, CoordinatorIntegratorGivesTheSameSpectrum) {
  const GroundMotion motion = read_ground_motion(kShipped);
  constexpr double kStep_s = 0.0005;
  for (const double period_s : {0.1, 0.4, 0.75, 2.0}) {
    const double omega = 2.0 * 3.14159265358979323846 / period_s;
    LinearStructure oscillator;
    oscillator.mass_kg = Eigen::MatrixXd::Constant(1, 1, 1.0).sparseView();
    oscillator.damping_n_s_per_m = Eigen::MatrixXd::Constant(1, 1, 0.1 * omega).sparseView();
    oscillator.initial_stiffness_n_per_m = Eigen::MatrixXd::Constant(1, 1, omega * omega).sparseView();
    oscillator.influence = Eigen::VectorXd::Ones(1);
    CentralDifference integrator{oscillator, kStep_s};
    double peak = 0.0;
    for (int step = 0; step * kStep_s <= 31.0; ++step) {
      const Eigen::VectorXd force = omega * omega * integrator.current().displacement_m;
      peak = std::max(peak, std::abs(force[0]));
      integrator.advance(force, Eigen::VectorXd::Constant(1, -motion.at(step * kStep_s)));
    }
    const auto exact = peak_response(motion.acceleration_m_per_s2, motion.dt_s, period_s, 0.05);
    // Frequency error (w dt)^2/24 of a resonant response, and 0.3 % between the spectrum's instants.
    EXPECT_NEAR(peak / std::abs(exact.pseudo_acceleration_m_per_s2), 1.0, 0.004) << period_s;
  }
}

TEST(DesignMotion, ReproducesTheShippedFileByteByByte) {
  const DesignMotionSettings settings;
  std::ifstream stream{kShipped, std::ios::binary};
  const std::string shipped{std::istreambuf_iterator<char>{stream}, std::istreambuf_iterator<char>{}};
  ASSERT_FALSE(shipped.empty()) << kShipped;
  const DesignMotion motion = design_motion(settings);
  const std::string made = at2_text(motion.acceleration_m_per_s2, settings);
  ASSERT_EQ(made.size(), shipped.size());
  const auto difference = std::mismatch(made.begin(), made.end(), shipped.begin());
  EXPECT_EQ(difference.first - made.begin(), static_cast<std::ptrdiff_t>(made.size()));
  EXPECT_LE(motion.fit.misfit(), 0.08);
}

TEST(DesignMotion, DependsOnSeedAndKeepsCodePeak) {
  DesignMotionSettings settings;
  settings.dt_s = 0.02;
  settings.iterations = 0;  // the noise as it is
  const DesignMotion first = design_motion(settings);
  settings.seed = 2;
  const DesignMotion second = design_motion(settings);
  EXPECT_NE(first.acceleration_m_per_s2, second.acceleration_m_per_s2);
  EXPECT_GE(largest(second.acceleration_m_per_s2), design_spectrum(settings).zero_period_m_per_s2() * (1.0 - 1e-12));
}

TEST(DesignMotion, RejectsSettingsOutOfRange) {
  const auto refuses = [](auto change) {
    DesignMotionSettings settings;
    settings.iterations = 0;
    change(settings);
    EXPECT_THROW(static_cast<void>(design_motion(settings)), ConfigError);
  };
  refuses([](DesignMotionSettings& settings) { settings.dt_s = 0.0; });
  refuses([](DesignMotionSettings& settings) { settings.dt_s = std::numeric_limits<double>::quiet_NaN(); });
  refuses([](DesignMotionSettings& settings) { settings.duration_s = 5.0; });
  refuses([](DesignMotionSettings& settings) { settings.ground_acceleration_g = -0.1; });
  refuses([](DesignMotionSettings& settings) { settings.iterations = -1; });
}

TEST(At2Text, RoundTrips) {
  DesignMotionSettings settings;
  settings.dt_s = 0.02;
  const std::vector<double> motion{0.0, -1.5, 2.25, -1e-9};
  const GroundMotion read = parse_ground_motion(at2_text(motion, settings), "made.AT2");
  EXPECT_EQ(read.dt_s, 0.02);
  ASSERT_EQ(read.acceleration_m_per_s2.size(), motion.size());
  for (std::size_t i = 0; i < motion.size(); ++i) {
    EXPECT_NEAR(read.acceleration_m_per_s2[i], motion[i], 0.5e-6 * kStandardGravity_m_per_s2);
  }
}

}  // namespace
}  // namespace hybridtest::design_motion
