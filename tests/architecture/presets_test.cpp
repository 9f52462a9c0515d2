#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace hybridtest::architecture {
namespace {

/// The filters of test presets: what begins with ^ in quotes.
std::vector<std::string> filters_in(const std::string& presets) {
  static const std::regex filter{R"rx("name":\s*"(\^[^"]*)")rx"};
  std::vector<std::string> filters;
  for (std::sregex_iterator at{presets.begin(), presets.end(), filter}, end; at != end; ++at) {
    filters.push_back((*at)[1]);
  }
  return filters;
}

// CMake's expressions hold nine groups. CTest leaves out nothing by one that has more, and says so in one line.
TEST(Presets, FiltersHaveNoMoreGroupsThanCtestTakes) {
  std::ifstream in{std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "CMakePresets.json"};
  std::ostringstream text;
  text << in.rdbuf();
  const std::vector<std::string> filters = filters_in(text.str());
  EXPECT_EQ(filters.size(), 3U) << "include and exclude of asan-ubsan, include of tsan";
  for (const std::string& filter : filters) EXPECT_LE(std::ranges::count(filter, '('), 9) << filter;
}

TEST(Presets, FiltersAreFound) {  // control
  const std::vector<std::string> found = filters_in("{\"exclude\": {\"name\": \"^(a|(b))\"}, \"name\": \"base\"}");
  EXPECT_EQ(found, std::vector<std::string>{"^(a|(b))"});
}

}  // namespace
}  // namespace hybridtest::architecture
