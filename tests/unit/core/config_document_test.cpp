#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "tests/unit/core/config_reading.hpp"

namespace hybridtest::config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A file that is gone with the test.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& content)
      : path_{std::filesystem::path{testing::TempDir()} / unique_name()} {
    std::ofstream{path_, std::ios::binary} << content;
  }
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  static std::string unique_name() {
    const auto* const test = testing::UnitTest::GetInstance()->current_test_info();
    return std::string{"hybridtest_"} + test->test_suite_name() + '_' + test->name() + ".yaml";
  }
  std::filesystem::path path_;
};

void read_everything(Section root) {
  (void)root.text("name", "unnamed");
  Section time = root.section("time");
  (void)time.number("step_s");
  (void)time.number("time_scale", kPositive, 1.0);
  (void)time.choice("mode", {"lockstep", "paced"}, "lockstep");
  time.finish();
  const auto dofs = root.names("dofs");
  (void)root.numbers_by_name("mass_kg", dofs, kPositive);
  (void)root.matrix("stiffness_n_per_m", 0, 2);
  (void)root.numbers("ratios");
  (void)root.integers("modes", 1, 9);
  for (Section site : root.sections("sites")) {
    (void)site.text("id");
    (void)site.number("force_n_max", kPositive, std::numeric_limits<double>::infinity());
    for (Section interface : site.sections("interface", true)) (void)interface.text("dof", "none");
    if (auto rig = site.optional_section("rig")) (void)rig->boolean("armed", false);
    site.finish();
  }
  (void)root.section("empty");
  (void)root.sections("none");
  root.finish();
}

std::string effective_of(const std::string& yaml) {
  Document document = Document::parse(yaml, "test.yaml");
  read_everything(document.root());
  document.throw_if_errors();
  return document.effective();
}

constexpr const char* kFile = R"(
# A comment.
empty: {}
none: []
modes: [1, +2]
ratios: [0.020, -0.0, 1e+300, 123456789012345680]
time: {step_s: 1.0e-3}
mass_kg:
  roof: 20.0e3
  "floor 1": 1.5
dofs: [floor 1, 'roof']
stiffness_n_per_m:
  - [4.0e6, -0.1]
  - [-0.1, 3000000]
sites:
  - {id: "on", interface: {dof: roof}, rig: {}}
  - id: "5"
    interface: [{dof: "a: \"b\"\\ \n\tc # \u00e9"}, {dof: ""}]
)";

constexpr const char* kEffective = R"(name: unnamed
time:
  step_s: 0.001
  time_scale: 1
  mode: lockstep
dofs: ["floor 1", roof]
mass_kg: {"floor 1": 1.5, roof: 20000}
stiffness_n_per_m: [[4.0e+06, -0.1], [-0.1, 3.0e+06]]
ratios: [0.02, -0, 1.0e+300, 123456789012345680]
modes: [1, 2]
sites:
  - id: "on"
    interface:
      - dof: roof
    rig:
      armed: false
  - id: "5"
    interface:
      - dof: "a: \"b\"\\ \n\tc # )"
                                   "\xC3\xA9"
                                   R"("
      - dof: ""
empty: {}
none: []
)";

TEST(ConfigDocument, EffectiveListsAllValuesReadWithDefaults) { EXPECT_EQ(effective_of(kFile), kEffective); }

TEST(ConfigDocument, EffectiveTextRoundTrips) { EXPECT_EQ(effective_of(kEffective), kEffective); }

TEST(ConfigDocument, EffectiveDoesNotDependOnOrderOrForm) {
  const std::string reordered = R"(
sites:
  - interface: [{dof: roof}]
    rig: {armed: false}
    id: 'on'
  - interface:
      - dof: "a: \"b\"\\ \n\tc # \xe9"
      - {dof: ''}
    id: '5'
stiffness_n_per_m: [[4e6, -1.0e-1], [-.1, 3.0e6]]
dofs: ["floor 1", "roof"]
mass_kg: {floor 1: 1.50, roof: 20000.0}
none: []
empty: {}
ratios: [2e-2, -0., 1e300, 1.2345678901234568e17]
modes:
- 1
- 2
time:
  mode: lockstep
  time_scale: 1.0   # the default
  step_s: .001
name: unnamed
)";
  EXPECT_EQ(effective_of(reordered), kEffective);
}

