#include "diagnosis/verdict/stiffness_loss.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "mechanics/laws/bilinear.hpp"
#include "mechanics/laws/elastic.hpp"
#include "mechanics/laws/takeda.hpp"

namespace hybridtest {
namespace {

constexpr double kStiffness_n_per_m = 2.0e6;
constexpr double kYield_n = 16e3;
constexpr double kPeak_m = 0.032;

/// Sines of growing amplitude, the last of kPeak_m.
std::vector<Motion> growing_sines() {
  std::vector<Motion> motion;
  for (int i = 0; i <= 4000; ++i) {
    const double cycle = i / 1000.0;
    motion.push_back({.displacement_m = kPeak_m * std::ceil(cycle) / 4.0 * std::sin(2.0 * std::numbers::pi * cycle)});
  }
  return motion;
}

TEST(StiffnessLoss, IsThatOfTakedasUnloadingRule) {
  // (xy / xm)^alpha, xy = Fy / k, after Takeda, Sozen and Nielsen (1970).
  for (const double exponent : {0.2, 0.5}) {
    Takeda::Parameters parameters;
    parameters.stiffness_n_per_m = kStiffness_n_per_m;
    parameters.yield_force_n = kYield_n;
    parameters.unloading_exponent = exponent;
    Takeda law{parameters};
    const double expected = 1.0 - std::pow(kYield_n / kStiffness_n_per_m / kPeak_m, exponent);
    // The peak falls between two samples.
    EXPECT_NEAR(lost_stiffness(law, growing_sines()), expected, 1e-4) << exponent;
  }
}

TEST(StiffnessLoss, IsNoneWhereALawUnloadsAsItBegan) {
  Bilinear bilinear{{kStiffness_n_per_m, kYield_n, 0.05}};
  EXPECT_NEAR(lost_stiffness(bilinear, growing_sines()), 0.0, 1e-9);
  Elastic elastic{kStiffness_n_per_m};
  EXPECT_NEAR(lost_stiffness(elastic, growing_sines()), 0.0, 1e-9);
  EXPECT_EQ(lost_stiffness(elastic, std::vector<Motion>(100)), 0.0);
}

}  // namespace
}  // namespace hybridtest
