#include "scenario/catalogue/documentation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/config_error.hpp"
#include "plant/effects/effect_type.hpp"
#include "scenario/catalogue/parameter_table.hpp"

namespace hybridtest {
namespace {

const std::filesystem::path kPage = std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "docs/scenario.md";

std::string documentation() {
  std::ifstream file{kPage, std::ios::binary};
  return {std::istreambuf_iterator<char>{file}, {}};
}

/// HYBRIDTEST_WRITE_DOCS=1 brings the page up to date in place of comparing it.
TEST(Documentation, HasTheTablesOfTheCatalogue) {
  const std::string expected = with_generated_parts(documentation());
  if (std::getenv("HYBRIDTEST_WRITE_DOCS") != nullptr) std::ofstream{kPage, std::ios::binary} << expected;
  EXPECT_TRUE(documentation() == expected)
      << "docs/scenario.md is not up to date; run this test with HYBRIDTEST_WRITE_DOCS=1 to write its tables";
}

TEST(Documentation, AChangedTableIsFound) {
  std::string page = documentation();
  const std::size_t place = page.find("`presliding_displacement_m` | m |");
  ASSERT_NE(place, std::string::npos);
  page.replace(place, 3, "`no");
  EXPECT_FALSE(with_generated_parts(page) == page);
}

TEST(Documentation, APartWithoutItsMarkersIsRefused) {
  EXPECT_THROW(static_cast<void>(with_generated_parts("# Scenario files\n")), ConfigError);
}

TEST(EffectsText, NamesEveryEffectAndParameter) {
  const std::string text = effects_text();
  for (const EffectType& type : effect_library()) {
    EXPECT_THAT(text, testing::HasSubstr(std::string{name_of(type.interface)} + " " + std::string{type.name} + "\n"));
    for (const EffectParameter& parameter : type.parameters) {
      EXPECT_THAT(text, testing::HasSubstr(std::string{parameter.name} + ": "));
    }
  }
}

}  // namespace
}  // namespace hybridtest
