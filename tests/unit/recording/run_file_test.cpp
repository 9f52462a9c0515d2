#include "recording/run_file.hpp"

#include <gtest/gtest.h>

namespace hybridtest {
namespace {

TEST(RunFile, RolesAndDigestsRoundTripThroughText) {
  for (const Role role : {Role::coordinator, Role::numerical_substructure, Role::experimental_site}) {
    EXPECT_EQ(role_from_name(name(role)), role);
  }
  ScenarioDigest digest{};
  digest[0] = 0x0A;
  digest[31] = 0xF3;
  const std::string text = hex(digest);
  EXPECT_EQ(text, "0a" + std::string(60, '0') + "f3");
  EXPECT_EQ(digest_from_hex(text), digest);
}

TEST(RunFile, InvalidDigestTextReadsAsNone) {
  EXPECT_EQ(digest_from_hex("12"), ScenarioDigest{});
  EXPECT_EQ(digest_from_hex(std::string(62, '1') + "g0"), ScenarioDigest{});
  EXPECT_EQ(digest_from_hex(std::string(62, '1') + "1g"), ScenarioDigest{});
}

}  // namespace
}  // namespace hybridtest
