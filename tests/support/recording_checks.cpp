#include "tests/support/recording_checks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/time.hpp"
#include "tests/support/started_program.hpp"

namespace hybridtest {
namespace {

constexpr const char* kH5dump = "/usr/bin/h5dump";

}  // namespace

void expect_opens_with_h5dump(const std::filesystem::path& file, const std::filesystem::path& scratch) {
  if (!std::filesystem::exists(kH5dump)) return;
  StartedProgram dump{kH5dump, {"--dataset=/steps", file.string()}, scratch / (file.stem().string() + ".dump")};
  EXPECT_THAT(dump.wait(), ::testing::Optional(0)) << dump.standard_error();
  EXPECT_THAT(dump.standard_output(), ::testing::HasSubstr("DATASET \"/steps\"")) << file;
}

void expect_all_steps_from_the_first(const RecordedRun& run, const std::string& participant) {
  const std::vector<double> steps = run.column(participant, "steps", "step");
  EXPECT_FALSE(steps.empty()) << participant;
  for (std::size_t i = 0; i < steps.size(); ++i) ASSERT_EQ(steps[i], static_cast<double>(i)) << participant;
}

void expect_rig_came_to_zero(const RecordedRun& run, const std::string& site) {
  const std::vector<double> command_m = run.column(site, "control", "command_displacement_m");
  ASSERT_FALSE(command_m.empty()) << site;
  EXPECT_EQ(command_m.back(), 0.0) << site;
  // Otherwise the last one says nothing.
  EXPECT_TRUE(std::ranges::any_of(command_m, [](double value) { return value != 0.0; })) << site;
}

void expect_held_between(const RecordedRun& run, const std::string& site, const Event& begin, const Event& end) {
  const std::vector<double> command_m = run.column(site, "control", "command_displacement_m");
  const std::vector<double> time_s = run.column(site, "control", "time_s");
  const std::vector<double> faults = run.column(site, "control", "faults");
  const auto held = [&](std::size_t i) {
    return (static_cast<std::uint32_t>(faults[i]) & static_cast<std::uint32_t>(FaultFlags::command_age)) != 0;
  };
  std::size_t first = 0;
  while (first < faults.size() && !held(first)) ++first;
  ASSERT_LT(first, faults.size()) << site;
  std::size_t last = first;
  while (last + 1 < command_m.size() && command_m[last + 1] == command_m[first]) ++last;
  const double between_s = to_seconds(end.clock - begin.clock);
  EXPECT_NEAR(time_s[last] - time_s[first], between_s, 0.5) << site;
  EXPECT_LT(last + 1, command_m.size()) << site << " never came back from holding";
}

}  // namespace hybridtest
