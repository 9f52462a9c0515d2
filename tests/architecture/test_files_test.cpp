#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <string>
#include <vector>

#include "tests/architecture/source_tree.hpp"

// Names of tests are short enough to be read as a list; a file called *_test holds tests and stands below tests/.
namespace hybridtest::architecture {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::size_t kNameLength_max = 60;

struct TestName {
  std::string file;
  std::string name;
};

std::vector<TestName> names_of_tests(const std::vector<SourceFile>& files) {
  static const std::regex kTest{R"(\b(?:TEST|TEST_F|TEST_P|TYPED_TEST|TYPED_TEST_P)\s*\(\s*\w+\s*,\s*(\w+)\s*\))"};
  std::vector<TestName> names;
  for (const SourceFile& file : files) {
    const std::string code = code_alone(file.text);
    for (auto test = std::sregex_iterator{code.begin(), code.end(), kTest}; test != std::sregex_iterator{}; ++test) {
      names.push_back({file.path, (*test)[1]});
    }
  }
  return names;
}

std::vector<std::string> too_long(const std::vector<SourceFile>& files) {
  std::vector<std::string> found;
  for (const auto& [file, name] : names_of_tests(files)) {
    if (name.size() > kNameLength_max) found.push_back(std::string{file}.append(": ").append(name));
  }
  return found;
}

/// Files whose name says that they are tests, and that are none; also outside tests/.
std::vector<std::string> misnamed(const std::vector<SourceFile>& files) {
  std::vector<std::string> found;
  for (const SourceFile& file : files) {
    const std::string stem = file.path.substr(0, file.path.rfind('.'));
    if (!stem.ends_with("_test")) continue;
    if (!file.path.starts_with("tests/") || names_of_tests({file}).empty()) found.push_back(file.path);
  }
  return found;
}

TEST(TestNames, HaveAtMostSixtyCharacters) {
  const std::vector<SourceFile> files = read_sources(HYBRIDTEST_SOURCE_DIR);
  ASSERT_GT(names_of_tests(files).size(), 1000U) << "the tests were not read";
  EXPECT_THAT(too_long(files), IsEmpty());
}

TEST(TestNames, LongerNameIsReported) {
  const std::string longest(60, 'A');
  EXPECT_THAT(too_long({{"tests/a_test.cpp", "TEST(Suite, " + longest + ") {}\nTEST_P(\n    Suite, " + longest +
                                                 "B) {}\n" + "// TEST(Suite, " + longest + "C) {}\n"}}),
              ElementsAre("tests/a_test.cpp: " + longest + "B"));
}

TEST(TestFiles, NamedTestOnlyWhenTheyHoldTests) {
  EXPECT_THAT(misnamed(read_sources(HYBRIDTEST_SOURCE_DIR)), IsEmpty());
}

TEST(TestFiles, MisnamedFileIsReported) {
  EXPECT_THAT(misnamed({{"diagnosis/rerun_test.cpp", "TEST(Suite, Name) {}\n"},
                        {"diagnosis/rerun_test.hpp", "int a;\n"},
                        {"tests/unit/core/empty_test.cpp", "// TEST(Suite, Name)\n"},
                        {"tests/unit/core/good_test.cpp", "TYPED_TEST(Suite, Name) {}\n"},
                        {"tests/unit/core/testing.cpp", "int b;\n"}}),
              ElementsAre("diagnosis/rerun_test.cpp", "diagnosis/rerun_test.hpp", "tests/unit/core/empty_test.cpp"));
}

}  // namespace
}  // namespace hybridtest::architecture
