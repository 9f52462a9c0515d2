#include "validation/blind_batches/score/answers.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace hybridtest::blind {
namespace {

TEST(Statistics, WilsonIntervalsMatchTextbook) {
  // Agresti and Coull (Am. Stat. 52, 1998): at 0 of n the interval ends at z^2 / (n + z^2).
  const double z2 = 1.959963984540054 * 1.959963984540054;
  EXPECT_NEAR(proportion(0, 20)->high, z2 / (20.0 + z2), 1e-12);
  EXPECT_DOUBLE_EQ(proportion(0, 20)->low, 0.0);
  EXPECT_NEAR(proportion(20, 20)->low, 20.0 / (20.0 + z2), 1e-12);
  EXPECT_NEAR(proportion(81, 263)->low, 0.2553, 1e-4);  // Newcombe (Stat. Med. 17, 1998), table I
  EXPECT_NEAR(proportion(81, 263)->high, 0.3662, 1e-4);
  EXPECT_FALSE(proportion(0, 0).has_value());
}

TEST(Statistics, BootstrapOfMeanMatchesStandardError) {
  std::vector<double> values;
  for (int i = 0; i < 400; ++i) values.push_back(i % 2 == 0 ? 1.0 : 3.0);
  const Estimate found = mean(values).value();
  EXPECT_DOUBLE_EQ(found.value, 2.0);
  // Standard error 1 / sqrt(400); the percentile of 2000 draws is right to about 4 %, three times that.
  EXPECT_NEAR(found.high - found.low, 2.0 * 1.96 * 0.05, 0.12 * 2.0 * 1.96 * 0.05);
  EXPECT_DOUBLE_EQ(median({1.0, 9.0, 2.0})->value, 2.0);
  EXPECT_DOUBLE_EQ(median({1.0, 9.0, 2.0, 4.0})->value, 3.0);
}

TEST(Statistics, CalibrationErrorIsWeightedBinDistance) {
  // 0.95 said eight times, six came true: |7.6 - 6|; 0.25 said twice, both true: |0.5 - 2|; over ten.
  std::vector<Forecast> forecasts(8, {0.95, true});
  forecasts[0].came_true = forecasts[1].came_true = false;
  forecasts.insert(forecasts.end(), 2, {0.25, true});
  EXPECT_NEAR(calibration_error(forecasts)->value, (1.6 + 1.5) / 10.0, 1e-12);
  EXPECT_NEAR(calibration_error({{1.0, true}, {0.0, false}})->value, 0.0, 1e-12);
}

}  // namespace
}  // namespace hybridtest::blind
