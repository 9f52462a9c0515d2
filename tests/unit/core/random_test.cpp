#include "core/random.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace hybridtest {
namespace {

constexpr int kDraws = 100000;
/// Four standard errors: the seeds are fixed, so a test that passes once passes always.
const double kFourStandardErrors = 4.0 / std::sqrt(static_cast<double>(kDraws));

/// First output of splitmix64 from state 0, which the class mixes into the seed of stream 0.
constexpr std::uint64_t kStreamZero = 0xE220A8397B1DCDAFULL;

TEST(Random, MatchesPublishedXoshiro256PlusPlusOutputs) {
  // The outputs that the Rust crate rand pins for Xoshiro256PlusPlus seeded with 0 through splitmix64.
  constexpr std::array<std::uint64_t, 10> kPublished = {
      5987356902031041503ULL, 7051070477665621255ULL, 6633766593972829180ULL,  211316841551650330ULL,
      9136120204379184874ULL, 379361710973160858ULL,  15813423377499357806ULL, 15596884590815070553ULL,
      5439680534584881407ULL, 1369371744833522710ULL};
  Random random{kStreamZero};
  for (const std::uint64_t expected : kPublished) EXPECT_EQ(random.bits(), expected);
}

TEST(Random, SameSeedRepeatsAndOtherSeedDiffers) {
  Random first{7};
  Random again{7};
  Random other_seed{8};
  Random other_stream{7, 1};
  int equal_seeds = 0;
  int equal_streams = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::uint64_t bits = first.bits();
    ASSERT_EQ(bits, again.bits());
    if (bits == other_seed.bits()) ++equal_seeds;
    if (bits == other_stream.bits()) ++equal_streams;
  }
  EXPECT_EQ(equal_seeds, 0);
  EXPECT_EQ(equal_streams, 0);
}

TEST(Random, StreamsOfOneSeedAreUncorrelated) {
  Random a{3, 0};
  Random b{3, 1};
  double product = 0.0;
  for (int i = 0; i < kDraws; ++i) product += a.normal() * b.normal();
  EXPECT_NEAR(product / kDraws, 0.0, kFourStandardErrors);
}

TEST(Random, UniformHasUnitIntervalMoments) {
  Random random{11};
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double value = random.uniform();
    ASSERT_GE(value, 0.0);
    ASSERT_LT(value, 1.0);
    sum += value;
    squares += value * value;
  }
  EXPECT_NEAR(sum / kDraws, 1.0 / 2.0, kFourStandardErrors * std::sqrt(1.0 / 12.0));
  EXPECT_NEAR(squares / kDraws, 1.0 / 3.0, kFourStandardErrors * std::sqrt(4.0 / 45.0));
}

TEST(Random, UniformStaysInsideItsBounds) {
  Random random{12};
  double least = 5.0;
  double most = -2.0;
  for (int i = 0; i < kDraws; ++i) {
    const double value = random.uniform(-2.0, 5.0);
    ASSERT_GE(value, -2.0);
    ASSERT_LT(value, 5.0);
    least = std::min(least, value);
    most = std::max(most, value);
  }
  // The chance that none of the draws falls into the outer thousandth is exp(-100).
  EXPECT_LT(least, -2.0 + 0.007);
  EXPECT_GT(most, 5.0 - 0.007);
}

TEST(Random, BelowIsUniform) {
  Random random{13};
  constexpr std::uint64_t kCount = 7;
  std::array<int, kCount> hits{};
  for (int i = 0; i < kDraws; ++i) {
    const std::uint64_t value = random.below(kCount);
    ASSERT_LT(value, kCount);
    ++hits[value];
  }
  double chi_square = 0.0;
  const double expected = static_cast<double>(kDraws) / static_cast<double>(kCount);
  for (const int hit : hits) chi_square += (hit - expected) * (hit - expected) / expected;
  // 99.99 % quantile of chi-square with six degrees of freedom.
  EXPECT_LT(chi_square, 27.86);
}

TEST(Random, BelowOneIsZero) {
  Random random{14};
  for (int i = 0; i < 100; ++i) EXPECT_EQ(random.below(1), 0U);
}

TEST(Random, NormalHasStandardMomentsAndTails) {
  Random random{15};
  double mean = 0.0;
  double second = 0.0;
  double third = 0.0;
  double fourth = 0.0;
  int beyond = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double value = random.normal();
    mean += value / kDraws;
    second += std::pow(value, 2) / kDraws;
    third += std::pow(value, 3) / kDraws;
    fourth += std::pow(value, 4) / kDraws;
    if (std::abs(value) > 1.959963984540054) ++beyond;
  }
  // Variances of the powers of a standard normal: 1, 2, 15, 96.
  EXPECT_NEAR(mean, 0.0, kFourStandardErrors);
  EXPECT_NEAR(second, 1.0, kFourStandardErrors * std::sqrt(2.0));
  EXPECT_NEAR(third, 0.0, kFourStandardErrors * std::sqrt(15.0));
  EXPECT_NEAR(fourth, 3.0, kFourStandardErrors * std::sqrt(96.0));
  EXPECT_NEAR(static_cast<double>(beyond) / kDraws, 0.05, kFourStandardErrors * std::sqrt(0.05 * 0.95));
}

}  // namespace
}  // namespace hybridtest
