#include "scenario/catalogue/effects_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "plant/effects/effect_type.hpp"

namespace hybridtest {
namespace {

std::string documentation() {
  std::ifstream file{std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "docs/scenario.md"};
  return {std::istreambuf_iterator<char>{file}, {}};
}

TEST(EffectsText, DocumentationMatchesTheLibrary) {
  EXPECT_THAT(documentation(), testing::HasSubstr("<!-- hybridtest effects --markdown -->\n" + effects_markdown() +
                                                  "\n<!-- end of hybridtest effects --markdown -->"))
      << "put what `hybridtest effects --markdown` prints between these two lines of docs/scenario.md";
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
