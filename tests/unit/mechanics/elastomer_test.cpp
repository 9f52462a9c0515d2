#include "mechanics/laws/elastomer.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

constexpr Elastomer::Parameters kMullins{
    .stiffness_n_per_m = 2.0e5, .stiffening_n_per_m3 = 1.0e7, .mullins_softening = 0.4, .mullins_displacement_m = 0.05};
constexpr Elastomer::Parameters kPayne{
    .stiffness_n_per_m = 2.0e5, .payne_force_n = 1.0e3, .payne_displacement_m = 0.002};

double elastic_n(double x) { return 2.0e5 * x + 1.0e7 * x * x * x; }
double energy_j(double x) { return 1.0e5 * x * x + 2.5e6 * x * x * x * x; }

double impose(Elastomer& rubber, double displacement_m) {
  const double force_n = rubber.trial(displacement_m, 0.0);
  rubber.commit();
  return force_n;
}

TEST(Elastomer, FirstLoadingIsNotSoftened) {
  Elastomer rubber{kMullins};
  for (const double displacement_m : {0.01, 0.05, -0.07, 0.1})
    EXPECT_NEAR(impose(rubber, displacement_m), elastic_n(displacement_m), 1e-9);
}

TEST(Elastomer, IsSofterBelowTheLargestDisplacement) {
  Elastomer rubber{kMullins};
  impose(rubber, 0.1);
  for (const double displacement_m : {0.08, 0.03, -0.03, -0.09}) {
    const double below_j = energy_j(0.1) - energy_j(displacement_m);
    const double left = 1.0 - 0.4 * std::erf(below_j / (0.5 * 2.0e5 * 0.05 * 0.05));
    EXPECT_NEAR(impose(rubber, displacement_m), left * elastic_n(displacement_m), 1e-9);
  }
  EXPECT_NEAR(impose(rubber, 0.11), elastic_n(0.11), 1e-9);
}

TEST(Elastomer, StiffnessFallsWithTheAmplitude) {
  // Peak to peak in the third cycle: steady from then on.
  const auto stiffness = [](double amplitude_m) {
    Elastomer rubber{kPayne};
    double force_n = 0.0;
    for (int cycle = 0; cycle < 3; ++cycle) {
      impose(rubber, -amplitude_m);
      force_n = impose(rubber, amplitude_m);
    }
    return force_n / amplitude_m;
  };
  EXPECT_NEAR(stiffness(1.0e-6), 2.0e5 + 1.0e3 / 0.002, 1e-3 * 7.0e5);
  EXPECT_NEAR(stiffness(0.1), 2.0e5 + 1.0e3 / 0.1, 1.0);
  EXPECT_GT(stiffness(0.0005), stiffness(0.001));
  EXPECT_GT(stiffness(0.001), stiffness(0.005));
}

TEST(Elastomer, WideCyclesDissipateFillerFriction) {
  Elastomer rubber{kPayne};
  constexpr int kSteps = 20000;
  impose(rubber, 0.1);
  double before_n = impose(rubber, 0.1);
  double work_j = 0.0;
  for (int i = 1; i <= 2 * kSteps; ++i) {
    const double displacement_m = 0.1 * (i <= kSteps ? 1.0 - 2.0 * i / kSteps : 2.0 * i / kSteps - 3.0);
    const double force_n = impose(rubber, displacement_m);
    work_j += 0.5 * (before_n + force_n) * (i <= kSteps ? -0.2 : 0.2) / kSteps;
    before_n = force_n;
  }
  // Each way: given back Fp xp / 2 while unloading over xp, then Fp over the rest but for Fp xp ln 2 of the tanh.
  EXPECT_NEAR(work_j, 2.0 * 1.0e3 * (0.2 - (1.5 + std::log(2.0)) * 0.002), 1e-2);
}

TEST(Elastomer, RejectsParametersOutOfRange) {
  auto parameters = kMullins;
  parameters.mullins_softening = 1.0;
  EXPECT_THROW(Elastomer{parameters}, ConfigError);
  parameters = kPayne;
  parameters.payne_displacement_m = 0.0;
  EXPECT_THROW(Elastomer{parameters}, ConfigError);
}

}  // namespace
}  // namespace hybridtest
