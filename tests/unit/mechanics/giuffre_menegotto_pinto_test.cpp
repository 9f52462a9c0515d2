#include "mechanics/laws/giuffre_menegotto_pinto.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config_error.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/unit/mechanics/reference_history.hpp"

namespace hybridtest {
namespace {

constexpr GiuffreMenegottoPinto::Parameters kColumn{
    .stiffness_n_per_m = 4.0e6, .yield_force_n = 4.0e4, .hardening_ratio = 0.03, .r0 = 18.0, .cr1 = 0.925, .cr2 = 0.15};

double impose(GiuffreMenegottoPinto& spring, double displacement_m) {
  const double force_n = spring.trial(displacement_m, 0.0);
  spring.commit();
  return force_n;
}

TEST(GiuffreMenegottoPinto, FirstBranchLiesBetweenItsAsymptotes) {
  GiuffreMenegottoPinto spring{kColumn};
  // Far below yielding, (r^R)/R of the elastic force is missing: 0.5^18 / 18 = 2e-7.
  EXPECT_NEAR(spring.trial(0.005, 0.0), 2.0e4, 2.2e-7 * 2.0e4);
  // At the corner the rounding is 2^(1/R) by definition of the curve.
  EXPECT_NEAR(spring.trial(0.01, 0.0), 4.0e4 * (0.03 + 0.97 / std::pow(2.0, 1.0 / 18.0)), 1e-9 * 4.0e4);
  // Far above it, 10^-18 / 18 is less than rounding.
  EXPECT_NEAR(spring.trial(0.1, 0.0), 4.0e4 + 0.03 * 4.0e6 * 0.09, 1e-11 * 4.0e4);
}

TEST(GiuffreMenegottoPinto, LeavesAReversalWithItsInitialStiffness) {
  GiuffreMenegottoPinto spring{kColumn};
  const double turning_n = impose(spring, 0.04);
  // (r^R) / R is what the curve lacks; R is 4.2 here, r = 1e-3.
  EXPECT_NEAR(spring.trial(0.04 - 1e-5, 0.0), turning_n - 4.0e6 * 1e-5, 1e-8 * 4.0e4);
}

TEST(GiuffreMenegottoPinto, ReversalWithinTheNoiseLeavesNoTrace) {
  constexpr double kNoise_m = 3e-4;
  GiuffreMenegottoPinto straight{kColumn};
  GiuffreMenegottoPinto steady{kColumn};
  GiuffreMenegottoPinto turning{kColumn};  // control
  steady.ignore_reversals_within(kNoise_m);
  double there_n = 0.0;
  for (const double x_m : {-0.04, -0.01}) {
    there_n = impose(straight, x_m);
    EXPECT_EQ(impose(steady, x_m), there_n);
    impose(turning, x_m);
  }
  EXPECT_DOUBLE_EQ(impose(steady, -0.0102), there_n + 4.0e6 * (-0.0102 - -0.01));
  impose(turning, -0.0102);
  const double along_n = impose(straight, 0.0);
  EXPECT_EQ(impose(steady, 0.0), along_n);
  EXPECT_GT(impose(turning, 0.0), 1.1 * along_n);
  // A longer one is a reversal where the branch ended.
  EXPECT_EQ(impose(steady, -0.0004), impose(straight, -0.0004));
  EXPECT_EQ(impose(steady, -0.03), impose(straight, -0.03));
  // Kept by reset().
  steady.reset();
  straight.reset();
  EXPECT_EQ(impose(steady, -0.04), impose(straight, -0.04));
  EXPECT_EQ(impose(steady, -0.01), impose(straight, -0.01));
  impose(steady, -0.0102);
  EXPECT_EQ(impose(steady, 0.0), impose(straight, 0.0));
}

TEST(GiuffreMenegottoPinto, CurvatureFollowsThePlasticExcursion) {
  GiuffreMenegottoPinto spring{kColumn};
  const double turning_m = 0.04;
  const double turning_n = impose(spring, turning_m);
  // Elastic line through the reversal against the lower hardening asymptote.
  const double corner_m = (-4.0e4 * 0.97 - turning_n + 4.0e6 * turning_m) / (4.0e6 * 0.97);
  const double xi = std::abs(-0.01 - corner_m) / 0.01;
  const double curvature = 18.0 * (1.0 - 0.925 * xi / (0.15 + xi));
  const double drop_n = 4.0e6 * (corner_m - turning_m) * (0.03 + 0.97 / std::pow(2.0, 1.0 / curvature));
  EXPECT_NEAR(spring.trial(corner_m, 0.0), turning_n + drop_n, 1e-9 * 4.0e4);
}

TEST(GiuffreMenegottoPinto, IsotropicHardeningMovesTheAsymptote) {
  auto parameters = kColumn;
  parameters.a1 = 0.05;
  parameters.a2 = 2.0;
  GiuffreMenegottoPinto spring{parameters};
  GiuffreMenegottoPinto kinematic{kColumn};
  impose(spring, 0.04);
  impose(kinematic, 0.04);
  const double factor = 1.0 + 0.05 * std::pow((0.04 + 0.01) / (2.0 * 2.0 * 0.01), 0.8);
  const double asymptote_n = -4.0e4 * factor * 0.97 + 0.03 * 4.0e6 * -3.0;
  // The curve comes within 1 / R of r^-R of its asymptote: r is 40.
  EXPECT_NEAR(impose(spring, -3.0), asymptote_n, 2e-5 * 4.0e4);
  EXPECT_NEAR(impose(kinematic, -3.0), -4.0e4 * 0.97 + 0.03 * 4.0e6 * -3.0, 2e-5 * 4.0e4);
}

TEST(GiuffreMenegottoPinto, FirstLoadingHasNoIsotropicHardening) {
  auto parameters = kColumn;
  parameters.a1 = parameters.a3 = 0.05;
  for (const double displacement_m : {-0.05, 0.05}) {
    GiuffreMenegottoPinto isotropic{parameters};
    GiuffreMenegottoPinto kinematic{kColumn};
    EXPECT_EQ(impose(isotropic, displacement_m), impose(kinematic, displacement_m));
  }
}

TEST(GiuffreMenegottoPinto, ReversalOnAsymptoteStaysFinite) {
  GiuffreMenegottoPinto spring{kColumn};
  impose(spring, 1.0);  // on the asymptote to rounding
  impose(spring, std::nextafter(1.0, 0.0));
  const double force_n = impose(spring, 1.001);
  const double asymptote_n = 4.0e4 + 0.03 * 4.0e6 * (1.001 - 0.01);
  EXPECT_NEAR(force_n, asymptote_n, 1e-6 * asymptote_n);
}

TEST(GiuffreMenegottoPinto, AgreesWithOpenSees) {
  const auto file = shared_data("reference/two_storey_steel02.csv");
  HYBRIDTEST_NEEDS_DATA(file);
  const ReferenceHistory reference = read_reference(file);
  GiuffreMenegottoPinto spring{kColumn};
  // As for the bilinear law. The number of steps matters to this one: a reversal between
  // samples that is missed puts it on another curve.
  constexpr int kStepsPerSample = 20;
  for (std::size_t i = 1; i < reference.force_n.size(); ++i) {
    for (int step = 1; step < kStepsPerSample; ++step)
      impose(spring, reference.displacement_between(i - 1, static_cast<double>(step) / kStepsPerSample));
    ASSERT_NEAR(impose(spring, reference.displacement_m[i]), reference.force_n[i], 2e-5 * reference.largest_force_n());
  }
}

TEST(GiuffreMenegottoPinto, RejectsParametersOutOfRange) {
  const auto with = [](auto change) {
    GiuffreMenegottoPinto::Parameters parameters = kColumn;
    change(parameters);
    return GiuffreMenegottoPinto{parameters};
  };
  EXPECT_NO_THROW(with([](auto& p) { p.cr1 = 0.0; }));
  EXPECT_THROW(with([](auto& p) { p.stiffness_n_per_m = -1.0; }), ConfigError);
  EXPECT_THROW(with([](auto& p) { p.yield_force_n = 0.0; }), ConfigError);
  EXPECT_THROW(with([](auto& p) { p.hardening_ratio = 1.0; }), ConfigError);
  EXPECT_THROW(with([](auto& p) { p.hardening_ratio = -1.0; }), ConfigError);
  EXPECT_THROW(with([](auto& p) { p.r0 = 0.0; }), ConfigError);
  EXPECT_THROW(with([](auto& p) { p.cr1 = 1.0; }), ConfigError);
  EXPECT_THROW(with([](auto& p) { p.cr2 = 0.0; }), ConfigError);
}

}  // namespace
}  // namespace hybridtest
