#include "validation/blind_batches/library_terms.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <set>
#include <string>

#include "plant/effects/effect_type.hpp"
#include "validation/blind_batches/plant/effect_catalogue.hpp"
#include "validation/blind_batches/plant/foreign_laws.hpp"

namespace hybridtest::blind {
namespace {

/// What a diagnosis names without an effect of the library: the law of the user's model with another number.
bool is_a_number_of_a_law(const CatalogueEntry& entry) { return entry.name == "strength_error"; }

TEST(LibraryTerms, EveryEffectAndParameterIsInTheLibrary) {
  const CaseSetting setting = draw_case_setting(1, 0);
  for (const auto* catalogue : {&named_effects(), &wrong_numbers()}) {
    for (const CatalogueEntry& entry : *catalogue) {
      const EffectType* type = nullptr;
      for (const EffectType& of_library : effect_library()) {
        if (name_of(of_library.interface) == entry.interface && of_library.name == entry.name) type = &of_library;
      }
      if (is_a_number_of_a_law(entry)) continue;
      ASSERT_NE(type, nullptr) << entry.interface << "." << entry.name;
      RandomStream random{1, 0, "effect"};
      const PlantEffect effect{entry.interface, entry.name, entry.draw(random, setting, 0.1)};
      for (const auto& [name, value] : in_library_terms(setting.site, effect)) {
        bool is_known = false;
        for (const EffectParameter& parameter : type->parameters) is_known = is_known || parameter.name == name;
        EXPECT_TRUE(is_known) << entry.name << "." << name;
      }
    }
  }
}

TEST(LibraryTerms, RightNamesOfLawsAreEffectsOfTheLibrary) {
  const auto is_known = [](const Cause& cause) {
    return cause.effect == "hysteresis_law" || cause.effect == "strength_error" ||
           std::ranges::any_of(effect_library(), [&](const EffectType& type) {
             return name_of(type.interface) == cause.interface && type.name == cause.effect;
           });
  };
  for (const LawKind users : {LawKind::elastic, LawKind::bilinear}) {
    for (const std::string& law : foreign_laws()) {
      for (const Cause& cause : names_of_law(law, users)) EXPECT_TRUE(is_known(cause)) << cause.effect;
    }
    for (const Cause& cause : parts_of_law(users)) EXPECT_TRUE(is_known(cause)) << cause.effect;
  }
  EXPECT_FALSE(is_known({"specimen", "stiffness_degradation_with_colour"}));  // control
}

TEST(LibraryTerms, ThreeQuartersOfTheKindsHaveOtherEquations) {
  // Those that have the library's own: there is hardly another for them. docs/blind_batches.md tells the others.
  const std::set<std::string> same{
      "network.latency",          "network.clock_offset",        "compensator.bias",
      "transfer_system.delay",    "transfer_system.bandwidth",   "transfer_system.bandwidth_error",
      "transfer_system.gain",     "displacement_sensor.gain",    "displacement_sensor.bias",
      "force_sensor.gain",        "force_sensor.bias",           "force_sensor.time_skew",
      "specimen.stiffness_error", "specimen.strength_error",     "specimen.viscous_damping",
      "specimen.inertia",         "specimen.geometric_stiffness"};
  std::set<std::string> kinds;
  for (const auto* catalogue : {&wrong_numbers(), &named_effects(), &foreign_effects()}) {
    for (const CatalogueEntry& entry : *catalogue) kinds.insert(entry.interface + "." + entry.name);
  }
  for (const std::string& kind : same) EXPECT_TRUE(kinds.contains(kind)) << kind;
  for (const std::string& law : foreign_laws()) kinds.insert("law." + law);
  EXPECT_EQ(kinds.size(), 75U);
  EXPECT_LE(4 * same.size(), kinds.size());
}

TEST(LibraryTerms, TwoPolesAreDelayAndRatio) {
  const Parameters terms =
      in_library_terms({}, {"transfer_system", "bandwidth", {{"natural_frequency_hz", 10.0}, {"damping_ratio", 1.0}}});
  // (1 + s / w)^2: T = 2 / w, r T^2 = 1 / w^2.
  EXPECT_NEAR(terms.at("time_constant_s"), 2.0 / (20.0 * std::numbers::pi), 1e-15);
  EXPECT_NEAR(terms.at("second_order_ratio"), 0.25, 1e-15);
}

TEST(LibraryTerms, FrictionOfTwoSizesIsMeanAndAsymmetry) {
  const Parameters terms = in_library_terms(
      {}, {"specimen", "coulomb_friction", {{"friction_force_n", 30.0}, {"friction_force_backward_n", 10.0}}});
  EXPECT_DOUBLE_EQ(terms.at("friction_force_n") * (1.0 + terms.at("asymmetry")), 30.0);
  EXPECT_DOUBLE_EQ(terms.at("friction_force_n") * (1.0 - terms.at("asymmetry")), 10.0);
}

TEST(LibraryTerms, YieldingIsThatOfTheWholeSpecimen) {
  Site site;
  site.specimen.stiffness_n_per_m = 1e6;
  const Parameters terms =
      in_library_terms(site, {"specimen", "yielding", {{"yield_force_n", 5e3}, {"hardening_ratio", 0.1}}});
  EXPECT_DOUBLE_EQ(terms.at("yield_force_n"), 5e3);
  EXPECT_DOUBLE_EQ(terms.at("stiffness_n_per_m"), 1e6);
}

}  // namespace
}  // namespace hybridtest::blind
