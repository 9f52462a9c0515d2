#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <regex>
#include <string>
#include <vector>

#include "tests/architecture/source_tree.hpp"

// diagnosis/tuning.hpp says that every chosen number of the diagnosis stands in it. Here is why that is true.
namespace hybridtest::architecture {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Numbers that are not chosen: they could not be otherwise.
constexpr std::array<std::string_view, 5> kNotChosen{
    "kPrimes",           // the first primes
    "kPowers",           // binomial coefficients
    "kThirdDifference",  // likewise
    "kHeaderRow",        // of the CSV format
    "kMains_hz",         // of the world's grids
};

bool has_its_own_numbers(const std::string& path) {
  return !path.starts_with("diagnosis/") || path.starts_with("diagnosis/page/") || path == "diagnosis/tuning.hpp";
}

/// Constants of a number type, or arrays of them, that begin with a literal.
std::vector<std::string> chosen_numbers_outside(const std::vector<SourceFile>& files) {
  static const std::regex constant{
      R"(\bconstexpr\s+(?:auto|(?:unsigned\s+)?int|float|double|(?:std::)?(?:size_t|ptrdiff_t|u?int\w*_t)|Eigen::Index|std::chrono::\w+|std::array(?:<[^;={]*>)?)\s+(k\w+)\s*(?:=\s*)?\{*\s*(?:[\w:]+\{)?\s*[-+]?\.?[0-9])"};
  std::vector<std::string> found;
  for (const SourceFile& file : files) {
    if (has_its_own_numbers(file.path)) continue;
    const std::string code = code_alone(file.text);
    for (std::sregex_iterator at{code.begin(), code.end(), constant}, end; at != end; ++at) {
      const std::string name = (*at)[1];
      const bool is_a_unit = name.ends_with("Units") || name.ends_with("Ratios");  // conversions, with their names
      if (is_a_unit || std::ranges::find(kNotChosen, name) != kNotChosen.end()) continue;
      found.push_back(file.path + ": " + name);
    }
  }
  return found;
}

TEST(Tuning, HoldsEveryChosenNumberOfTheDiagnosis) {
  const std::vector<SourceFile> files = read_sources(HYBRIDTEST_SOURCE_DIR);
  const auto is_tuning = [](const SourceFile& file) { return file.path == "diagnosis/tuning.hpp"; };
  ASSERT_TRUE(std::ranges::any_of(files, is_tuning)) << "not read";
  EXPECT_THAT(chosen_numbers_outside(files), IsEmpty()) << "move it to diagnosis/tuning.hpp, with a sentence";
}

/// Names of the constants that a file defines.
std::vector<std::string> constants_in(const std::string& text) {
  static const std::regex constant{R"(inline\s+constexpr\s+[^=;{]*?\b(k\w+)\s*[={])"};
  const std::string code = code_alone(text);
  std::vector<std::string> names;
  for (std::sregex_iterator at{code.begin(), code.end(), constant}, end; at != end; ++at) names.push_back((*at)[1]);
  return names;
}

// There are too many of them: 25 are wanted. This number may fall, and must not rise.
TEST(Tuning, HoldsNoMoreChosenNumbersThanBefore) {
  constexpr std::size_t kAtMost = 175;
  const std::vector<SourceFile> files = read_sources(HYBRIDTEST_SOURCE_DIR);
  const auto tuning = std::ranges::find(files, std::string{"diagnosis/tuning.hpp"}, &SourceFile::path);
  ASSERT_NE(tuning, files.end()) << "not read";
  EXPECT_LE(constants_in(tuning->text).size(), kAtMost)
      << "derive it, take the criterion that stands, or let it replace another one";
  EXPECT_THAT(constants_in("inline constexpr double kOne = 1.0;\n// inline constexpr int kNone = 0;\n"
                           "inline constexpr std::array<int, 2> kTwo{1, 2};\n"),
              ElementsAre("kOne", "kTwo"));
}

TEST(Tuning, FindsChosenNumbersElsewhere) {  // control
  const std::string text =
      "constexpr double kReach = 4.0;\n"
      "  static constexpr std::size_t kFewest{64};\n"
      "inline constexpr std::array kSteps{0.0, 0.7};\n"
      "constexpr std::array<int, 2> kStarts{{0,\n 7}};\n"
      "constexpr double kSmall_s =\n    -1e-3;\n"
      "constexpr std::uintmax_t kFile = std::uintmax_t{1} << 31U;\n"
      "// constexpr double kCommented = 1.0;\n"
      "constexpr double kDerived = tuning::kReach * 2.0;\n"
      "constexpr std::array<int, 2> kPrimes{2, 3};\n"
      "constexpr std::string_view kName = \"1\";\n";
  EXPECT_THAT(chosen_numbers_outside({{"diagnosis/x.cpp", text}}),
              ElementsAre("diagnosis/x.cpp: kReach", "diagnosis/x.cpp: kFewest", "diagnosis/x.cpp: kSteps",
                          "diagnosis/x.cpp: kStarts", "diagnosis/x.cpp: kSmall_s", "diagnosis/x.cpp: kFile"));
  EXPECT_THAT(chosen_numbers_outside({{"diagnosis/page/x.cpp", text}, {"plant/x.cpp", text}}), IsEmpty());
}

}  // namespace
}  // namespace hybridtest::architecture
