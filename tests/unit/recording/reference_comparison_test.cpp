#include "recording/summary/reference_comparison.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/unit/recording/temporary_directory.hpp"

namespace hybridtest {
namespace {

TEST(ReferenceComparisonFile, IsReadBackAsWritten) {
  TemporaryDirectory run;
  std::filesystem::create_directory(reference_folder(run.path()));
  const ReferenceComparison written{
      "in_process", 0.001, 31.0, {{"floor_1", 0.091, 0.09, 0.05, 0.04}, {"base", 0.0, 0.0, {}, {}}}};
  write_reference_comparison(written, reference_folder(run.path()) / "in_process.json");
  std::ofstream{reference_folder(run.path()) / "other.json"} << "{\"not\": \"ours\"}";
  std::ofstream{reference_folder(run.path()) / "broken.json"} << "{";
  const std::vector<ReferenceComparison> read = reference_comparisons(run.path());
  ASSERT_EQ(read.size(), 1U) << "what is not ours is left out";
  EXPECT_EQ(text_of(read[0]), text_of(written));
  EXPECT_EQ(read[0].dofs[0].rms_relative, 0.05);
  EXPECT_FALSE(read[0].dofs[1].rms_relative.has_value()) << "of a degree of freedom at rest";
}

TEST(ReferenceComparisonFile, RunWithoutReferencesHasNone) {
  TemporaryDirectory run;
  EXPECT_TRUE(reference_comparisons(run.path()).empty());
}

}  // namespace
}  // namespace hybridtest
