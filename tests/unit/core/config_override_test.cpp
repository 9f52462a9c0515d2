#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/core/config_reading.hpp"

namespace hybridtest::config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kScenario = R"(
time: {step_s: 0.001}
substructures:
  - id: storey_1
    rig: {type: simulated, rate_hz: 1024}
  - id: storey_2
    rig: {type: udp, rate_hz: 2048}
)";

void read_scenario(Section root) {
  Section time = root.section("time");
  (void)time.number("step_s", kPositive);
  (void)time.number("scale", kPositive, 1.0);
  time.finish();
  for (Section substructure : root.sections("substructures")) {
    (void)substructure.text("id");
    Section rig = substructure.section("rig");
    (void)rig.choice("type", {"simulated", "udp"});
    (void)rig.number("rate_hz", kPositive);
    rig.finish();
    substructure.finish();
  }
  root.finish();
}

std::string effective_with(const std::vector<std::string>& overrides) {
  Document document = Document::parse(kScenario, "test.yaml", overrides);
  read_scenario(document.root());
  document.throw_if_errors();
  return document.effective();
}

std::vector<std::string> errors_with(const std::vector<std::string>& overrides) {
  return errors_of(kScenario, read_scenario, overrides);
}

TEST(ConfigOverride, ReplacesValuesByKeyIndexAndId) {
  const std::string yaml = effective_with(
      {"time.step_s=0.002", "substructures[0].rig.type=udp", "substructures[storey_2].rig.rate_hz=4096"});
  EXPECT_EQ(yaml, R"(time:
  step_s: 0.002
  scale: 1
substructures:
  - id: storey_1
    rig:
      type: udp
      rate_hz: 1024
  - id: storey_2
    rig:
      type: udp
      rate_hz: 4096
)");
}

TEST(ConfigOverride, AcceptsMappingsAndLists) {
  const std::string yaml =
      effective_with({"substructures=[{id: a, rig: {type: udp, rate_hz: 1}}]", "time={step_s: 5e-3}"});
  EXPECT_EQ(
      yaml,
      "time:\n  step_s: 0.005\n  scale: 1\nsubstructures:\n  - id: a\n    rig:\n      type: udp\n      rate_hz: 1\n");
}

TEST(ConfigOverride, AddsKeyToExistingMapping) {
  EXPECT_THAT(effective_with({"time.scale=2"}), HasSubstr("scale: 2\n"));
}

TEST(ConfigOverride, LaterOverrideWinsAndMayChangeTheEarlier) {
  EXPECT_THAT(effective_with({"time.scale=2", "time.scale=3"}), HasSubstr("scale: 3\n"));
  EXPECT_THAT(effective_with({"time={step_s: 1}", "time.step_s=5"}), HasSubstr("step_s: 5\n"));
}

TEST(ConfigOverride, ErrorsOfValueNameTheOverride) {
  EXPECT_THAT(
      errors_with({"substructures[0].rig.type=simulted", "time.step_s=-1", "time.scale='2'"}),
      ElementsAre("--set substructures[0].rig.type: unknown value 'simulted'; did you mean 'simulated'? Choices: "
                  "simulated, udp",
                  "--set time.step_s: -1 is out of range; expected a number greater than 0",
                  "--set time.scale: expected a number greater than 0, found the text \"2\"; a number is written "
                  "without quotes"));
}

TEST(ConfigOverride, ErrorsInsideValueNameTheirPath) {
  EXPECT_THAT(errors_with({"substructures[storey_2].rig={type: udp, rte_hz: 5, rte_hz: 6}"}),
              ElementsAre("--set substructures[storey_2].rig: substructures[storey_2].rig.rte_hz: duplicate key",
                          "--set substructures[storey_2].rig: substructures[1].rig.rate_hz: missing; expected a number "
                          "greater than 0",
                          "--set substructures[storey_2].rig: substructures[1].rig.rte_hz: unknown key; did you mean "
                          "'rate_hz'? Known here: type, rate_hz"));
}

TEST(ConfigOverride, ReportsUnknownNewKeyAsInFile) {
  EXPECT_THAT(errors_with({"time.stp_s=1"}),
              ElementsAre("--set time.stp_s: unknown key; did you mean 'step_s'? Known here: step_s, scale"));
}

TEST(ConfigOverride, InvalidPathReportsWhereItEnds) {
  EXPECT_THAT(
      errors_with({"tme.step_s=1", "time.step_s.x=1", "substructures[storey_3].id=x", "substructures[2].id=x",
                   "substructures[99999999999999999999].id=x", "time[0]=1", "substructures.id=x"}),
      ElementsAre("--set tme.step_s: the configuration has no key 'tme'; did you mean 'time'? Known here: time, "
                  "substructures",
                  "--set time.step_s.x: time.step_s is the number 0.001 and has no key 'x'",
                  "--set substructures[storey_3].id: substructures has no element with id 'storey_3'; did you mean "
                  "'storey_1'? Known here: storey_1, storey_2",
                  "--set substructures[2].id: substructures has 2 elements, counted from [0]; found [2]",
                  "--set substructures[99999999999999999999].id: substructures has 2 elements, counted from [0]; found "
                  "[99999999999999999999]",
                  "--set time[0]: time is a mapping and has no elements to select by [0]",
                  "--set substructures.id: substructures is a list and has no key 'id'; an element is selected by its "
                  "number from [0], or by its id: [id]"));
}

TEST(ConfigOverride, RejectsMalformedOverride) {
  for (const char* const assignment :
       {"", "time", "=1", ".a=1", "a..b=1", "a.=1", "a[=1", "a[]=1", "a[0]b=1", "a]=1", "[0]=1", "a\n=1", "\xFF=1"})
    EXPECT_THAT(errors_with({assignment}), ElementsAre(HasSubstr("expected key.path=value"))) << assignment;
}

TEST(ConfigOverride, RejectsValueThatIsNotYaml) {
  EXPECT_THAT(errors_with({"time.step_s="}), ElementsAre("--set time.step_s: expected a value after '='"));
  EXPECT_THAT(errors_with({"time.step_s=[1"}), ElementsAre(HasSubstr("--set time.step_s: not YAML")));
  EXPECT_THAT(errors_with({"time.step_s=null"}), ElementsAre(HasSubstr("found nothing")));
  EXPECT_THAT(errors_with({"time.step_s=1\n---\n2"}), ElementsAre(HasSubstr("second YAML document")));
  EXPECT_THAT(errors_with({"time.step_s=\x01"}), ElementsAre("--set time.step_s: a control character"));
}

TEST(ConfigOverride, NestsNoDeeperThanAFile) {
  std::vector<std::string> overrides;
  std::string path = "time.x";
  for (int i = 0; i < 100; ++i) {
    overrides.push_back(path + "={x: 1}");
    path += ".x";
  }
  EXPECT_THAT(errors_with(overrides), testing::Contains(HasSubstr("nested more than 64 levels deep")));
  EXPECT_THAT(errors_with({"time.x={x: {x: 1}}"}), testing::Not(testing::Contains(HasSubstr("nested"))));
}

TEST(ConfigOverride, ErrorsFollowThoseOfTheFile) {
  EXPECT_THAT(errors_of("time: {step_s: x}\n",
                        [](Section root) {
                          Section time = root.section("time");
                          (void)time.number("scale");
                          (void)time.number("step_s");
                        },
                        {"time.scale=y"}),
              ElementsAre(HasSubstr("test.yaml:1:16: time.step_s"), HasSubstr("--set time.scale: ")));
}

}  // namespace
}  // namespace hybridtest::config
