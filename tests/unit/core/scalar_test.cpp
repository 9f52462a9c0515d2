#include "core/text/scalar.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "core/random.hpp"

namespace hybridtest::config {
namespace {

TEST(ConfigScalar, WritesShortestRoundTrippingText) {
  EXPECT_EQ(written_number(0.1), "0.1");
  EXPECT_EQ(written_number(20.0e3), "20000");
  EXPECT_EQ(written_number(1e-5), "1.0e-05");
  EXPECT_EQ(written_number(1.5e300), "1.5e+300");
  EXPECT_EQ(written_number(-0.0), "-0");
}

TEST(ConfigScalar, EveryDoubleReadsBackToItsBits) {
  Random random{1};
  int finite = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::uint64_t bits = random.bits();
    double value = 0.0;
    std::memcpy(&value, &bits, sizeof value);
    if (!std::isfinite(value)) continue;
    ++finite;
    const Real real = read_real(written_number(value));
    ASSERT_EQ(real.form, NumberForm::number) << written_number(value);
    ASSERT_EQ(std::memcmp(&real.value, &value, sizeof value), 0) << written_number(value);
  }
  EXPECT_GT(finite, 19000);
}

TEST(ConfigScalar, DistinguishesNumberFormats) {
  for (const char* const text : {"1", "-1.5", "+2", ".5", "5.", "1e5", "1.E-5", "007"})
    EXPECT_EQ(read_real(text).form, NumberForm::number) << text;
  for (const char* const text :
       {"", "+", "-", ".", "e5", "1e", "1e+", "--1", "1 ", " 1", "1f", "0x1p3", "1_0", "1.2.3"})
    EXPECT_EQ(read_real(text).form, NumberForm::not_a_number) << text;
  for (const char* const text : {"nan", ".NaN", "inf", "-.inf", "+.INF", "Infinity"})
    EXPECT_EQ(read_real(text).form, NumberForm::not_finite) << text;
  EXPECT_EQ(read_real("1e999").form, NumberForm::not_representable);
  EXPECT_EQ(read_real("-1e-999").form, NumberForm::not_representable);
}

TEST(ConfigScalar, ReadsWholeNumbersOfSixtyFourBits) {
  EXPECT_EQ(read_whole("9223372036854775807").value, INT64_MAX);
  EXPECT_EQ(read_whole("-9223372036854775808").value, INT64_MIN);
  EXPECT_EQ(read_whole("+12").value, 12);
  EXPECT_EQ(read_whole("9223372036854775808").form, NumberForm::not_representable);
  EXPECT_EQ(read_whole("1.0").form, NumberForm::not_whole);
  EXPECT_EQ(read_whole("one").form, NumberForm::not_a_number);
  EXPECT_EQ(read_whole(".inf").form, NumberForm::not_finite);
}

TEST(ConfigScalar, QuotesTextThatReadersCouldMisread) {
  EXPECT_EQ(written_text("hybridtest/1"), "hybridtest/1");
  EXPECT_EQ(written_text("floor_1"), "floor_1");
  for (const char* const text : {"", "true", "No", "null", "5", "a b", "a:", "-a", "~", "a,b", "[a", "#a"})
    EXPECT_EQ(written_text(text).front(), '"') << text;
}

TEST(ConfigScalar, MeasuresUtf8Characters) {
  EXPECT_EQ(utf8_length("a"), 1U);
  EXPECT_EQ(utf8_length("\xC3\xA9"), 2U);
  EXPECT_EQ(utf8_length("\xE2\x82\xAC"), 3U);
  EXPECT_EQ(utf8_length("\xF0\x9F\x8F\x97"), 4U);
  for (const char* const text :
       {"\x80", "\xC1\x81", "\xE0\x80\x80", "\xED\xBF\xBF", "\xF0\x8F\xBF\xBF", "\xF5\x80\x80\x80", "\xC3"})
    EXPECT_EQ(utf8_length(text), 0U);
  EXPECT_EQ(utf8_length(""), 0U);
}

}  // namespace
}  // namespace hybridtest::config
