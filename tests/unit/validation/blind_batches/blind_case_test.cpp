#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

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
  return !setting.loop && setting.site.specimen.kind == LawKind::elastic && setting.columns.command;
}

std::string files_of(const BlindCase& blind_case) {
  std::string text = site_yaml(sites_of(blind_case.setting));
  for (const std::string& csv : case_csv(blind_case)) text += csv;
  return text;
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
    const BlindCase none = make_case(draw_case_setting(kSeed, index), {}, kSeed, index);
    const Site& site = none.setting.site;
    // The deviation of a standard deviation over n white samples: 1 / sqrt(2 n), four times; fewer count where a
    // value remembers the one before.
    const auto samples = static_cast<double>(none.held_out.measured_m.size());
    const auto tolerance = [samples](const NoiseModel& noise) {
      return 4.0 / std::sqrt(2.0 * samples) * std::sqrt((1.0 + noise.memory) / (1.0 - noise.memory));
    };
    if (none.setting.columns.command && site.transfer_system.kind != TransferKind::delay) {
      const History residual = difference(none.held_out.measured_m,
                                          stage_output(Residual::transfer_system, site, {}, none.held_out.command_m));
      const double noise_m = site.displacement_noise_m.rms();
      EXPECT_NEAR(rms(residual), noise_m, tolerance(site.displacement_noise_m) * noise_m) << index;
    }
    if (site.specimen.kind == LawKind::elastic) {
      const History residual =
          difference(none.held_out.measured_n, stage_output(Residual::specimen, site, {}, none.held_out.measured_m));
      const double both =
          std::hypot(site.force_noise_n.rms(), site.specimen.stiffness_n_per_m * site.displacement_noise_m.rms());
      EXPECT_NEAR(rms(residual), both,
                  std::max(tolerance(site.force_noise_n), tolerance(site.displacement_noise_m)) * both)
          << index;
    }
  }
}

