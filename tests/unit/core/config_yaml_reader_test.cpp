#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/core/config_reading.hpp"

namespace hybridtest::config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string nested(int depth) {
  std::string yaml = "a: ";
  for (int i = 1; i < depth; ++i) yaml += '[';
  yaml += '1';
  for (int i = 1; i < depth; ++i) yaml += ']';
  return yaml;
}

TEST(ConfigYamlReader, ReportsDuplicateKeysAndKeepsTheFirst) {
  const auto errors = errors_of("a: {b: 1, b: 2}\nc: [{d: 1, \"d\": 2}]\na: 3\n", [](Section root) {
    EXPECT_EQ(root.section("a").number("b"), 1.0);
    EXPECT_THAT(root.keys(), ElementsAre("a", "c"));
  });
  EXPECT_THAT(errors, ElementsAre("test.yaml:1:11: a.b: duplicate key, first given at 1:5",
                                  "test.yaml:2:12: c[0].d: duplicate key, first given at 2:6",
                                  "test.yaml:3:1: a: duplicate key, first given at 1:1"));
}

TEST(ConfigYamlReader, RejectsAnchorsAliasesAndTags) {
  const auto errors = errors_of("a: &x 1\nb: *x\nc: !!str 5\nd: [&y [], !t {}]\n", [](Section root) {
    EXPECT_EQ(root.number("a"), 1.0);
    EXPECT_EQ(root.number("b", kAnyNumber, 9.0), 9.0);
  });
  EXPECT_THAT(errors, ElementsAre("test.yaml:1:4: a: an anchor (&name) is not supported here; remove it",
                                  "test.yaml:2:4: b: an alias (*name) is not supported here; write the value itself",
                                  "test.yaml:3:4: c: a tag (tag:yaml.org,2002:str) is not supported here; remove it",
                                  "test.yaml:4:5: d[0]: an anchor (&name) is not supported here; remove it",
                                  "test.yaml:4:12: d[1]: a tag (!t) is not supported here; remove it"));
}

TEST(ConfigYamlReader, RejectsKeysThatAreNotNames) {
  const std::string longest(200, 'k');
  const auto errors = errors_of("? [1]\n: 2\n~: 3\n\"\": 4\n" + longest + ": 5\n" + longest + "k: 6\n",
                                [&](Section root) { EXPECT_THAT(root.keys(), ElementsAre(longest)); });
  EXPECT_THAT(errors, ElementsAre("test.yaml:1:3: a key must be a name, found a list",
                                  "test.yaml:3:1: a key must be a name, found nothing",
                                  "test.yaml:4:1: a key must be a name, found the text \"\"",
                                  HasSubstr("test.yaml:6:1: a key has at most 200 characters")));
}

TEST(ConfigYamlReader, RejectsInvalidYaml) {
  EXPECT_THAT(errors_of("a: 1\nb: [1, 2\n"),
              ElementsAre("test.yaml:2:9: not YAML: end of sequence flow not found; a list in brackets begins at 2:4"));
  EXPECT_THAT(errors_of("a: 1\n  b: 2\n"), ElementsAre(HasSubstr("test.yaml:2:4: not YAML")));
  EXPECT_THAT(errors_of("a: \"x\n"), ElementsAre(HasSubstr("not YAML")));
  EXPECT_THAT(errors_of("a: &x 1\nb: {\n"), ElementsAre(HasSubstr("1:4: a: an anchor"), HasSubstr("2:5: not YAML")));
}

TEST(ConfigYamlReader, RejectsUnclosedQuote) {
  for (const char* const yaml : {"a: \"x", "a: \"x\n", "a: \"x\nb: 5\n", "a: 'x\n\n\n", "a: 'x # c\n", "- \"x\n"})
    EXPECT_THAT(errors_of(yaml), ElementsAre(HasSubstr("not YAML: illegal EOF in scalar"))) << yaml;
}

TEST(ConfigYamlReader, KeepsTheLinesOfBlockTexts) {
  const auto errors = errors_of("a: >\n  one\n  two\nb: |\n  three\n  four\n", [](Section root) {
    EXPECT_EQ(root.text("a"), "one two\n");
    EXPECT_EQ(root.text("b"), "three\nfour\n");
  });
  EXPECT_THAT(errors, IsEmpty());
}

