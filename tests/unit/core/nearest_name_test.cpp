#include <gtest/gtest.h>

#include "core/text/nearest_name.hpp"

namespace hybridtest {
namespace {

TEST(ConfigNearestName, FindsCommonMisspellings) {
  const std::vector<std::string> known = {"stiffness_n_per_m", "yield_force_n", "hardening_ratio", "type"};
  EXPECT_EQ(nearest_name("stifness_n_per_m", known), "stiffness_n_per_m");  // left out
  EXPECT_EQ(nearest_name("yeild_force_n", known), "yield_force_n");         // swapped
  EXPECT_EQ(nearest_name("hardenning_ratio", known), "hardening_ratio");    // doubled
  EXPECT_EQ(nearest_name("tipe", known), "type");                           // replaced
  EXPECT_EQ(nearest_name("stiffness_n_m", known), "stiffness_n_per_m");
}

TEST(ConfigNearestName, AllowsEditsUpToAThirdOfTheLength) {
  EXPECT_EQ(nearest_name("abcdef", {"abcdxy"}), "abcdxy");
  EXPECT_EQ(nearest_name("abcdef", {"abcxyz"}), std::nullopt);
  EXPECT_EQ(nearest_name("ab", {"ax"}), "ax");
  EXPECT_EQ(nearest_name("ab", {"xy"}), std::nullopt);
}

TEST(ConfigNearestName, ReturnsNothingForUnrelatedName) {
  EXPECT_EQ(nearest_name("a", {"b"}), std::nullopt);
  EXPECT_EQ(nearest_name("", {"a"}), std::nullopt);
  EXPECT_EQ(nearest_name("a", {}), std::nullopt);
  EXPECT_EQ(nearest_name("type", {""}), std::nullopt);
}

TEST(ConfigNearestName, ReturnsNearestAndFirstOfTies) {
  EXPECT_EQ(nearest_name("storey_3", {"storey_1", "storey_2"}), "storey_1");
  EXPECT_EQ(nearest_name("floor_12", {"floor_9", "floor_1"}), "floor_1");
  EXPECT_EQ(nearest_name("same", {"sane", "same"}), "same");
}

TEST(ConfigNearestName, CountsSwapAsOneEdit) {
  // Six letters allow two edits: two swaps pass, a swap and two replacements do not.
  EXPECT_EQ(nearest_name("badcef", {"abcdef"}), "abcdef");
  EXPECT_EQ(nearest_name("baxyef", {"abcdef"}), std::nullopt);
}

}  // namespace
}  // namespace hybridtest
