#include "validation/blind_batches/batch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "validation/blind_batches/score/score.hpp"

namespace hybridtest::blind {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

std::string digest(std::string_view text) { return std::to_string(std::hash<std::string_view>{}(text)); }

void in_order(const std::vector<std::string>& names, const std::function<void(std::size_t)>& one) {
  for (std::size_t i = 0; i < names.size(); ++i) one(i);
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

  const AnsweredBatch batch{root / "b", root / "answers", root / "key.json"};
  const BatchScore score = score_batches({batch}, digest);
  EXPECT_THAT(score.text, HasSubstr("The answers are as they were sealed."));
  EXPECT_THAT(score.text, HasSubstr("3 cases"));
  std::ofstream{root / "answers" / "case_0001" / "diagnosis.json", std::ios::app} << " ";
  EXPECT_THROW((void)score_batches({batch}, digest), std::runtime_error);
  EXPECT_THROW((void)run_batch(root / "b", root / "answers", diagnose, digest, in_order), std::runtime_error);
  fs::remove_all(root);
}

TEST(RunBatch, ScoresSeveralBatchesTogetherAndEachOnce) {
  const fs::path root = fs::path{testing::TempDir()} / "blind_pool";
  fs::remove_all(root);
  std::vector<AnsweredBatch> batches;
  for (const std::uint64_t seed : {11U, 12U}) {
    const std::string name = "b" + std::to_string(seed);
    batches.push_back({root / name, root / (name + ".answers"), root / (name + ".key.json")});
    make_batch({.cases = 2, .seed = seed, .directory = batches.back().batch, .key = batches.back().key}, digest,
               in_order);
    const DiagnoseCase diagnose = [](const CaseFiles&, const fs::path& out) {
      std::ofstream{out / "diagnosis.json"} << R"({"verdict": "none", "causes": []})";
    };
    EXPECT_EQ(run_batch(batches.back().batch, batches.back().answers, diagnose, digest, in_order).answered, 2U);
  }
  const BatchScore pooled = score_batches(batches, digest);
  EXPECT_THAT(pooled.text, HasSubstr("4 cases; truth against verdict"));
  const auto json = nlohmann::json::parse(pooled.json);
  EXPECT_EQ(json["cases"], 4);
  EXPECT_EQ(json["batches"].size(), 2U);
  EXPECT_THROW((void)score_batches({batches[0], batches[0]}, digest), std::runtime_error);
  fs::remove_all(root);
}

}  // namespace
}  // namespace hybridtest::blind
