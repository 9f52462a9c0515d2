#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/core/config_reading.hpp"

namespace hybridtest::config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(ConfigSection, ReadsEveryKindOfValue) {
  const auto errors = errors_of(R"(
number: -2.5e-1
integer: 7
boolean: true
text: ground_motions/design.AT2
choice: paced
numbers: [1, 2.5]
integers: [1, -2]
names: [floor_1, "floor 2"]
matrix: [[1, 2, 3], [4, 5, 6]]
masses: {b: 2, a: 1}
)",
                                [](Section root) {
                                  EXPECT_EQ(root.number("number"), -0.25);
                                  EXPECT_EQ(root.integer("integer", 0, 10), 7);
                                  EXPECT_TRUE(root.boolean("boolean"));
                                  EXPECT_EQ(root.text("text"), "ground_motions/design.AT2");
                                  EXPECT_EQ(root.choice("choice", {"lockstep", "paced"}), 1U);
                                  EXPECT_EQ(root.numbers("numbers"), Eigen::Vector2d(1.0, 2.5));
                                  EXPECT_THAT(root.integers("integers", -5, 5), ElementsAre(1, -2));
                                  EXPECT_THAT(root.names("names"), ElementsAre("floor_1", "floor 2"));
                                  Eigen::MatrixXd expected(2, 3);
                                  expected << 1, 2, 3, 4, 5, 6;
                                  EXPECT_EQ(root.matrix("matrix", 2, 3), expected);
                                  EXPECT_EQ(root.matrix("matrix", 0, 0), expected);
                                  EXPECT_EQ(root.numbers_by_name("masses", {"a", "b"}), Eigen::Vector2d(1.0, 2.0));
                                  root.finish();
                                });
  EXPECT_THAT(errors, IsEmpty());
}

TEST(ConfigSection, ListsAllErrorsInFileOrder) {
  const auto errors = errors_of(R"(nme: two_storey
name: 5
time: {mode: lokstep, step_s: "0.001", duration_s: -31.0, step_s: 2}
mass_kg:
  floor_1: .nan
  flor_2: 1
)",
                                [](Section root) {
                                  (void)root.numbers_by_name("mass_kg", {"floor_1", "floor_2"}, kPositive);
                                  Section time = root.section("time");
                                  (void)time.number("step_s", kPositive);
                                  (void)time.number("duration_s", kPositive);
                                  (void)time.choice("mode", {"lockstep", "paced"});
                                  time.finish();
                                  (void)root.text("name");
                                  (void)root.text("schema");
                                  root.finish();
                                });
  EXPECT_THAT(
      errors,
      ElementsAre(
          "test.yaml:1:1: schema: missing; expected a text",
          "test.yaml:1:1: nme: unknown key; did you mean 'name'? Known here: mass_kg, time, name, schema",
          "test.yaml:2:7: name: expected a text, found the number 5; a text that looks like something else is "
          "written in quotes",
          "test.yaml:3:14: time.mode: unknown value 'lokstep'; did you mean 'lockstep'? Choices: lockstep, paced",
          "test.yaml:3:31: time.step_s: expected a number greater than 0, found the text \"0.001\"; a number is "
          "written without quotes",
          "test.yaml:3:52: time.duration_s: -31.0 is out of range; expected a number greater than 0",
          "test.yaml:3:59: time.step_s: duplicate key, first given at 3:23",
          "test.yaml:4:1: mass_kg.floor_2: missing; expected a number greater than 0",
          "test.yaml:5:12: mass_kg.floor_1: expected a number greater than 0, found .nan",
          "test.yaml:6:3: mass_kg.flor_2: unknown name; did you mean 'floor_2'? Known here: floor_1, floor_2"));
}

struct NumberCase {
  const char* yaml;
  const char* error;  // part of it; empty for none
};

class ConfigNumber : public testing::TestWithParam<NumberCase> {};

