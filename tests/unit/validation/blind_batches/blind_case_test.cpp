#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "validation/blind_batches/batch.hpp"
#include "validation/blind_batches/plant/blind_case.hpp"
#include "validation/blind_batches/plant/effect_catalogue.hpp"

namespace hybridtest::blind {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr std::uint64_t kSeed = 20;

/// The first case of the seed whose site passes.
template <class Predicate>
CaseSetting setting_with(Predicate passes) {
  for (std::uint64_t index = 0;; ++index) {
    CaseSetting setting = draw_case_setting(kSeed, index);
    if (passes(setting)) return setting;
  }
}

bool is_elastic_and_commanded(const CaseSetting& setting) {
  return setting.site.specimen.kind == LawKind::elastic && setting.columns.command;
}

std::string files_of(const BlindCase& blind_case) {
  std::string text = site_yaml(blind_case.setting.site);
  for (const PlantRecording& recording : blind_case.fit) {
    text += recording_csv(recording, blind_case.setting.columns, blind_case.setting.site.rate_hz);
  }
  return text + recording_csv(blind_case.held_out, blind_case.setting.columns, blind_case.setting.site.rate_hz);
}

TEST(BlindCase, SeedRepeatsTheSameBytes) {
  const BlindCase once = draw_case(kSeed, 3);
  const BlindCase again = draw_case(kSeed, 3);
  EXPECT_EQ(files_of(once), files_of(again));
  EXPECT_EQ(truth_json("a", once), truth_json("a", again));
  EXPECT_NE(files_of(once), files_of(draw_case(kSeed + 1, 3)));
}

TEST(BlindCase, WithoutEffectTheModelLeavesOnlyNoise) {
  for (std::uint64_t index = 0; index < 12; ++index) {
    const BlindCase none = make_case(draw_case_setting(kSeed, index), TruthClass::none, {}, kSeed, index);
    const Site& site = none.setting.site;
    if (none.setting.columns.command) {
      const History residual = difference(none.held_out.measured_m,
                                          stage_output(Residual::transfer_system, site, {}, none.held_out.command_m));
      // The deviation of a standard deviation over 6000 or more samples: 1 / sqrt(12000), four times.
      EXPECT_NEAR(rms(residual), site.displacement_noise_m, 0.04 * site.displacement_noise_m) << index;
    }
    if (site.specimen.kind == LawKind::elastic) {
      const History residual =
          difference(none.held_out.measured_n, stage_output(Residual::specimen, site, {}, none.held_out.measured_m));
      const double both = std::hypot(site.force_noise_n, site.specimen.stiffness_n_per_m * site.displacement_noise_m);
      EXPECT_NEAR(rms(residual), both, 0.04 * both) << index;
    }
  }
}

TEST(BlindCase, FilesOfOneSiteDifferOnlyInMeasuredValues) {
  const CaseSetting setting = setting_with(is_elastic_and_commanded);
  const std::string without = files_of(make_case(setting, TruthClass::none, {}, kSeed, 1));
  for (const auto* catalogue : {&named_effects(), &wrong_numbers(), &foreign_effects()}) {
    for (const CatalogueEntry& entry : fitting(*catalogue, setting)) {
      RandomStream random{kSeed, 1, "effect"};
      const PlantEffect effect{entry.interface, entry.name, entry.draw(random, setting, 0.1)};
      // The class says nothing about the files; `unknown` spares the search for look-alikes.
      const BlindCase with = make_case(setting, TruthClass::unknown, {effect}, kSeed, 1);
      const std::string text = files_of(with);
      EXPECT_EQ(text.size(), without.size()) << entry.name;
      EXPECT_NE(text, without) << entry.name << " has no effect";
      EXPECT_EQ(text.substr(0, text.find("\n0.0000000,")), without.substr(0, without.find("\n0.0000000,")));
    }
  }
}

TEST(BlindCase, NoFileNamesAnEffect) {
  for (std::uint64_t index = 0; index < 4; ++index) {
    const BlindCase blind_case = draw_case(kSeed, index);
    std::string text = files_of(blind_case);
    if (blind_case.setting.site.specimen.kind == LawKind::none) continue;  // its model lists what the user knows
    for (const auto* catalogue : {&named_effects(), &wrong_numbers(), &foreign_effects()}) {
      for (const CatalogueEntry& entry : *catalogue) {
        if (entry.name == "delay" || entry.name == "bandwidth") continue;  // words of the user's own model
        EXPECT_THAT(text, Not(HasSubstr(entry.name))) << index;
      }
    }
    text += "coulomb_friction";
    EXPECT_THAT(text, HasSubstr("coulomb_friction"));  // the search can find one
  }
}

TEST(BlindCase, GapToFloorMatchesTheSignals) {
  CaseSetting setting = setting_with(is_elastic_and_commanded);
  const double stiffness = setting.site.specimen.stiffness_n_per_m;
  const PlantEffect bias{"force_sensor", "bias", {{"bias_n", 0.05 * setting.scales.force_n}}};
  const BlindCase biased = make_case(setting, TruthClass::named, {bias}, kSeed, 1);
  const double noise_n = std::hypot(setting.site.force_noise_n, stiffness * setting.site.displacement_noise_m);
  EXPECT_NEAR(biased.truth.gap_to_floor, 0.05 * setting.scales.force_n / noise_n, 0.04 * biased.truth.gap_to_floor);
  EXPECT_THAT(biased.truth.acceptable, Contains(Cause{"force_sensor", "bias"}));
  EXPECT_THAT(biased.truth.acceptable, Not(Contains(Cause{"specimen", "inertia"})));
}

TEST(BlindCase, WrongStiffnessEqualsForceGainOnElasticSpecimen) {
  const CaseSetting setting = setting_with(is_elastic_and_commanded);
  const PlantEffect soft{"specimen", "stiffness_error", {{"stiffness_ratio", 0.8}}};
  const BlindCase blind_case = make_case(setting, TruthClass::named, {soft}, kSeed, 1);
  EXPECT_THAT(blind_case.truth.acceptable, Contains(Cause{"force_sensor", "gain"}));
  EXPECT_THAT(blind_case.truth.acceptable, Not(Contains(Cause{"specimen", "coulomb_friction"})));
  // What is left is noise: the share of the variance is (floor / gap)^2.
  EXPECT_NEAR(blind_case.truth.variance_removed, 1.0, 2.0 / std::pow(blind_case.truth.held_out_gap_to_floor, 2));
}

}  // namespace
}  // namespace hybridtest::blind
