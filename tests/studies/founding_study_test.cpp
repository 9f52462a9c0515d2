#include "validation/studies/founding_study/founding_study.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "validation/studies/founding_study/findings.hpp"
#include "validation/studies/founding_study/founding_report.hpp"

namespace hybridtest::founding {
namespace {

class FoundingStudy : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const auto scenarios = std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "launch/scenarios/founding_study";
    StudyProgress nobody{kMethods.size(), nullptr};
    runs_ = run_founding_study(scenarios, 1, nobody);
  }
  static void TearDownTestSuite() { runs_.clear(); }

  [[nodiscard]] static Distance distance(std::string_view name) {
    return distance_of(*std::ranges::find(runs_, name, &MethodRun::name), runs_[0]);
  }
  [[nodiscard]] static double worst_rms(std::string_view name) { return std::ranges::max(distance(name).rms_percent); }

  static std::vector<MethodRun> runs_;
};

std::vector<MethodRun> FoundingStudy::runs_;

TEST_F(FoundingStudy, ShowsEveryFinding) {
  for (const Finding& finding : find(runs_)) {
    std::printf("%s: %s\n", finding.what.c_str(), finding.shown_by.c_str());
    EXPECT_TRUE(finding.is_shown) << finding.what;
  }
}

TEST_F(FoundingStudy, UncompensatedTestEndsByInterlock) {
  const Distance uncompensated = distance("uncompensated");
  EXPECT_FALSE(uncompensated.is_complete);
  EXPECT_FALSE(uncompensated.interlock.empty());
  EXPECT_LT(uncompensated.energy_error_j, 0.0);
  const auto quarters = error_by_quarters_m(runs_[1], runs_[0], 1);
  for (std::size_t i = 1; i < quarters.size(); ++i) EXPECT_GT(quarters[i], 2.0 * quarters[i - 1]);
}

TEST_F(FoundingStudy, ForceMethodsAreWorseThanDisplacementMethods) {
  const double closest = std::max(worst_rms("polynomial_displacement"), worst_rms("newmark_kinematics"));
  EXPECT_LT(closest, 2.0);
  EXPECT_GT(worst_rms("polynomial_force"), 5.0 * closest);
  EXPECT_GT(worst_rms("force_correction_quadratic"), 2.0 * closest);
}

TEST_F(FoundingStudy, QuadraticCorrectionJumpsAndOursDoesNot) {
  EXPECT_EQ(distance("exact").jumps, 0);
  EXPECT_GT(distance("force_correction_quadratic").jumps, 100);
  EXPECT_EQ(distance("force_correction").jumps, 0);
  EXPECT_LT(worst_rms("force_correction"), 1.0);
}

TEST_F(FoundingStudy, EveryCompensatedTestIsCompleted) {
  for (const MethodRun& run : runs_) {
    const bool is_expected_to = run.name != "uncompensated";
    EXPECT_EQ(run.reason == StopReason::completed, is_expected_to) << run.name << ": " << run.interlock;
  }
}

TEST_F(FoundingStudy, PageRanksMethodsByTheirError) {
  const std::vector<std::size_t> order = best_first(runs_);
  ASSERT_EQ(order.size(), runs_.size() - 1);
  EXPECT_EQ(runs_[order.back()].name, "uncompensated") << "the only one that is not completed";
  for (std::size_t i = 1; i + 1 < order.size(); ++i) {
    EXPECT_LE(worst_rms(runs_[order[i - 1]].name), worst_rms(runs_[order[i]].name));
  }
  const std::string page = page_html(runs_);
  std::size_t place = page.find("Methods, best first");
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::string row = "<td>" + std::to_string(i + 1) + ". " + runs_[order[i]].name + "</td>";
    const std::size_t found = page.find(row, place);
    ASSERT_NE(found, std::string::npos) << row;
    place = found;
  }
  EXPECT_NE(page.find("Errors over time", place), std::string::npos);
}

}  // namespace
}  // namespace hybridtest::founding
