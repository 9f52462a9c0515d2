#include "core/text/short_number.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace hybridtest {
namespace {

TEST(ShortNumber, KeepsDecimalsOfUsualNumbers) {
  EXPECT_EQ(short_number(1.25, 1), "1.2");
  EXPECT_EQ(short_number(-0.0005, 3), "-0.001");
  EXPECT_EQ(short_number(9999999.0, 3), "9999999.000");
  EXPECT_EQ(short_number(2.0, 1, Sign::always), "+2.0");
}

TEST(ShortNumber, WritesHugeNumbersWithAnExponent) {
  EXPECT_EQ(short_number(1e7, 3), "1.00e+07");
  EXPECT_EQ(short_number(-1.797e308, 1), "-1.80e+308");
  EXPECT_EQ(short_number(1e300, 1, Sign::always), "+1.00e+300");
}

TEST(ShortNumber, NamesWhatIsNotFinite) {
  EXPECT_EQ(short_number(std::numeric_limits<double>::infinity(), 3), "inf");
  EXPECT_EQ(short_number(std::numeric_limits<double>::quiet_NaN(), 3), "nan");
}

}  // namespace
}  // namespace hybridtest
