#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

/// The code in docs/writing_a_rig.md is the code that is compiled and tested here.
namespace hybridtest {
namespace {

std::string text_of(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream{std::string{HYBRIDTEST_SOURCE_DIR} + "/" + file}.rdbuf();
  return text.str();
}

TEST(WritingARig, QuotesTheCompiledExample) {
  const std::string mark = "// [example]\n";
  const std::string source = text_of("tests/contract/rigs/example_rig.hpp");
  const std::size_t begin = source.find(mark) + mark.size();
  const std::size_t end = source.find(mark, begin);
  ASSERT_NE(end, std::string::npos);
  const std::string example = source.substr(begin, end - begin);
  ASSERT_GT(example.size(), 500U);
  EXPECT_NE(text_of("docs/writing_a_rig.md").find("```cpp\n" + example + "```\n"), std::string::npos)
      << "docs/writing_a_rig.md quotes something else than tests/contract/rigs/example_rig.hpp";
}

}  // namespace
}  // namespace hybridtest
