#include "diagnosis/identification/search_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "plant/effects/recorded_input.hpp"

namespace hybridtest {
namespace {

std::string label(EffectInterface interface, std::string_view effect, std::string_view parameter) {
  return std::string{name_of(interface)} + "." + std::string{effect} + "." + std::string{parameter};
}

/// Parameters that a fit must search, because nothing else gives them a value, and that have no row.
std::vector<std::string> without_a_row(std::span<const EffectType> library, const auto& row_of) {
  std::vector<std::string> missing;
  for (const EffectType& type : library) {
    for (const EffectParameter& parameter : type.parameters) {
      if (parameter.name == kNominalInput.name) continue;  // comes from the recordings
      if (std::isnan(parameter.fallback) && row_of(type, parameter) == nullptr) {
        missing.push_back(label(type.interface, type.name, parameter.name));
      }
    }
  }
  return missing;
}

TEST(SearchTable, HasARowForEveryParameterWithoutFallback) {
  EXPECT_EQ(without_a_row(effect_library(), search_range), std::vector<std::string>{});
}

TEST(SearchTable, MissingRowIsFound) {  // control
  const auto forgets_one = [](const EffectType& type, const EffectParameter& parameter) {
    return parameter.name == "friction_force_n" && type.name == "coulomb_friction" ? nullptr
                                                                                   : search_range(type, parameter);
  };
  EXPECT_EQ(without_a_row(effect_library(), forgets_one),
            std::vector<std::string>{"specimen.coulomb_friction.friction_force_n"});
}

TEST(SearchTable, ColumnIsNoShorterThanTenDrifts) {
  // With a drift of a tenth of its height, a column has collapsed.
  const EffectType& column = *find_effect(EffectInterface::specimen, "geometric_stiffness");
  const auto height = std::ranges::find(column.parameters, "height_m", &EffectParameter::name);
  const SearchRange* const range = search_range(column, *height);
  ASSERT_NE(range, nullptr);
  EXPECT_EQ(range->scale, ParameterScale::displacement_m);
  EXPECT_EQ(range->low, 10.0);
}

TEST(SearchTable, LeavesOutOnlySeedsInputsAndTheBoucWenExponent) {
  std::set<std::string> fixed;
  for (const EffectType& type : effect_library()) {
    for (const EffectParameter& parameter : type.parameters) {
      if (parameter.name == kNominalInput.name || parameter.name == kReferenceInput.name) continue;
      if (search_range(type, parameter) == nullptr) {
        fixed.insert(label(type.interface, type.name, parameter.name));
      }
    }
  }
  EXPECT_EQ(fixed, (std::set<std::string>{"network.jitter.seed", "network.loss.seed",
                                          "specimen.bouc_wen_hysteresis.exponent"}));
}

TEST(SearchTable, EveryRowIsOneParameterOfTheLibrary) {
  std::set<std::string> rows;
  for (const SearchRange& range : search_table::kRows) {
    const std::string row = label(range.interface, range.effect, range.parameter);
    EXPECT_TRUE(rows.insert(row).second) << row << " twice";
    const EffectType* const type = find_effect(range.interface, range.effect);
    ASSERT_NE(type, nullptr) << row;
    const auto parameter = std::ranges::find(type->parameters, range.parameter, &EffectParameter::name);
    ASSERT_NE(parameter, type->parameters.end()) << row;
    EXPECT_EQ(search_range(*type, *parameter), &range) << row;
  }
}

TEST(SearchTable, RangesAreNotEmptyAndReachWhatIsAccepted) {
  for (const SearchRange& range : search_table::kRows) {
    const std::string row = label(range.interface, range.effect, range.parameter);
    const EffectType& type = *find_effect(range.interface, range.effect);
    const EffectParameter& parameter = *std::ranges::find(type.parameters, range.parameter, &EffectParameter::name);
    EXPECT_LT(range.low, range.high) << row;
    EXPECT_LT(range.low, parameter.high) << row;
    EXPECT_GT(range.high, parameter.low) << row;
    if (range.scale == ParameterScale::one) {  // a recording does not scale it: within what is accepted
      EXPECT_GE(range.low, parameter.low) << row;
      EXPECT_LE(range.high, parameter.high) << row;
    }
  }
}

}  // namespace
}  // namespace hybridtest
