#include "validation/blind_batches/batch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <stdexcept>

#include "validation/blind_batches/score/answers.hpp"

namespace hybridtest::blind {
namespace {

namespace fs = std::filesystem;

/// Stands in for SHA-256, which the programs hand in; enough to notice a change.
std::string digest(std::string_view text) { return std::to_string(std::hash<std::string_view>{}(text)); }

class SealedBatch : public testing::Test {
 protected:
  SealedBatch() {
    fs::remove_all(root_);
    make_batch({.cases = 2, .seed = 4, .directory = batch_, .key = key_}, digest,
               [](const std::vector<std::string>& names, const std::function<void(std::size_t)>& one) {
                 for (std::size_t i = 0; i < names.size(); ++i) one(i);
               });
  }
  ~SealedBatch() override { fs::remove_all(root_); }

  void answer(const std::string& name, const std::string& text) {
    fs::create_directories(answers_ / name);
    std::ofstream{answers_ / name / "diagnosis.json"} << text;
  }
  static void append(const fs::path& path) { std::ofstream{path, std::ios::app} << ' '; }

  fs::path root_ = fs::path{testing::TempDir()} /
                   (std::string{"sealed_batch_"} + testing::UnitTest::GetInstance()->current_test_info()->name());
  fs::path batch_ = root_ / "batch";
  fs::path key_ = root_ / "batch.key.json";
  fs::path answers_ = root_ / "answers";
};

TEST_F(SealedBatch, OpensWithItsKeyWithoutRevealingTruth) {
  const std::vector<CaseFiles> cases = open_batch(batch_, digest);
  ASSERT_EQ(cases.size(), 2U);
  EXPECT_EQ(cases[0].name, "case_0001");
  EXPECT_GE(cases[0].fit.size(), 1U);
  EXPECT_TRUE(fs::exists(cases[1].held_out));
  EXPECT_EQ(read_key(open_key(batch_, key_, digest)).size(), 2U);
  EXPECT_THAT(read_batch_file(batch_ / "batch.json"), testing::Not(testing::HasSubstr("seed")));
  for (const auto& entry : fs::recursive_directory_iterator{batch_}) {
    EXPECT_THAT(entry.path().filename().string(), testing::Not(testing::HasSubstr("key")));
  }
}

TEST_F(SealedBatch, RejectsChangedKeyOrRecording) {
  append(key_);
  EXPECT_THROW((void)open_key(batch_, key_, digest), std::runtime_error);
  append(batch_ / "case_0002" / "held_out.csv");
  EXPECT_THROW((void)open_batch(batch_, digest), std::runtime_error);
}

TEST_F(SealedBatch, RejectsChangedAddedOrRemovedAnswers) {
  const std::vector<std::string> names{"case_0001", "case_0002"};
  answer("case_0001", "{}");
  EXPECT_FALSE(open_answers(batch_, answers_, names, digest).are_sealed);
  EXPECT_EQ(seal_answers(batch_, answers_, digest), 1U);
  const GivenAnswers given = open_answers(batch_, answers_, names, digest);
  EXPECT_TRUE(given.are_sealed);
  EXPECT_EQ(given.texts[0], "{}");
  EXPECT_FALSE(given.texts[1].has_value());

  answer("case_0002", "{}");
  EXPECT_THROW((void)open_answers(batch_, answers_, names, digest), std::runtime_error);
  fs::remove_all(answers_ / "case_0002");
  EXPECT_NO_THROW((void)open_answers(batch_, answers_, names, digest));
  append(answers_ / "case_0001" / "diagnosis.json");
  EXPECT_THROW((void)open_answers(batch_, answers_, names, digest), std::runtime_error);
  fs::remove_all(answers_ / "case_0001");
  EXPECT_THROW((void)open_answers(batch_, answers_, names, digest), std::runtime_error);
}

TEST_F(SealedBatch, RejectsAnswersToAnotherBatch) {
  answer("case_0001", "{}");
  seal_answers(batch_, answers_, digest);
  append(batch_ / "batch.json");
  EXPECT_THROW((void)open_answers(batch_, answers_, {"case_0001"}, digest), std::runtime_error);
}

TEST_F(SealedBatch, OverwritesNeitherBatchNorKey) {
  const auto make_again = [&](const fs::path& directory, const fs::path& key) {
    make_batch({.cases = 1, .seed = 4, .directory = directory, .key = key}, digest,
               [](const std::vector<std::string>&, const std::function<void(std::size_t)>&) {});
  };
  EXPECT_THROW(make_again(batch_, root_ / "another.key.json"), std::runtime_error);
  EXPECT_THROW(make_again(root_ / "another", key_), std::runtime_error);
}

}  // namespace
}  // namespace hybridtest::blind
