#include "mechanics/laws/bouc_wen.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config_error.hpp"
#include "core/random.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/unit/mechanics/reference_history.hpp"

namespace hybridtest {
namespace {

constexpr double kStiffness = 4.0e6;

/// alpha = 0 and k = 1, so that the force is z.
BoucWen hysteretic_part(double n, double gamma_per_m, double beta_per_m, double ao = 1.0) {
  return BoucWen{
      {.stiffness_n_per_m = 1.0, .alpha = 0.0, .n = n, .gamma_per_m = gamma_per_m, .beta_per_m = beta_per_m, .ao = ao}};
}

double impose(BoucWen& law, double displacement_m) {
  const double force_n = law.trial(displacement_m, 0.0);
  law.commit();
  return force_n;
}

/// What the Runge-Kutta substeps leave, as a share of the ultimate z; see bouc_wen.hpp.
constexpr double kIntegration = 1e-9;
/// With n = 1 there are none: some ten roundings of numbers of up to three times the ultimate z.
constexpr double kRounding = 1e-14;

TEST(BoucWen, LoadingWithExponentOneIsExponential) {
  BoucWen law = hysteretic_part(1.0, 30.0, 70.0, 1.3);
  const double ultimate_m = 1.3 / 100.0;
  EXPECT_DOUBLE_EQ(law.ultimate_m(), ultimate_m);
  for (const double x : {1e-5, 1e-3, 0.01, 0.05, 1.0, 1e6})
    EXPECT_NEAR(law.trial(x, 0.0), ultimate_m * (1.0 - std::exp(-100.0 * x)), kRounding * ultimate_m);
}

TEST(BoucWen, UnloadingWithExponentOneIsExponential) {
  constexpr double kGamma = 30.0;
  constexpr double kBeta = 70.0;
  BoucWen law = hysteretic_part(1.0, kGamma, kBeta);
  const double begin_m = impose(law, 0.02);
  // dz/dx = 1 - (gamma - beta) z while z > 0 and x falls; gamma - beta = -40 1/m.
  const double rate = kGamma - kBeta;
  const double to_zero_m = std::log(1.0 - rate * begin_m) / -rate;
  for (const double share : {0.1, 0.5, 0.9, 1.0}) {
    const double back_m = share * to_zero_m;
    const double expected_m = 1.0 / rate - (1.0 / rate - begin_m) * std::exp(rate * back_m);
    EXPECT_NEAR(law.trial(0.02 - back_m, 0.0), expected_m, kRounding * law.ultimate_m());
  }
  // Past zero it loads the other way as a virgin does.
  const double beyond_m = 0.004;
  EXPECT_NEAR(law.trial(0.02 - to_zero_m - beyond_m, 0.0), -0.01 * (1.0 - std::exp(-100.0 * beyond_m)),
              kRounding * law.ultimate_m());
}

TEST(BoucWen, UnloadsStraightWithExponentOneAndEqualGammaAndBeta) {
  // Nearly equal ones, too: a rate that rounding decides must not.
  for (const double gamma_per_m : {50.0, std::nextafter(50.0, 51.0)}) {
    BoucWen law = hysteretic_part(1.0, gamma_per_m, 50.0);
    const double begin_m = impose(law, 0.02);
    EXPECT_NEAR(law.trial(0.02 - 0.5 * begin_m, 0.0), 0.5 * begin_m, kRounding * law.ultimate_m());
    EXPECT_NEAR(law.trial(0.02 - begin_m - 0.004, 0.0), -0.01 * (1.0 - std::exp(-0.4)), kRounding * law.ultimate_m());
  }
}

TEST(BoucWen, StaysAtItsLimitWithExponentOneAndNoBeta) {
  // dz/dx = 1 - gamma z on both ways: at z = 1 / gamma it rests, just below it comes back slowly.
  BoucWen law = hysteretic_part(1.0, 100.0, 0.0);
  EXPECT_EQ(impose(law, 1e6), law.ultimate_m());
  EXPECT_EQ(law.trial(-1e6, 0.0), law.ultimate_m());
  BoucWen below = hysteretic_part(1.0, 100.0, 0.0);
  impose(below, 0.02);
  EXPECT_NEAR(below.trial(0.01, 0.0), 0.01 * (1.0 - std::exp(-1.0)), kRounding * below.ultimate_m());
}

TEST(BoucWen, ExponentTwoMatchesClosedForm) {
  constexpr double kGamma = 1000.0;
  constexpr double kBeta = 9000.0;
  BoucWen law = hysteretic_part(2.0, kGamma, kBeta);
  const double ultimate_m = 0.01;
  const double begin_m = impose(law, 0.008);
  EXPECT_NEAR(begin_m, ultimate_m * std::tanh(0.8), kIntegration * ultimate_m);
  // dz/dx = 1 + (beta - gamma) z^2 on the way back.
  const double root = std::sqrt(kBeta - kGamma);
  const double back_m = 0.4 * std::atan(root * begin_m) / root;
  EXPECT_NEAR(law.trial(0.008 - back_m, 0.0), std::tan(std::atan(root * begin_m) - root * back_m) / root,
              kIntegration * ultimate_m);
}

TEST(BoucWen, LargeExponentsMatchInvertedEquation) {
  for (const double n : {3.0, 20.0, 100.0}) {
    BoucWen law = hysteretic_part(n, 0.5, 0.5);  // ultimate z is 1 m
    for (const double x : {0.5, 0.9, 1.0, 1.02}) {
      const double z = law.trial(x, 0.0);
      // x is the integral of 1 / (1 - v^n) from 0 to z; the series of the integrand term by term.
      double integral = 0.0;
      double power = z;
      for (int k = 0; power > 1e-18; ++k, power *= std::pow(z, n)) integral += power / (n * k + 1.0);
      // An error of z appears in x as its slope, 1 / (1 - z^n).
      EXPECT_NEAR(integral, x, 20.0 * kIntegration / (1.0 - std::pow(z, n))) << "n " << n;
    }
  }
}

TEST(BoucWen, MonotonicMotionIsIndependentOfStepCount) {
  for (const double n : {1.0, 1.1, 1.4, 2.0, 3.5, 20.0, 100.0}) {
    BoucWen in_one = hysteretic_part(n, 0.2, 0.8);
    BoucWen in_many = hysteretic_part(n, 0.2, 0.8);
    double begin = 0.0;
    for (const double target : {1.7, -0.4, 0.9, -3.0}) {
      double many = 0.0;
      for (int i = 1; i <= 97; ++i) many = impose(in_many, begin + (target - begin) * i / 97.0);
      EXPECT_NEAR(many, impose(in_one, target), 5.0 * kIntegration) << "n " << n;
      begin = target;
    }
  }
}

TEST(BoucWen, NeverExceedsUltimateForce) {
  BoucWen law = hysteretic_part(1.7, -0.2, 0.8);
  Random random{3};
  for (int i = 0; i < 2000; ++i)
    ASSERT_LE(std::abs(impose(law, random.uniform(-10.0, 10.0))), law.ultimate_m() * (1.0 + kIntegration));
}

TEST(BoucWen, InitialStiffnessIncludesAo) {
  const BoucWen law{
      {.stiffness_n_per_m = 100.0, .alpha = 0.25, .n = 2.0, .gamma_per_m = 1.0, .beta_per_m = 1.0, .ao = 2.0}};
  EXPECT_DOUBLE_EQ(law.initial_stiffness_n_per_m(), 25.0 + 75.0 * 2.0);
}

/// The one-step rule of the recorded run, backward Euler, for n = 1 and gamma = beta = c / 2:
/// written out here to tell its error from that of the law.
class BackwardEuler {
 public:
  double impose(double displacement_m) {
    const double increment_m = displacement_m - displacement_m_;
    const double unchecked_m = z_m_ + increment_m;
    const bool loads = unchecked_m * increment_m > 0.0;
    z_m_ = loads ? unchecked_m / (1.0 + 100.0 * std::abs(increment_m)) : unchecked_m;
    displacement_m_ = displacement_m;
    return kStiffness * (0.1 * displacement_m + 0.9 * z_m_);
  }

