#include "core/config_error.hpp"

#include <gtest/gtest.h>

namespace hybridtest {
namespace {

TEST(ConfigError, IssueShowsKnownPartsOfItsPlace) {
  EXPECT_EQ((ConfigIssue{.file = "a.yaml", .line = 3, .column = 7, .what = "odd"}.text()), "a.yaml:3:7: odd");
  EXPECT_EQ((ConfigIssue{.file = "a.yaml", .line = 3, .column = 0, .what = "odd"}.text()), "a.yaml:3: odd");
  EXPECT_EQ((ConfigIssue{.file = "a.yaml", .line = 0, .column = 0, .what = "odd"}.text()), "a.yaml: odd");
  EXPECT_EQ((ConfigIssue{.file = "", .line = 0, .column = 0, .what = "odd"}.text()), "odd");
}

TEST(ConfigError, TextOnlyErrorHasOneIssueWithoutPlace) {
  const ConfigError error{"order must be 1 to 4"};
  EXPECT_STREQ(error.what(), "order must be 1 to 4");
  ASSERT_EQ(error.issues().size(), 1U);
  EXPECT_EQ(error.issues()[0].text(), "order must be 1 to 4");
}

TEST(ConfigError, ListsEachIssueOnItsOwnLine) {
  const ConfigError error{{ConfigIssue{.file = "a.yaml", .line = 1, .column = 2, .what = "x"},
                           ConfigIssue{.file = "a.yaml", .line = 3, .column = 4, .what = "y"}}};
  EXPECT_STREQ(error.what(), "a.yaml:1:2: x\na.yaml:3:4: y");
}

}  // namespace
}  // namespace hybridtest