TEST(ConfigDocument, EffectiveChangesWithAnyValue) {
  std::string changed = kFile;
  changed.replace(changed.find("1.0e-3"), 6, "1.1e-3");
  EXPECT_NE(effective_of(changed), kEffective);
}

TEST(ConfigDocument, EffectiveNumbersKeepTheirBits) {
  for (const double value :
       {0.1, 1.0 / 3.0, 5e-324, 1.7976931348623157e308, -2.2250738585072014e-308, 1e21, 1e22, 123e-7}) {
    Document first = Document::parse("{}", "test.yaml");
    (void)first.root().number("x", kAnyNumber, value);
    Document again = Document::parse(first.effective(), "test.yaml");
    EXPECT_EQ(again.root().number("x"), value) << first.effective();
    EXPECT_FALSE(again.has_errors());
  }
}

TEST(ConfigDocument, EffectiveStringsKeepTheirBytes) {
  for (const std::string& text :
       {std::string{"null"}, std::string{"Yes"}, std::string{"~"}, std::string{"1e5"}, std::string{".nan"},
        std::string{"- a"}, std::string{"a #b"}, std::string{" a "}, std::string{"\r\n"}, std::string{"\0\x01\x7F", 3},
        std::string{"{a: [b]}"}, std::string{"..."}, std::string{"---"}, std::string{"\xE2\x80\xA8"}}) {
    Document first = Document::parse("{}", "test.yaml");
    (void)first.root().text("x", text);
    Document again = Document::parse(first.effective(), "test.yaml");
    EXPECT_EQ(again.root().text("x"), text) << first.effective();
    EXPECT_FALSE(again.has_errors());
  }
}

TEST(ConfigDocument, EmptyConfigurationIsAMapping) {
  EXPECT_EQ(Document::parse("{}", "test.yaml").effective(), "{}\n");
  EXPECT_EQ(Document::parse("{}\n", "test.yaml").root().keys().size(), 0U);
}

TEST(ConfigDocument, LoadsFileAndKeepsItsDirectory) {
  const TemporaryFile file{"a: 1\n"};
  Document document = Document::load(file.path(), {"a=2"});
  EXPECT_EQ(document.root().number("a"), 2.0);
  EXPECT_EQ(document.directory(), file.path().parent_path());
  EXPECT_FALSE(document.has_errors());
  EXPECT_NO_THROW(document.throw_if_errors());
}

TEST(ConfigDocument, ReportsWhyFileCannotBeRead) {
  try {
    (void)Document::load("no/such/file.yaml");
    FAIL() << "loaded";
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(), "no/such/file.yaml: cannot be read: no such file; expected a configuration file (YAML)");
  }
  EXPECT_THROW((void)Document::load(testing::TempDir()), ConfigError);
}

TEST(ConfigDocument, RejectsOversizedFileBeforeReadingAll) {
  const TemporaryFile file{std::string((std::size_t{4} << 20U) + 1, '#')};
  try {
    (void)Document::load(file.path());
    FAIL() << "loaded";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("larger than 4 MiB"));
  }
}

TEST(ConfigDocument, SectionsRemainValidAfterDocumentMove) {
  Document first = Document::parse("a: {b: 5}\n", "test.yaml");
  Section section = first.root().section("a");
  Document second = std::move(first);
  EXPECT_EQ(section.number("b"), 5.0);
  EXPECT_EQ(second.effective(), "a:\n  b: 5\n");
  (void)section.number("c");
  EXPECT_TRUE(second.has_errors());
}

TEST(ConfigDocument, ThrowsAllErrorsInOneMessage) {
  Document document = Document::parse("a: x\n", "test.yaml");
  EXPECT_FALSE(document.has_errors());
  (void)document.root().number("a");
  (void)document.root().number("b");
  ASSERT_TRUE(document.has_errors());
  try {
    document.throw_if_errors();
    FAIL() << "did not throw";
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(),
                 "test.yaml:1:1: b: missing; expected a finite number\n"
                 "test.yaml:1:4: a: expected a finite number, found the text \"x\"");
    ASSERT_EQ(error.issues().size(), 2U);
    EXPECT_EQ(error.issues()[1].file, "test.yaml");
    EXPECT_EQ(error.issues()[1].line, 1);
    EXPECT_EQ(error.issues()[1].column, 4);
  }
}

}  // namespace
}  // namespace hybridtest::config
