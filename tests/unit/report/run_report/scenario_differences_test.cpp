#include "report/run_report/scenario_differences.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hybridtest::run_report {
namespace {

constexpr const char* kShipped =
    "name: a\ntime:\n  step_s: 0.001\nsubstructures:\n  - id: storey_1\n    compensator:\n      - type: none\n"
    "    limits:\n      force_n: 5\n  - id: storey_2\n    compensator:\n      - type: none\n";

std::vector<std::string> texts(const std::vector<DiffLine>& lines, DiffLine::Kind kind) {
  std::vector<std::string> found;
  for (const DiffLine& line : lines) {
    if (line.kind == kind) found.push_back(line.text);
  }
  return found;
}

TEST(ScenarioDifferences, SameTextHasNone) { EXPECT_TRUE(scenario_differences(kShipped, kShipped).empty()); }

TEST(ScenarioDifferences, ValueIsNamedWithItsKeysAndSubstructure) {
  std::string changed = kShipped;
  changed.replace(changed.rfind("type: none"), 10, "type: inverse");
  changed.replace(changed.find("0.001"), 5, "0.002");
  const auto lines = scenario_differences(kShipped, changed);
  EXPECT_THAT(texts(lines, DiffLine::Kind::removed),
              testing::ElementsAre("time > step_s: 0.001", "storey_2: substructures > compensator > type: none"));
  EXPECT_THAT(texts(lines, DiffLine::Kind::added),
              testing::ElementsAre("time > step_s: 0.002", "storey_2: substructures > compensator > type: inverse"));
}

TEST(LineDifferences, KeepsTheLinesOfTheNewTextInOrder) {
  const auto lines = line_differences("a\nb\nc\n", "a\nx\nc\nd\n");
  std::string after;
  for (const DiffLine& line : lines) {
    if (line.kind != DiffLine::Kind::removed) after += line.text;
  }
  EXPECT_EQ(after, "axcd");
  EXPECT_THAT(texts(lines, DiffLine::Kind::removed), testing::ElementsAre("b"));
}

}  // namespace
}  // namespace hybridtest::run_report
