#include "validation/studies/founding_study/findings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

namespace hybridtest::founding {
namespace {

MethodRun made_up(const char* name, double error, int samples = 1000) {
  MethodRun run;
  run.name = name;
  run.reason = StopReason::completed;
  for (int i = 0; i < samples; ++i) {
    const double t = 0.01 * i;
    run.time_s.push_back(t);
    run.period_time_s.push_back(t);
    for (auto& floor : run.displacement_m) floor.push_back((1.0 + error) * std::sin(t));
    for (auto& force : run.force_n) force.push_back(100.0 * std::sin(t));
    run.energy_error_j.push_back(0.0);
  }
  return run;
}

/// Runs that show every finding.
std::vector<MethodRun> showing() {
  std::vector<MethodRun> runs{made_up("exact", 0.0),
                              made_up("uncompensated", 0.0, 400),
                              made_up("polynomial_displacement", 0.01),
                              made_up("polynomial_force", 0.10),
                              made_up("newmark_kinematics", 0.02),
                              made_up("force_correction_quadratic", 0.20),
                              made_up("force_correction", 0.01)};
  MethodRun& uncompensated = runs[1];
  uncompensated.reason = StopReason::interlock;
  uncompensated.interlock = "force_limit";
  for (auto& floor : uncompensated.displacement_m) {
    for (std::size_t i = 0; i < floor.size(); ++i) floor[i] += 1e-4 * static_cast<double>(i);
  }
  uncompensated.energy_error_j.back() = -5.0;
  runs[5].force_n[1][500] += 50.0;
  return runs;
}

std::vector<bool> shown(const std::vector<MethodRun>& runs) {
  std::vector<bool> result;
  for (const Finding& finding : find(runs)) result.push_back(finding.is_shown);
  return result;
}

TEST(Distance, EqualsErrorOfScaledMotion) {
  const Distance distance = distance_of(made_up("scaled", 0.07), made_up("exact", 0.0));
  EXPECT_NEAR(distance.rms_percent[0], 7.0, 1e-9);
  EXPECT_NEAR(distance.peak_percent[1], 7.0, 1e-9);
  EXPECT_TRUE(distance.is_complete);
  EXPECT_EQ(distance.jumps, 0);
}

TEST(Distance, CountsForceSpikeAsTwoJumps) {
  MethodRun run = made_up("jumping", 0.0);
  run.force_n[0][300] += 20.0;
  const Distance distance = distance_of(run, made_up("exact", 0.0));
  EXPECT_EQ(distance.jumps, 2);
  // 20 of 100, and a hundredth of the force's own rate.
  EXPECT_NEAR(distance.largest_change_percent, 20.0, 1.1);
}

TEST(Findings, AreFoundInMatchingRuns) { EXPECT_EQ(shown(showing()), (std::vector{true, true, true, true, true})); }

TEST(Findings, EachCanBeMissing) {
  auto runs = showing();
  runs[1].interlock.clear();
  runs[1].reason = StopReason::completed;
  EXPECT_FALSE(shown(runs)[0]);

  runs = showing();
  runs[2] = made_up("polynomial_displacement", 0.15);
  EXPECT_FALSE(shown(runs)[1]);
  EXPECT_FALSE(shown(runs)[2]);

  runs = showing();
  runs[5] = made_up("force_correction_quadratic", 0.2);
  EXPECT_FALSE(shown(runs)[3]);

  runs = showing();
  runs[6].force_n[0][200] += 30.0;
  EXPECT_FALSE(shown(runs)[4]);
}

/// Lines of a scenario without comments, name, transfer system, sensors and compensators.
std::vector<std::string> what_all_share(const std::filesystem::path& file) {
  std::ifstream in{file};
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) {
    const auto has = [&](const char* key) { return line.find(key) != std::string::npos; };
    if (line.starts_with('#') || has("name:") || has("transfer_system:") || has("sensors:") || has("compensator:"))
      continue;
    lines.push_back(line);
  }
  return lines;
}

TEST(FoundingScenarios, DifferOnlyInRigAndCompensation) {
  const auto directory = std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "launch/scenarios/founding_study";
  const auto exact = what_all_share(directory / "exact.yaml");
  ASSERT_GT(exact.size(), 15U);
  for (const Method& method : kMethods) {
    EXPECT_EQ(what_all_share(directory / (std::string{method.name} + ".yaml")), exact) << method.name;
  }
}

}  // namespace
}  // namespace hybridtest::founding