TEST(ConfigYamlReader, RejectsSecondDocument) {
  EXPECT_THAT(errors_of("a: 1\n---\nb: 2\n"),
              ElementsAre("test.yaml:2:1: a second YAML document, or text outside the first, begins here"));
  EXPECT_THAT(errors_of("---\na: 1\n...\n"), IsEmpty());
}

TEST(ConfigYamlReader, RequiresMappingAtTopLevel) {
  EXPECT_THAT(errors_of(""), ElementsAre("test.yaml:1:1: expected a mapping (key: value) at the top, found nothing"));
  EXPECT_THAT(errors_of("# nothing\n"), ElementsAre(HasSubstr("found nothing")));
  EXPECT_THAT(errors_of("- 1\n"), ElementsAre(HasSubstr("found a list")));
  EXPECT_THAT(errors_of("5"), ElementsAre(HasSubstr("found the number 5")));
  EXPECT_THAT(errors_of(","), ElementsAre(HasSubstr("test.yaml:1:1")));
}

TEST(ConfigYamlReader, RejectsInvalidUtf8) {
  EXPECT_THAT(errors_of("a: 1\nb: \xFF\n"), ElementsAre("test.yaml:2:4: not UTF-8 text"));
  EXPECT_THAT(errors_of("a: \xC0\xAF"), ElementsAre("test.yaml:1:4: not UTF-8 text"));
  EXPECT_THAT(errors_of("a: \xED\xA0\x80"), ElementsAre("test.yaml:1:4: not UTF-8 text"));
  EXPECT_THAT(errors_of("a: \xF4\x90\x80\x80"), ElementsAre("test.yaml:1:4: not UTF-8 text"));
  EXPECT_THAT(errors_of("a: \xE2\x82"), ElementsAre("test.yaml:1:4: not UTF-8 text"));
  // The parser takes the byte 4 for the end of the file and would drop the rest unseen.
  EXPECT_THAT(errors_of("a: 1\n\x04 b: 2\n"), ElementsAre("test.yaml:2:1: a control character"));
  EXPECT_THAT(errors_of(std::string{"a: \0", 4}), ElementsAre("test.yaml:1:4: a control character"));
}

TEST(ConfigYamlReader, ReadsUtf8ByteOrderMarkAndCrLf) {
  const auto errors = errors_of(
      "\xEF\xBB\xBF"
      "a: Giuffr\xC3\xA9 \xF0\x9F\x8F\x97\r\nb: 1\r\n",
      [](Section root) {
        EXPECT_EQ(root.text("a"), "Giuffr\xC3\xA9 \xF0\x9F\x8F\x97");
        EXPECT_EQ(root.number("b"), 1.0);
      });
  EXPECT_THAT(errors, IsEmpty());
}

TEST(ConfigYamlReader, RejectsDeepNestingBeforeStackOverflow) {
  EXPECT_THAT(errors_of(nested(64)), IsEmpty());
  EXPECT_THAT(errors_of(nested(65)), ElementsAre(HasSubstr("nested more than 64 levels deep")));
  EXPECT_THAT(errors_of(nested(200000)), ElementsAre(HasSubstr("nested more than 64 levels deep")));
  std::string blocks;
  for (int i = 0; i < 100000; ++i) blocks += "- ";
  EXPECT_THAT(errors_of(blocks), ElementsAre(HasSubstr("nested more than 64 levels deep")));
}

TEST(ConfigYamlReader, RejectsOversizedFile) {
  const std::string comment(std::size_t{4} << 20U, '#');
  EXPECT_THAT(errors_of(comment + "\na: 1\n"), ElementsAre("test.yaml: larger than 4 MiB"));
  EXPECT_THAT(errors_of(comment.substr(6) + "\na: 1"), IsEmpty());
}

TEST(ConfigYamlReader, FindsDuplicatesAmongManyKeysQuickly) {
  std::string yaml;
  for (int i = 0; i < 100000; ++i) yaml += "k" + std::to_string(i) + ": 1\n";
  EXPECT_THAT(errors_of(yaml + "k7: 2\n"), ElementsAre("test.yaml:100001:1: k7: duplicate key, first given at 8:1"));
}

}  // namespace
}  // namespace hybridtest::config
