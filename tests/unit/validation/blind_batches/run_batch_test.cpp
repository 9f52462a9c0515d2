#include "validation/blind_batches/batch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <stdexcept>

#include "validation/blind_batches/score/score.hpp"

namespace hybridtest::blind {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

std::string digest(std::string_view text) { return std::to_string(std::hash<std::string_view>{}(text)); }

void in_order(std::size_t count, const std::function<void(std::size_t)>& one) {
  for (std::size_t i = 0; i < count; ++i) one(i);
}

TEST(RunBatch, AnswersOpenCasesSealsAndScores) {
  const fs::path root = fs::path{testing::TempDir()} / "blind_run_batch";
  fs::remove_all(root);
  make_batch({.cases = 3, .seed = 9, .directory = root / "b", .key = root / "key.json"}, digest, in_order);
  std::vector<std::string> asked;
  bool is_broken = true;
  const DiagnoseCase diagnose = [&](const CaseFiles& files, const fs::path& out) {
    asked.push_back(files.name);
    if (is_broken && files.name == "case_0002") throw std::runtime_error{"no answer"};
    std::ofstream{out / "diagnosis.json"} << R"({"verdict": "unknown", "causes": []})";
  };
  const RunOutcome first = run_batch(root / "b", root / "answers", diagnose, digest, in_order);
  EXPECT_EQ(first.answered, 2U);
  EXPECT_THAT(first.failures, ElementsAre("case_0002: no answer"));

  asked.clear();
  is_broken = false;
  EXPECT_EQ(run_batch(root / "b", root / "answers", diagnose, digest, in_order).answered, 3U);
  EXPECT_THAT(asked, ElementsAre("case_0002"));

  const BatchScore score = score_batch(root / "b", root / "answers", root / "key.json", digest);
  EXPECT_THAT(score.text, HasSubstr("The answers are as they were sealed."));
  EXPECT_THAT(score.text, HasSubstr("3 cases"));
  std::ofstream{root / "answers" / "case_0001" / "diagnosis.json", std::ios::app} << " ";
  EXPECT_THROW((void)score_batch(root / "b", root / "answers", root / "key.json", digest), std::runtime_error);
  EXPECT_THROW((void)run_batch(root / "b", root / "answers", diagnose, digest, in_order), std::runtime_error);
  fs::remove_all(root);
}

}  // namespace
}  // namespace hybridtest::blind
