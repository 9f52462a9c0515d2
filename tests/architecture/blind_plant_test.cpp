#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/architecture/source_tree.hpp"

// The plant behind the blind batches is a second opinion: it shares no code with what it judges.
namespace hybridtest::architecture {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr const char* kPlant = "validation/blind_batches/plant/";

/// Includes of the plant that are neither its own, nor of the standard library, nor Eigen's.
std::vector<std::string> borrowed(const std::vector<SourceFile>& files) {
  std::vector<std::string> found;
  for (const SourceFile& file : files) {
    if (!file.path.starts_with(kPlant)) continue;
    for (const std::string& header : included_by(file.text)) {
      const bool is_standard = header.find_first_of("/.") == std::string::npos;
      if (is_standard || header.starts_with(kPlant) || header.starts_with("Eigen/")) continue;
      found.push_back(file.path + " includes " + header);
    }
  }
  return found;
}

TEST(BlindPlant, IncludesOnlyStandardLibraryAndEigen) {
  const std::vector<SourceFile> files = read_sources(HYBRIDTEST_SOURCE_DIR);
  EXPECT_GE(std::ranges::count_if(files, [](const SourceFile& file) { return file.path.starts_with(kPlant); }), 10)
      << "the plant was not read";
  EXPECT_THAT(borrowed(files), IsEmpty());
}

TEST(BlindPlant, FindsIncludesFromTheLibrary) {
  EXPECT_THAT(borrowed({{"validation/blind_batches/plant/plant.cpp",
                         "#include <cmath>\n#include <Eigen/Core>\n#include \"core/random.hpp\"\n"
                         "#include \"diagnosis/recording.hpp\"\n#include \"validation/blind_batches/plant/site.hpp\"\n"
                         "#include \"plant/effects/effect.hpp\"\n"},
                        {"validation/blind_batches/make_batch.cpp", "#include \"diagnosis/recording.hpp\"\n"}}),
              ElementsAre("validation/blind_batches/plant/plant.cpp includes core/random.hpp",
                          "validation/blind_batches/plant/plant.cpp includes diagnosis/recording.hpp",
                          "validation/blind_batches/plant/plant.cpp includes plant/effects/effect.hpp"));
}

}  // namespace
}  // namespace hybridtest::architecture