 private:
  double displacement_m_ = 0.0;
  double z_m_ = 0.0;
};

TEST(BoucWen, AgreesWithOpenSeesWithinItsStepError) {
  const auto file = shared_data("reference/two_storey_boucwen.csv");
  HYBRIDTEST_NEEDS_DATA(file);
  const ReferenceHistory reference = read_reference(file);
  BoucWen law{{.stiffness_n_per_m = kStiffness, .alpha = 0.1, .n = 1.0, .gamma_per_m = 50.0, .beta_per_m = 50.0}};
  BackwardEuler as_recorded;
  BackwardEuler half_step;
  const double peak_n = reference.largest_force_n();
  constexpr int kStepsPerSample = 20;  // 0.0005 s, that of the recorded run
  for (std::size_t i = 1; i < reference.force_n.size(); ++i) {
    double law_n = 0.0;
    double recorded_rule_n = 0.0;
    double half_step_n = 0.0;
    for (int step = 1; step <= kStepsPerSample; ++step) {
      const double displacement_m = reference.displacement_between(i - 1, static_cast<double>(step) / kStepsPerSample);
      const double middle_m = reference.displacement_between(i - 1, (step - 0.5) / kStepsPerSample);
      law_n = impose(law, displacement_m);
      recorded_rule_n = as_recorded.impose(displacement_m);
      half_step.impose(middle_m);
      half_step_n = half_step.impose(displacement_m);
    }
    // The equation and its parameters are those of the run: with its rule and its step, what
    // remains is the interpolation of its displacement.
    ASSERT_NEAR(recorded_rule_n, reference.force_n[i], 2e-5 * peak_n);
    // Its first-order error, taken out by extrapolation to a step of zero, leads to the law.
    ASSERT_NEAR(2.0 * half_step_n - recorded_rule_n, law_n, 1e-4 * peak_n);
    // So much does the recorded run itself miss.
    ASSERT_NEAR(law_n, reference.force_n[i], 2e-3 * peak_n);
  }
}

/// The bounds that bouc_wen.hpp gives, on an earthquake-like path with noise; the substeps are checked above.
TEST(BoucWen, TableAgreesWithSubsteps) {
  constexpr double kUltimate_m = 0.01;
  for (const double n : {1.0, 1.001, 1.2, 1.5, 2.0, 3.0, 5.0, 7.3, 10.0, 30.0, 100.0}) {
    for (const double unloading : {-20.0, -3.0, -0.5, 0.0, 0.5, 0.9}) {
      const double sum = std::pow(kUltimate_m, -n);
      const BoucWen::Parameters parameters{.stiffness_n_per_m = 1.0,
                                           .alpha = 0.0,
                                           .n = n,
                                           .gamma_per_m = 0.5 * sum * (1.0 + unloading),
                                           .beta_per_m = 0.5 * sum * (1.0 - unloading)};
      BoucWen exact{parameters};
      BoucWen tabulated{parameters, BoucWen::Integration::table};
      Random random{3};
      double worst_m = 0.0;
      for (int i = 0; i < 4000; ++i) {
        const double x = 0.03 * std::sin(0.013 * i) * std::sin(0.0021 * i) + 1e-4 * random.normal();
        worst_m = std::max(worst_m, std::abs(impose(exact, x) - impose(tabulated, x)));
      }
      EXPECT_LE(worst_m, (n <= 10.0 ? 6e-6 : 2e-5) * kUltimate_m) << n << " " << unloading;
      // To the limit and far beyond.
      EXPECT_NEAR(tabulated.trial(1e3, 0.0), kUltimate_m, 1e-9 * kUltimate_m) << n;
      EXPECT_NEAR(tabulated.trial(-1e3, 0.0), -kUltimate_m, 1e-9 * kUltimate_m) << n;
    }
  }
}

TEST(BoucWen, RejectsParametersOutOfRange) {
  const auto with = [](auto change) {
    BoucWen::Parameters parameters{
        .stiffness_n_per_m = 1.0, .alpha = 0.1, .n = 1.0, .gamma_per_m = 1.0, .beta_per_m = 1.0};
    change(parameters);
    return BoucWen{parameters};
  };
  EXPECT_NO_THROW(with([](auto& p) { p.gamma_per_m = -0.5; }));
  EXPECT_THROW(with([](auto& p) { p.stiffness_n_per_m = 0.0; }), ConfigError);
  EXPECT_THROW(with([](auto& p) { p.alpha = 1.1; }), ConfigError);
  EXPECT_THROW(with([](auto& p) { p.n = 0.9; }), ConfigError);
  EXPECT_THROW(with([](auto& p) { p.gamma_per_m = -1.0; }), ConfigError);
  EXPECT_THROW(with([](auto& p) { p.beta_per_m = -1.0; }), ConfigError);
  EXPECT_THROW(with([](auto& p) { p.ao = 0.0; }), ConfigError);
}

}  // namespace
}  // namespace hybridtest
