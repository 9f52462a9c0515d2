#include "validation/studies/rths_benchmark/verdict.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/config_error.hpp"

namespace hybridtest::rths {
namespace {

/// Means that meet every target.
std::vector<CandidateMeans> good_means() {
  CandidateMeans ours;
  ours.name = std::string{kOurs};
  ours.standing = Standing::ours;
  ours.runs = 252;
  ours.j1_ms_max = 0.25;
  ours.j2 = 2.5;
  ours.j2_over_floor = 1.0;
  ours.true_nominal = 0.1;
  ours.true_perturbed = 0.1;
  ours.j6 = 0.1;
  ours.j7 = 0.1;
  CandidateMeans rival = ours;
  rival.name = "rival";
  rival.standing = Standing::published;
  rival.j2 = rival.j6 = rival.j7 = 2.6;
  return {rival, ours};
}

std::size_t missed(const std::vector<CandidateMeans>& means) {
  const std::vector<Target> targets = judge_ours(means);
  return static_cast<std::size_t>(std::ranges::count(targets, false, &Target::is_met));
}

TEST(Verdict, GoodMeansMeetEveryTarget) {
  EXPECT_EQ(judge_ours(good_means()).size(), 10U);
  EXPECT_EQ(missed(good_means()), 0U);
}

TEST(Verdict, DetectsEachMissedTarget) {
  const auto missed_with = [](auto spoil) {
    std::vector<CandidateMeans> means = good_means();
    spoil(means[0], means[1]);
    return missed(means);
  };
  EXPECT_EQ(missed_with([](auto&, auto& ours) { ours.j1_ms_max = 0.31; }), 1U);
  EXPECT_EQ(missed_with([](auto&, auto& ours) { ours.true_nominal = 1.01; }), 1U);
  EXPECT_EQ(missed_with([](auto&, auto& ours) { ours.true_perturbed = 1.51; }), 1U);
  EXPECT_EQ(missed_with([](auto&, auto& ours) { ours.j2_over_floor = 1.151; }), 1U);
  EXPECT_EQ(missed_with([](auto& rival, auto& ours) { ours.j6 = 3.01, rival.j6 = 4.0; }), 1U);
  EXPECT_EQ(missed_with([](auto& rival, auto& ours) { ours.j7 = 3.01, rival.j7 = 4.0; }), 1U);
  EXPECT_EQ(missed_with([](auto&, auto& ours) { ours.lost = 1; }), 1U);
  EXPECT_EQ(missed_with([](auto& rival, auto&) { rival.j2 = 2.4; }), 1U);
  EXPECT_EQ(missed_with([](auto& rival, auto&) { rival.j6 = 0.09; }), 1U);
  EXPECT_EQ(missed_with([](auto& rival, auto&) { rival.j7 = 0.09; }), 1U);
  EXPECT_EQ(missed_with([](auto&, auto& ours) { ours.j6 = std::nan(""); }), 2U);
}

TEST(Verdict, OnlyPublishedMethodsWithoutLostRunsAreRivals) {
  std::vector<CandidateMeans> means = good_means();
  means[0].j2 = 0.1;
  means[0].lost = 1;
  EXPECT_EQ(missed(means), 0U);
  means[0].lost = 0;
  means[0].standing = Standing::variant;
  EXPECT_EQ(missed(means), 0U);
}

TEST(Verdict, RequiresOurCompensator) {
  std::vector<CandidateMeans> means = good_means();
  means.pop_back();
  EXPECT_TRUE(judge_ours(means).empty());
}

TEST(StudyRun, IsLostBeyondLimitUnlessReferenceExceedsIt) {
  StudyRun run;
  run.result.is_complete = true;
  run.result.peak_force_n = 8899.0;
  EXPECT_FALSE(run.is_lost());
  run.result.peak_force_n = 8900.0;
  EXPECT_TRUE(run.is_lost());
  run.is_excused = true;
  EXPECT_FALSE(run.is_lost());
  run.result.is_complete = false;
  EXPECT_TRUE(run.is_lost());
}

TEST(Candidates, HaveUniqueNames) {
  std::vector<std::string> names;
  for (const Candidate& candidate : all_candidates()) names.push_back(candidate.name);
  std::ranges::sort(names);
  EXPECT_EQ(std::ranges::adjacent_find(names), names.end());
  EXPECT_TRUE(std::ranges::binary_search(names, std::string{kOurs}));
  EXPECT_TRUE(std::ranges::binary_search(names, "released_controller"));
  EXPECT_TRUE(std::ranges::binary_search(names, "none"));
}

TEST(Candidates, NameSelectsBothArrangementsOrIsRejected) {
  const auto chosen = chosen_candidates({"newmark_kinematics"});
  ASSERT_EQ(chosen.size(), 2U);
  EXPECT_EQ(chosen[0].name, "newmark_kinematics");
  EXPECT_EQ(chosen[1].name, "newmark_kinematics+pi");
  EXPECT_EQ(chosen_candidates({"newmark_kinematics+pi"}).size(), 1U);
  try {
    static_cast<void>(chosen_candidates({"newmark_kinematic"}));
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("did you mean 'newmark_kinematics'"));
  }
}

}  // namespace
}  // namespace hybridtest::rths