TEST_P(ConfigNumber, IsAcceptedOrRefused) {
  const auto [yaml, error] = GetParam();
  const auto errors = errors_of(std::string{"x: "} + yaml, [](Section root) {
    const double value = root.number("x", {.low = -10.0, .high = 1e6, .low_open = true});
    EXPECT_TRUE(std::isfinite(value));
  });
  if (std::string{error}.empty()) {
    EXPECT_THAT(errors, IsEmpty());
  } else {
    EXPECT_THAT(errors, ElementsAre(HasSubstr(error)));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Forms, ConfigNumber,
    testing::Values(NumberCase{"20.0e3", ""}, NumberCase{"1e-5", ""}, NumberCase{"+.5E+1", ""}, NumberCase{"5.", ""},
                    NumberCase{"1e6", ""}, NumberCase{"-9.999", ""},
                    NumberCase{"-10", "-10 is out of range; expected a number greater than -10 and at most 1.0e+06"},
                    NumberCase{"1000001", "out of range"}, NumberCase{".inf", "found .inf"},
                    NumberCase{"-.INF", "found -.INF"}, NumberCase{"nan", "found nan"},
                    NumberCase{".nan", "found .nan"}, NumberCase{"1e400", "1e400 is beyond double precision"},
                    NumberCase{"0x10", "numbers are decimal"}, NumberCase{"1_000", "found the text \"1_000\""},
                    NumberCase{"1,5", "found the text \"1,5\""}, NumberCase{"1.0 m", "found the text \"1.0 m\""},
                    NumberCase{"1e", "found the text"}, NumberCase{".", "found the text"},
                    NumberCase{"'5'", "written without quotes"}, NumberCase{"true", "found true"},
                    NumberCase{"", "found nothing"}, NumberCase{"~", "found nothing"},
                    NumberCase{"[1]", "found a list"}, NumberCase{"{a: 1}", "found a mapping"}));

TEST(ConfigSection, IntegersAreWrittenAsIntegersAndChecked) {
  const auto errors = errors_of("a: 1.5\nb: 1e3\nc: 11\nd: 99999999999999999999\ne: '3'\nf: ten\n", [](Section root) {
    for (const std::string& key : root.keys()) EXPECT_EQ(root.integer(key, 0, 10), 1);
  });
  EXPECT_THAT(errors,
              ElementsAre("test.yaml:1:4: a: expected an integer from 0 to 10, found the number 1.5",
                          "test.yaml:2:4: b: expected an integer from 0 to 10, found the number 1e3; an integer is "
                          "written 1000",
                          "test.yaml:3:4: c: 11 is out of range; expected an integer from 0 to 10",
                          "test.yaml:4:4: d: 99999999999999999999 is out of range; expected an integer from 0 to 10",
                          "test.yaml:5:4: e: expected an integer from 0 to 10, found the text \"3\"; a number is "
                          "written without quotes",
                          "test.yaml:6:4: f: expected an integer from 0 to 10, found the text \"ten\""));
}

TEST(ConfigSection, BooleansAreTrueOrFalseOnly) {
  const auto errors = errors_of("a: yes\nb: 1\nc: 'true'\nd: True\ne: false\n", [](Section root) {
    for (const std::string& key : root.keys()) EXPECT_FALSE(root.boolean(key));
  });
  EXPECT_THAT(errors, ElementsAre("test.yaml:1:4: a: expected true or false, found the text \"yes\"",
                                  "test.yaml:2:4: b: expected true or false, found the number 1",
                                  "test.yaml:3:4: c: expected true or false, found the text \"true\"",
                                  "test.yaml:4:4: d: expected true or false, found the text \"True\""));
}

TEST(ConfigSection, AbsentKeysTakeTheirDefault) {
  const auto errors = errors_of("{}", [](Section root) {
    EXPECT_EQ(root.number("number", kPositive, 2.5), 2.5);
    EXPECT_EQ(root.integer("integer", 0, 5, 3), 3);
    EXPECT_TRUE(root.boolean("boolean", true));
    EXPECT_EQ(root.text("text", "x"), "x");
    EXPECT_EQ(root.choice("choice", {"a", "b"}, "b"), 1U);
    EXPECT_FALSE(root.optional_section("section").has_value());
    EXPECT_FALSE(root.has("number"));
    root.finish();
  });
  EXPECT_THAT(errors, IsEmpty());
}

TEST(ConfigSection, OffIsReadByNameAlone) {
  Document document = Document::parse("a: off\nb: 0\nc: {}\nd: Off\n", "test.yaml");
  Section root = document.root();
  EXPECT_TRUE(root.reads_off("a"));
  for (const char* key : {"b", "c", "d", "absent"}) EXPECT_FALSE(root.reads_off(key)) << key;
  root.finish();
  EXPECT_EQ(document.effective(), "a: off\n") << "the others are left to who reads them";
  EXPECT_THROW(document.throw_if_errors(), ConfigError);
}

TEST(ConfigSection, WrongValuesTakeTheDefault) {
  const auto errors = errors_of("number: -1\ninteger: 9\ntext: 5\nchoice: c\n", [](Section root) {
    EXPECT_EQ(root.number("number", kPositive, 2.5), 2.5);
    EXPECT_EQ(root.integer("integer", 0, 5, 3), 3);
    EXPECT_EQ(root.text("text", "x"), "x");
    EXPECT_EQ(root.choice("choice", {"a", "b"}, "b"), 1U);
  });
  EXPECT_EQ(errors.size(), 4U);
}

TEST(ConfigSection, DefaultOutsideRangeIsAnErrorOfTheFile) {
  const auto errors = errors_of("{}", [](Section root) {
    (void)root.number("rate_hz", {.low = 1.0}, 0.5);
    (void)root.integer("order", 1, 4, 5);
  });
  EXPECT_THAT(errors,
              ElementsAre("test.yaml:1:1: rate_hz: missing; expected a number of at least 1, the default is 0.5",
                          "test.yaml:1:1: order: missing; expected an integer from 1 to 4, the default is 5"));
}

TEST(ConfigSection, ValuesAfterAnErrorAreInRange) {
  const auto errors = errors_of("{}", [](Section root) {
    EXPECT_EQ(root.number("a", kPositive), 1.0);
    EXPECT_EQ(root.number("b", {.low = 0.0, .high = 0.5, .low_open = true}), 0.25);
    const double large = root.number("c", {.low = 1e3, .low_open = true});
    EXPECT_GT(large, 1e3);
    EXPECT_LT(root.number("d", {.high = -7.0, .high_open = true}), -7.0);
    EXPECT_EQ(root.integer("e", 5, 9), 5);
    EXPECT_EQ(root.integer("f", -9, -5), -5);
    EXPECT_EQ(root.numbers("g", 3, {.low = 2.0, .high = 4.0}), Eigen::Vector3d::Constant(3.0));
    EXPECT_EQ(root.matrix("h", 2, 2), Eigen::Matrix2d::Identity());
    EXPECT_EQ(root.numbers_by_name("i", {"x", "y"}, kPositive), Eigen::Vector2d::Ones());
    EXPECT_EQ(root.integers("j", 3, 4).size(), 1U);
    EXPECT_TRUE(root.names("k").empty());
    EXPECT_TRUE(root.sections("l").empty());
    EXPECT_EQ(root.choice("m", {"one", "two"}), 0U);
  });
  EXPECT_EQ(errors.size(), 13U);
}

TEST(ConfigSection, ListsAreCheckedEntryByEntry) {
  const auto errors = errors_of("a: [1, x, -2]\nb: [1, 2]\nc: []\nd: 5\ne: [f, '', f, 3]\n", [](Section root) {
    EXPECT_EQ(root.numbers("a", 0, kPositive), Eigen::Vector3d::Ones());
    EXPECT_EQ(root.numbers("b", 3).size(), 3);
    (void)root.numbers("c");
    (void)root.integers("d", 0, 9);
    EXPECT_THAT(root.names("e"), ElementsAre("f"));
  });
  EXPECT_THAT(errors,
              ElementsAre("test.yaml:1:8: a[1]: expected a number greater than 0, found the text \"x\"",
                          "test.yaml:1:11: a[2]: -2 is out of range; expected a number greater than 0",
                          "test.yaml:2:4: b: expected a list of 3 entries, each a finite number, found a list of 2",
                          "test.yaml:3:4: c: expected a list, each a finite number, found an empty list",
                          "test.yaml:4:4: d: expected a list, each an integer from 0 to 9, found the number 5",
                          "test.yaml:5:8: e[1]: expected a name, found an empty text",
                          "test.yaml:5:12: e[2]: the name 'f' occurs twice in this list",
                          "test.yaml:5:15: e[3]: expected a name, found the number 3; a text that looks like something "
                          "else is written in quotes"));
}

TEST(ConfigSection, MatricesAreCheckedRowByRow) {
  const auto errors = errors_of("a: [[1, 2], [3]]\nb: [[1, x]]\nc: [1, 2]\nd: [[1]]\ne: [[], [1]]\n", [](Section root) {
    EXPECT_EQ(root.matrix("a", 2, 2), Eigen::Matrix2d::Identity());
    EXPECT_EQ(root.matrix("b", 1, 2), Eigen::MatrixXd::Identity(1, 2));
    (void)root.matrix("c", 0, 2);
    EXPECT_EQ(root.matrix("d", 2, 1).rows(), 2);
    (void)root.matrix("e", 0, 0);
  });
  EXPECT_THAT(errors,
              ElementsAre("test.yaml:1:13: a[1]: expected a list of 2 entries, each a finite number, found a list of 1",
                          "test.yaml:2:9: b[0][1]: expected a finite number, found the text \"x\"",
                          "test.yaml:3:5: c[0]: expected a list of 2 entries, each a finite number, found the number 1",
                          "test.yaml:3:8: c[1]: expected a list of 2 entries, each a finite number, found the number 2",
                          "test.yaml:4:4: d: expected a list of 2 entries, each a row of numbers, found a list of 1",
                          "test.yaml:5:5: e[0]: expected a list of 1 entry, each a finite number, found a list of 0"));
}

TEST(ConfigSection, NumbersByNameKeepOrderOfNames) {
  const std::vector<std::string> names = {"floor_1", "floor_2", "roof"};
  const auto errors = errors_of("mass_kg: {roof: 3, floor_2: 2, floor_1: 1}", [&](Section root) {
    EXPECT_EQ(root.numbers_by_name("mass_kg", names), Eigen::Vector3d(1.0, 2.0, 3.0));
  });
  EXPECT_THAT(errors, IsEmpty());
}

TEST(ConfigSection, NumbersByNameRequireAMapping) {
  const auto errors = errors_of("mass_kg: [1, 2]", [](Section root) {
    (void)root.numbers_by_name("mass_kg", {"a", "b"}, kPositive);
  });
  EXPECT_THAT(errors, ElementsAre("test.yaml:1:10: mass_kg: expected a mapping from each of a, b to a number greater "
                                  "than 0, found a list"));
}

TEST(ConfigSection, SectionsReportTheirPath) {
  const auto errors = errors_of("substructures:\n  - rig: {type: udp}\n  - id: b\n", [](Section root) {
    EXPECT_EQ(root.path(), "");
    auto list = root.sections("substructures");
    ASSERT_EQ(list.size(), 2U);
    EXPECT_EQ(list[0].section("rig").path(), "substructures[0].rig");
    EXPECT_THAT(list[1].keys(), ElementsAre("id"));
  });
  EXPECT_THAT(errors, IsEmpty());
}

TEST(ConfigSection, SingleMappingIsAListOfOneWhereAllowed) {
  const auto read = [](bool or_single) {
    return [or_single](Section root) {
      for (Section section : root.sections("interface", or_single)) EXPECT_EQ(section.text("dof"), "floor_1");
    };
  };
  EXPECT_THAT(errors_of("interface: {dof: floor_1}", read(true)), IsEmpty());
  EXPECT_THAT(errors_of("interface: {dof: floor_1}", read(false)),
              ElementsAre("test.yaml:1:1: interface: expected a list of mappings, found a mapping"));
}

TEST(ConfigSection, MissingSectionNamesItsRequiredKeys) {
  const auto errors = errors_of("a: {}\nrig: 5\n", [](Section root) {
    (void)root.section("a");
    Section time = root.section("time");
    (void)time.number("step_s");
    (void)time.number("step_s");
    (void)time.number("time_scale", kPositive, 1.0);
    (void)time.section("inner").number("x");
    time.finish();
    (void)root.section("rig").text("type");
    (void)root.optional_section("rig");
  });
  EXPECT_THAT(errors, ElementsAre("test.yaml:1:1: time: missing; expected a mapping; required in it: step_s, inner",
                                  "test.yaml:2:6: rig: expected a mapping, found the number 5; required in it: type"));
}

TEST(ConfigSection, HandlesOfOneSectionShareTheirState) {
  const auto errors = errors_of("rig: {type: udp, port: 5}\nlist: [{a: 1, b: 2}]\n", [](Section root) {
    (void)root.section("rig").text("type");
    (void)root.optional_section("rig")->integer("port", 0, 9);
    root.section("rig").finish();
    (void)root.sections("list")[0].number("a");
    (void)root.sections("list")[0].number("b");
    root.sections("list")[0].finish();
    root.finish();
  });
  EXPECT_THAT(errors, IsEmpty());
}

TEST(ConfigSection, CustomErrorsPointToKeyOrSection) {
  const auto errors = errors_of("a:\n  b: 5\n", [](Section root) {
    root.section("a").error("b", "must not be 5");
    root.section("a").error("b", "must not be 5");
    root.section("a").error("c", "should be there");
    root.section("a").error("", "is odd");
    root.error("", "the file is odd");
  });
  EXPECT_THAT(errors, ElementsAre("test.yaml:1:1: a.c: should be there", "test.yaml:1:1: a: is odd",
                                  "test.yaml:1:1: the file is odd", "test.yaml:2:3: a.b: must not be 5"));
}

TEST(ConfigSection, ReportsUnknownKeysInFullyReadFile) {
  EXPECT_THAT(errors_of("a: 1\nzebra: 2\n",
                        [](Section root) {
                          (void)root.number("a");
                          root.finish();
                        }),
              ElementsAre("test.yaml:2:1: zebra: unknown key; known here: a"));
}

TEST(ConfigSection, AbsentSectionOfDefaultsIsWrittenToEffective) {
  Document document = Document::parse("a: 1\n", "test.yaml");
  Section root = document.root();
  EXPECT_EQ(root.number("a"), 1.0);
  Section timeouts = root.section_or_empty("timeouts");
  EXPECT_EQ(timeouts.number("discovery_s", kPositive, 30.0), 30.0);
  timeouts.finish();
  root.finish();
  document.throw_if_errors();
  EXPECT_THAT(document.effective(), HasSubstr("timeouts:\n  discovery_s: 30"));
}

TEST(ConfigSection, AbsentListOfDefaultsRoundTrips) {
  const auto effective = [](const std::string& yaml) {
    Document document = Document::parse(yaml, "test.yaml");
    Section root = document.root();
    EXPECT_EQ(root.number("a"), 1.0);
    for (Section& entry : root.sections_or_empty("parts")) {
      EXPECT_EQ(entry.text("type", "none"), "none");
      entry.finish();
    }
    root.finish();
    document.throw_if_errors();
    return document.effective();
  };
  const std::string absent = effective("a: 1\n");
  EXPECT_THAT(absent, HasSubstr("parts:\n  - type: none"));
  EXPECT_EQ(effective(absent), absent);
  EXPECT_EQ(effective("a: 1\nparts: {type: none}\n"), absent);
  EXPECT_EQ(effective("a: 1\nparts: [{}]\n"), absent);
}

TEST(ConfigSection, LimitsTheNumberOfListedErrors) {
  std::string yaml;
  for (int i = 0; i < 5000; ++i) yaml += "key_" + std::to_string(i) + ": 1\n";
  const auto errors = errors_of(yaml, [](Section root) { root.finish(); });
  ASSERT_EQ(errors.size(), 1001U);
  EXPECT_EQ(errors.back(), "test.yaml: more errors are not shown");
}

}  // namespace
}  // namespace hybridtest::config
