#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/shared_data.hpp"
#include "tests/support/system_fixture.hpp"

/// The same scenario gives the same bytes in this build and in the release build beside it.
namespace hybridtest {
namespace {

/// `simulate_digest` prints the flags that it was compiled with and a SHA-256 of every record of simulated tests.
class OptimisationLevel : public SystemTest {
 protected:
  [[nodiscard]] std::string digest(const std::filesystem::path& simulate_digest, const std::string& output) const {
    StartedProgram printed{
        simulate_digest,
        {"time.duration_s=4", shipped_scenario("two_storey_one_site").string(),
         shipped_scenario("two_storey_two_sites").string(), shipped_scenario("three_storey_base_isolated").string()},
        directory() / output};
    EXPECT_THAT(printed.wait(), ::testing::Optional(kExitCompleted)) << printed.standard_error();
    return printed.standard_output();
  }
};

TEST_F(OptimisationLevel, RecordsAreThoseOfTheReleaseBuild) {
  const std::filesystem::path own = program("simulate_digest");
  const std::filesystem::path release =
      own.parent_path().parent_path().parent_path() / "release" / "bin" / own.filename();
  if (own == release) GTEST_SKIP() << "this is the release build: the others compare themselves with it";
  HYBRIDTEST_NEEDS_DATA(release);
  const std::string here = digest(own, "here");
  const std::string there = digest(release, "there");
  const auto flags = [](const std::string& text) { return text.substr(0, text.find('\n')); };
  const auto records = [](const std::string& text) { return text.substr(text.find('\n')); };
  EXPECT_NE(flags(here), flags(there)) << "two builds that are compiled alike";
  EXPECT_EQ(records(here), records(there)) << "of " << release << ", which must be a build of the same sources";
  EXPECT_NE(records(here).find("storey_1/control"), std::string::npos) << here;
}

}  // namespace
}  // namespace hybridtest
