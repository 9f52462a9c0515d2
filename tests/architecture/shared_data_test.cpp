#include "tests/support/shared_data.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "tests/architecture/source_tree.hpp"

// Recorded data may be absent. Then a test skips, and fails where they are required; no test decides that by itself.
namespace hybridtest::architecture {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr const char* kSetting = "HYBRIDTEST_REQUIRE_DATA";

/// Sets the requirement for the time of a test and puts the caller's back.
class SharedData : public testing::Test {
 protected:
  SharedData() {
    if (const char* value = std::getenv(kSetting)) callers_ = value;
  }
  ~SharedData() override {
    if (callers_) {
      ::setenv(kSetting, callers_->c_str(), 1);
    } else {
      ::unsetenv(kSetting);
    }
  }

 private:
  std::optional<std::string> callers_;
};

bool went_on = false;

void need(const char* file) {
  HYBRIDTEST_NEEDS_DATA(shared_data(file));
  went_on = true;
}

TEST_F(SharedData, AbsentFileSkipsWhenDataAreNotRequired) {
  ::unsetenv(kSetting);
  testing::TestPartResultArray results;
  {
    const testing::ScopedFakeTestPartResultReporter intercepted{
        testing::ScopedFakeTestPartResultReporter::INTERCEPT_ONLY_CURRENT_THREAD, &results};
    went_on = false;
    need("no_such_file.csv");
  }
  ASSERT_EQ(results.size(), 1);
  EXPECT_TRUE(results.GetTestPartResult(0).skipped());
  EXPECT_FALSE(went_on);
}

TEST_F(SharedData, AbsentFileFailsWhenDataAreRequired) {
  ::setenv(kSetting, "1", 1);
  EXPECT_FATAL_FAILURE(need("no_such_file.csv"), "recorded data are required");
}

TEST_F(SharedData, PresentFileLetsTheTestGoOn) {
  ::setenv(kSetting, "1", 1);
  went_on = false;
  need("/");
  EXPECT_TRUE(went_on);
}

/// Tests that look for the recorded data without the helper, and so can skip where they are required.
std::vector<std::string> bypassing(const std::vector<SourceFile>& files) {
  std::vector<std::string> found;
  for (const SourceFile& file : files) {
    if (file.path == "tests/support/shared_data.hpp") continue;
    if (code_alone(file.text).find("HYBRIDTEST_SHARED_DATA") != std::string::npos) found.push_back(file.path);
  }
  return found;
}

TEST_F(SharedData, EveryTestUsesTheHelper) { EXPECT_THAT(bypassing(read_sources(HYBRIDTEST_SOURCE_DIR)), IsEmpty()); }

TEST_F(SharedData, BypassedHelperIsFound) {
  EXPECT_THAT(bypassing({{"tests/unit/core/a_test.cpp", "if (!exists(HYBRIDTEST_SHARED_DATA \"/x\")) GTEST_SKIP();\n"},
                         {"tests/unit/core/b_test.cpp", "// HYBRIDTEST_SHARED_DATA\n"}}),
              ElementsAre("tests/unit/core/a_test.cpp"));
}

}  // namespace
}  // namespace hybridtest::architecture
