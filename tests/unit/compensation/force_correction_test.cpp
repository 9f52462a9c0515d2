#include "compensation/force_correction.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "compensation/force_correction_quadratic.hpp"
#include "core/config_error.hpp"
#include "core/random.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1.0 / 1024.0;

TEST(ForceCorrection, IsExactForQuadraticsOnceRootIsFound) {
  const auto displacement_m = [](double t) { return 0.01 + 0.5 * t - 0.2 * t * t; };
  const auto force_n = [](double t) { return 300.0 - 2000.0 * t + 9000.0 * t * t; };
  for (const double lag_s : {0.0, 5.3e-3, 20e-3}) {
    ForceCorrection correction{{}, kPeriod_s};
    for (int i = 0; i < 300; ++i) {
      const double t = kPeriod_s * i;
      const double answer =
          correction.corrected_force({displacement_m(t), displacement_m(t - lag_s), force_n(t - lag_s)});
      if (i < 100) continue;  // the window of 30 ms, and as long again until the root has followed
      ASSERT_NEAR(correction.root_s(), lag_s, 1e-12);
      ASSERT_NEAR(answer, force_n(t), 1e-7);  // rounding of roots and stiffness
    }
  }
}

TEST(ForceCorrection, IsExactForElasticSpecimenWithoutRoot) {
  // Stiffness known beforehand, no horizon at all, so that the root has nowhere to go.
  ForceCorrection::Parameters parameters;
  parameters.horizon_s = 0.0;
  parameters.stiffness_n_per_m = 2e6;
  ForceCorrection correction{parameters, kPeriod_s};
  for (int i = 0; i < 3000; ++i) {
    const double t = kPeriod_s * i;
    const double desired_m = 0.01 * std::sin(12.0 * t);
    const double measured_m = 0.01 * std::sin(12.0 * t - 0.3);
    ASSERT_NEAR(correction.corrected_force({desired_m, measured_m, 2e6 * measured_m}), 2e6 * desired_m, 1e-8);
  }
}

TEST(ForceCorrection, ChoosesRootOnCorrectSideOfPeak) {
  // The measured parabola turns 10 ms from now, the desired displacement is 20 ms ahead, past the peak: the root
  // nearest to now is 0, the right one 20 ms.
  ForceCorrection correction{{}, kPeriod_s};
  ForceCorrectionQuadratic published{{3, 0.010}, kPeriod_s};
  const double lag_s = 20e-3;
  double ours = 0.0;
  double nearest = 0.0;
  const auto displacement_m = [](double t) { return 0.01 - (t - 10e-3) * (t - 10e-3); };
  const auto force_n = [](double t) { return 1000.0 * t; };
  for (int i = -200; i <= 0; ++i) {
    const double t = kPeriod_s * i;
    const ForceSample sample{displacement_m(t + lag_s), displacement_m(t), force_n(t)};
    ours = correction.corrected_force(sample);
    nearest = published.corrected_force(sample);
  }
  EXPECT_NEAR(ours, force_n(lag_s), 1e-4);  // rounding: near its vertex a parabola tells time badly
  EXPECT_NEAR(nearest, force_n(0.0), 1e-4);
}

/// The largest step from one sample to the next, of a hysteretic specimen with sensor noise.
double largest_step(ForceCompensator&& correction) {
  Random random{11};
  double before_n = 0.0;
  double largest_n = 0.0;
  for (int i = 0; i < 8 * 1024; ++i) {
    const double t = kPeriod_s * i;
    const double lag_s = 0.020;
    const auto motion = [](double at, double phase) {
      return 0.01 * std::sin(9.0 * at + phase) + 0.004 * std::sin(31.0 * at + phase);
    };
    const double measured_m = motion(t - lag_s, 0.0) + 16e-6 * random.normal();
    const double force_n = 1e6 * motion(t - lag_s, 0.2) + 20.0 * random.normal();
    const double answer_n = correction.corrected_force({motion(t, 0.0), measured_m, force_n});
    if (i > 1024) largest_n = std::max(largest_n, std::abs(answer_n - before_n));
    before_n = answer_n;
  }
  return largest_n;
}

TEST(ForceCorrection, DoesNotJumpWherePublishedMethodJumps) {
  // The exact force moves by (0.01 * 9 + 0.004 * 31) m/s * 1e6 N/m / 1024 Hz = 209 N a sample. To that: noise of
  // the fits, and the root at its rate of 1 s/s across f' - k_s x', which hysteresis leaves, some 20 % of f'.
  const double smooth_n = 209.0;
  EXPECT_LT(largest_step(ForceCorrection{{}, kPeriod_s}), 2.0 * smooth_n);
  EXPECT_GT(largest_step(ForceCorrectionQuadratic{{3, 0.020}, kPeriod_s}), 5.0 * smooth_n);
}

TEST(ForceCorrection, LearnsTheSecantStiffness) {
  ForceCorrection correction{{}, kPeriod_s};  // prior 1e6
  EXPECT_EQ(correction.stiffness_n_per_m(), 1e6);
  for (int i = 0; i < 4096; ++i) {
    const double x = 0.01 * std::sin(0.01 * i);
    static_cast<void>(correction.corrected_force({x, x, 3e6 * x}));
  }
  // The prior of 0.3 mm keeps (0.3 / 7)^2 = 1.8e-3 of its say.
  EXPECT_NEAR(correction.stiffness_n_per_m(), 3e6, 2e6 * 2.5e-3);
}

TEST(ForceCorrection, RejectsParametersOutOfRange) {
  const auto refuses = [](auto change) {
    ForceCorrection::Parameters parameters;
    change(parameters);
    EXPECT_THROW((ForceCorrection{parameters, kPeriod_s}), ConfigError);
  };
  refuses([](auto& p) { p.window_s = 0.002; });
  refuses([](auto& p) { p.horizon_s = -0.01; });
  refuses([](auto& p) { p.root_rate_s_per_s_max = 0.0; });
  refuses([](auto& p) { p.stiffness_n_per_m = -1.0; });
  refuses([](auto& p) { p.stiffness_memory_s = 0.0; });
  refuses([](auto& p) { p.prior_motion_m = 0.0; });
}

}  // namespace
}  // namespace hybridtest