TEST(BlindCase, FilesOfOneSiteDifferOnlyInMeasuredValues) {
  CaseSetting setting = setting_with(is_elastic_and_commanded);
  setting.fit_m = {History(setting.fit_m.front().begin(), setting.fit_m.front().begin() + 3000)};  // quicker
  setting.held_out_m = setting.fit_m.front();
  const double period_s = 1.0 / setting.site.rate_hz;
  const MotionHistory motion = motion_of(setting.held_out_m, period_s);
  const double stroke_m = peak(motion.displacement_m);
  setting.scales = {stroke_m, peak(motion.velocity_m_per_s), peak(motion.acceleration_m_per_s2),
                    stroke_m * setting.site.specimen.stiffness_n_per_m, 3000.0 * period_s};
  const std::string without = files_of(make_case(setting, {}, kSeed, 1));
  for (const auto* catalogue : {&named_effects(), &wrong_numbers(), &foreign_effects()}) {
    for (const CatalogueEntry& entry : fitting(*catalogue, setting)) {
      RandomStream random{kSeed, 1, "effect"};
      const PlantEffect effect{entry.interface, entry.name, entry.draw(random, setting, 0.1)};
      const BlindCase with = make_case(setting, {.kind = TruthClass::unknown, .effects = {effect}}, kSeed, 1);
      const std::string text = files_of(with);
      EXPECT_EQ(text.size(), without.size()) << entry.name;
      EXPECT_TRUE(text != without) << entry.name << " has no effect";
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
  const BlindCase biased = make_case(setting, {.kind = TruthClass::named, .effects = {bias}}, kSeed, 1);
  const double noise_n =
      std::hypot(setting.site.force_noise_n.rms(), stiffness * setting.site.displacement_noise_m.rms());
  EXPECT_NEAR(biased.truth.gap_to_floor, 0.05 * setting.scales.force_n / noise_n, 0.2 * biased.truth.gap_to_floor);
  EXPECT_THAT(biased.truth.acceptable, Contains(Cause{"force_sensor", "bias"}));
  EXPECT_THAT(biased.truth.acceptable, Not(Contains(Cause{"specimen", "inertia"})));
}

TEST(BlindCase, WrongStiffnessEqualsForceGainOnElasticSpecimen) {
  const CaseSetting setting = setting_with(is_elastic_and_commanded);
  const PlantEffect soft{"specimen", "stiffness_error", {{"stiffness_ratio", 0.8}}};
  const BlindCase blind_case = make_case(setting, {.kind = TruthClass::named, .effects = {soft}}, kSeed, 1);
  EXPECT_THAT(blind_case.truth.acceptable, Contains(Cause{"force_sensor", "gain"}));
  EXPECT_THAT(blind_case.truth.acceptable, Not(Contains(Cause{"specimen", "coulomb_friction"})));
  // What is left is noise: the share of the variance is (floor / gap)^2.
  EXPECT_NEAR(blind_case.truth.variance_removed, 1.0, 2.0 / std::pow(blind_case.truth.held_out_gap_to_floor, 2));
}

/// A site of the seed without noise, with given wrong numbers and effects.
BlindCase noiseless(CaseSetting setting, RealSite real) {
  setting.site.force_noise_n.standard_deviation *= 1e-3;
  setting.site.displacement_noise_m.standard_deviation *= 1e-3;
  return make_case(std::move(setting), std::move(real), kSeed, 1);
}

TEST(BlindCase, WrongNumbersTakeUpWhatTheyCanGive) {
  const CaseSetting setting = setting_with(is_elastic_and_commanded);
  const PlantEffect stiffness{"specimen", "stiffness_error", {{"stiffness_ratio", 1.03}}};
  const PlantEffect gain{"force_sensor", "gain", {{"gain", 0.95}}};
  const BlindCase seen = noiseless(setting, {.kind = TruthClass::named, .effects = {gain}});
  const BlindCase hidden = noiseless(setting, {.kind = TruthClass::named, .effects = {gain}, .besides = {stiffness}});
  EXPECT_GT(seen.truth.gap_to_floor, 10.0);
  EXPECT_LT(hidden.truth.gap_to_floor, 0.01 * seen.truth.gap_to_floor);
  EXPECT_TRUE(seen.truth.tolerated.empty());
  EXPECT_THAT(hidden.truth.tolerated, Contains(Cause{"specimen", "stiffness_error"}));
  const BlindCase none = noiseless(setting, {.besides = {stiffness}});
  EXPECT_THAT(none.truth.tolerated, Contains(Cause{"force_sensor", "gain"}));
  EXPECT_THAT(none.truth.tolerated, Not(Contains(Cause{"specimen", "coulomb_friction"})));
}

TEST(BlindCase, LatencyAndClockOffsetCannotBeTold) {
  const CaseSetting setting = setting_with([](const CaseSetting& s) { return s.columns.sent && s.columns.target; });
  const PlantEffect late{"network", "latency", {{"delay_s", 0.05}}};
  const PlantEffect uneven{"network", "jitter", {{"jitter_s", 0.01}, {"seed", 3.0}}};
  const BlindCase twin = make_case(setting, {.kind = TruthClass::named, .effects = {late}}, kSeed, 1);
  EXPECT_THAT(twin.truth.acceptable, Contains(Cause{"network", "clock_offset"}));
  EXPECT_FALSE(twin.truth.is_separable);
  EXPECT_TRUE(make_case(setting, {.kind = TruthClass::named, .effects = {uneven}}, kSeed, 1).truth.is_separable);
}

TEST(BlindCase, NoNumberIsWrongTwice) {
  // Here the stiffness of a law that yields was wrong beside the model and once more as the effect.
  const BlindCase drawn = draw_case(607632768, 28);
  ASSERT_EQ(drawn.truth.effects.size(), 1U);
  EXPECT_EQ(drawn.truth.effects.front().name, "stiffness_error");
  for (const PlantEffect& beside : drawn.truth.besides) EXPECT_NE(beside.name, "stiffness_error");
}

TEST(BlindCase, EveryClassAndEveryNoiseIsDrawn) {
  std::set<TruthClass> classes;
  std::set<bool> loops;
  std::set<std::size_t> dofs;
  std::set<int> noises;
  for (std::uint64_t index = 0; index < 60 && (classes.size() < 6 || dofs.size() < 2 || noises.size() < 3); ++index) {
    const BlindCase drawn = draw_case(kSeed, index);
    classes.insert(drawn.truth.kind);
    loops.insert(drawn.setting.loop.has_value());
    dofs.insert(sites_of(drawn.setting).size());
    const NoiseModel& noise = drawn.setting.site.force_noise_n;
    noises.insert(noise.hum_hz > 0.0 ? 2 : noise.memory > 0.0 ? 1 : 0);
    for (const double gap : drawn.truth.effect_gaps_to_floor) EXPECT_TRUE(std::isfinite(gap)) << index;
    EXPECT_EQ(drawn.truth.effects.size(), drawn.truth.effect_gaps_to_floor.size());
    EXPECT_EQ(drawn.truth.effects.size(), drawn.truth.effect_acceptable.size());
  }
  EXPECT_EQ(classes.size(), 6U);
  EXPECT_EQ(loops.size(), 2U);
  EXPECT_EQ(dofs, (std::set<std::size_t>{1, 2}));
  EXPECT_EQ(noises.size(), 3U);
}

TEST(BlindCase, EffectThatMakesATestUnstableIsHalved) {
  const CaseSetting setting = setting_with([](const CaseSetting& s) { return s.loop && !s.loop->other; });
  // Far less damping than the structure has: the load pushes where it should brake.
  const double damping = 2.0 * setting.scales.force_n / setting.scales.velocity_m_per_s;
  const PlantEffect pushing{"specimen", "viscous_damping", {{"damping_n_s_per_m", -damping}}};
  const BlindCase made = make_case(setting, {.kind = TruthClass::named, .effects = {pushing}}, kSeed, 1);
  const double left = made.truth.effects.empty() ? 0.0 : made.truth.effects.front().of("damping_n_s_per_m");
  EXPECT_GT(left, -damping);
  for (const double x : made.held_out.measured_m) ASSERT_LT(std::abs(x), 5.0 * setting.scales.displacement_m);
}

TEST(BlindCase, TwoDegreesOfFreedomHaveNumberedColumns) {
  const CaseSetting setting = setting_with([](const CaseSetting& s) { return s.loop && s.loop->other; });
  const BlindCase none = make_case(setting, {}, kSeed, 1);
  const std::string csv = case_csv(none).front();
  EXPECT_THAT(csv, HasSubstr("measured_force_n_1,"));
  EXPECT_THAT(csv, HasSubstr("measured_force_n_2\n"));
  EXPECT_THAT(site_yaml(sites_of(setting)), HasSubstr("specimen: [{type: "));
}

}  // namespace
}  // namespace hybridtest::blind
