#include "core/fixed_text.hpp"

#include <gtest/gtest.h>

namespace hybridtest {
namespace {

TEST(FixedText, IsEmptyAtFirst) {
  const FixedText<4> text;
  EXPECT_TRUE(text.empty());
  EXPECT_EQ(text.view(), "");
}

TEST(FixedText, KeepsTextThatFitsExactly) {
  const FixedText<4> text{"abcd"};
  EXPECT_FALSE(text.empty());
  EXPECT_EQ(text.view(), "abcd");
  EXPECT_EQ(text.text(), "abcd");
}

TEST(FixedText, TruncatesLongerText) {
  EXPECT_EQ(FixedText<4>{"abcde"}.view(), "abcd");
  EXPECT_EQ(FixedText<4>{std::string(1000, 'x')}.view(), "xxxx");
}

TEST(FixedText, ComparesByContent) {
  const FixedText<8> text{"site"};
  EXPECT_EQ(text, FixedText<8>{std::string{"site"}});
  EXPECT_NE(text, FixedText<8>{"sites"});
  EXPECT_NE(text, FixedText<8>{});
}

TEST(FixedText, AssigningShorterTextClearsTheRest) {
  FixedText<8> text{"storey_1"};
  text = "abc";
  EXPECT_EQ(text, FixedText<8>{"abc"});
  EXPECT_EQ(text.view(), "abc");
}

TEST(FixedText, KeepsZeroBytes) {
  const FixedText<8> text{std::string_view{"a\0b", 3}};
  EXPECT_EQ(text.view().size(), 3U);
}

TEST(FixedText, WorksInConstantExpressions) {
  static_assert(FixedText<3>{"abcdef"}.view() == "abc");
  static_assert(FixedText<3>::kCapacity == 3);
}

}  // namespace
}  // namespace hybridtest
