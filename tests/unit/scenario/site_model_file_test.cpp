#include "scenario/site_model_file.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "core/config_error.hpp"
#include "diagnosis/runs/diagnose_site.hpp"
#include "plant/site_stages.hpp"
#include "tests/unit/scenario/scenario_file.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1e-3;

class SiteFile : public testing::Test {
 protected:
  SiteModelFile read(const std::string& text, std::string_view id = {}) {
    std::ofstream{directory_ / "site.yaml"} << text;
    return read_site_model(directory_ / "site.yaml", id);
  }
  std::string error_of(const std::string& text) {
    try {
      static_cast<void>(read(text));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return {};
  }
  TemporaryDirectory directory_;
};

double force_at(const SiteModel& model, const Motion& motion) {
  SpecimenStage stage{model, kPeriod_s};
  return stage.step({.motion = motion});
}

TEST_F(SiteFile, OmitsIdealParts) {
  const SiteModelFile site = read("effects: [{interface: specimen, effect: inertia, mass_kg: 95.0}]\n");
  ASSERT_EQ(site.dofs.size(), 1U);
  TransferStage transfer{site.dofs[0], kPeriod_s};
  EXPECT_EQ(transfer.step({.motion = {.displacement_m = 0.25}}), 0.25);
  EXPECT_EQ(force_at(site.dofs[0], {.displacement_m = 1.0, .acceleration_m_per_s2 = 2.0}), 190.0);
  EXPECT_FALSE(site.dofs[0].make_compensator);
}

TEST_F(SiteFile, GivenCompensatorsReplaceMissingOnesOnly) {
  const std::string given = "- type: none\n";
  const auto read_with = [&](const std::string& text) {
    std::ofstream{directory_ / "site.yaml"} << text;
    return read_site_model(directory_ / "site.yaml", {}, given);
  };
  const std::string parts = "specimen: {type: elastic, stiffness_n_per_m: 4.0e6}\n";
  for (const std::string& text : {parts, std::string{"rig: {specimen: {type: elastic, stiffness_n_per_m: 4.0e6}}\n"}}) {
    const SiteModelFile site = read_with(text);
    EXPECT_EQ(site.compensators, given);
    EXPECT_TRUE(site.compensators_were_given);
    EXPECT_TRUE(site.dofs[0].make_compensator);
    EXPECT_EQ(read(site.text).compensators, given) << site.text;
  }
  const SiteModelFile own = read_with("compensator: {type: newmark_kinematics, delay_s: 0.01}\n" + parts);
  EXPECT_THAT(own.compensators, testing::StartsWith("- type: newmark_kinematics\n  delay_s: 0.01\n"));
  EXPECT_FALSE(own.compensators_were_given);
  EXPECT_EQ(read(own.text).compensators, own.compensators);
}

/// A completed model has one compensator with the right setting, and not a wrong one with a correction.
TEST_F(SiteFile, WrongSettingIsCorrectedInTheCompensator) {
  const std::vector<ListedEffect> causes{
      {{find_effect(EffectInterface::compensator, "setting_mismatch"), {0.0125}}, {}},
      {{find_effect(EffectInterface::compensator, "bias"), {1.0e-3}}, {}}};
  for (const std::string& parts : {std::string{"specimen: {type: elastic, stiffness_n_per_m: 4.0e6}\n"},
                                   std::string{"rig: {specimen: {type: elastic, stiffness_n_per_m: 4.0e6}}\n"}}) {
    const SiteModelFile set = read("compensator: {type: newmark_kinematics, delay_s: 0.0105}\n" + parts);
    const SiteModelFile corrected = read(set.with_effects(causes).text);
    EXPECT_EQ(corrected.compensators, set.with_effects(causes).compensators);
    EXPECT_EQ(corrected.dofs[0].compensator_delay.set_s, 0.0105 + 0.0125);
    EXPECT_EQ(setting_change_s(corrected.dofs[0]), 0.0);
    ASSERT_EQ(corrected.dofs[0].effects.size(), 1U) << corrected.text;
    EXPECT_EQ(corrected.dofs[0].effects[0].type->name, "bias");

    const SiteModelFile none = read(read("compensator: {type: none}\n" + parts).with_effects(causes).text);
    EXPECT_THAT(none.compensators, testing::HasSubstr("polynomial_displacement"));
    EXPECT_EQ(none.dofs[0].compensator_delay.set_s, 0.0125);

    // Without a setting that could be changed, the effect stays an effect.
    for (const std::string beside : {"", "compensator: {type: adaptive_time_series}\n"}) {
      const SiteModelFile other = read(beside + parts);
      EXPECT_EQ(other.with_effects(causes).compensators, other.compensators);
      EXPECT_EQ(read(other.with_effects(causes).text).dofs[0].effects.size(), 2U);
    }
  }
}

/// The specimen is the same, and the damper has numbers of its own.
TEST_F(SiteFile, FluidDampersStandBesideTheLaw) {
  const std::string damper = "{type: viscous, damping_n_s_per_m: 3.0e4, exponent: 0.5}";
  const std::string both =
      fmt::format("{{type: parallel, laws: [{{type: elastic, stiffness_n_per_m: 100.0}}, {}]}}", damper);
  struct Case {
    std::string text;
    bool has_law = true;
    std::size_t effects = 1;
  };
  for (const Case& one :
       {Case{fmt::format("specimen: {}\n", damper), false}, Case{fmt::format("rig: {{specimen: {}}}\n", both)},
        Case{fmt::format("specimen: {{type: parallel, laws: [{}]}}\n"
                         "effects: [{{interface: specimen, effect: inertia, mass_kg: 2.0}}]\n",
                         both),
             true, 2}}) {
    SCOPED_TRACE(one.text);
    const SiteModelFile plain = read(one.text);
    const SiteModelFile moved = read_site_model(directory_ / "site.yaml", {}, {}, Dampers::beside_law);
    EXPECT_EQ(static_cast<bool>(moved.dofs[0].make_law), one.has_law);
    ASSERT_EQ(moved.dofs[0].effects.size(), one.effects);
    const EffectSetting& effect = moved.dofs[0].effects.back();
    EXPECT_EQ(effect.type->name, "nonlinear_viscous_damping");
    EXPECT_EQ(effect.values, (std::vector<double>{3.0e4, 0.5, 0.0}));
    for (const SiteModelFile& other : {moved, read(moved.text)}) {
      EXPECT_EQ(other.dofs[0].effects.size(), one.effects);
      for (const double velocity : {-0.3, 0.01, 0.7}) {
        const Motion motion{.displacement_m = 0.02, .velocity_m_per_s = velocity, .acceleration_m_per_s2 = 1.5};
        EXPECT_NEAR(force_at(other.dofs[0], motion), force_at(plain.dofs[0], motion), 1e-9);
      }
    }
  }
}

/// Linear dampers and a friction, too; the friction follows the displacement.
TEST_F(SiteFile, LinearDampersAndAFrictionStandBesideTheLaw) {
  const SiteModelFile plain = read(
      "specimen: {type: parallel, laws: [{type: elastic, stiffness_n_per_m: 100.0}, {type: viscous, damping_n_s_per_m: "
      "3.0}, {type: viscous, damping_n_s_per_m: 4.0}, {type: friction, friction_force_n: 50.0, "
      "presliding_displacement_m: 0.03}]}\n");
  const SiteModelFile moved = read_site_model(directory_ / "site.yaml", {}, {}, Dampers::beside_law);
  const std::vector<EffectSetting>& effects = moved.dofs[0].effects;
  ASSERT_EQ(effects.size(), 3U);
  EXPECT_EQ(effects[0].type->name, "viscous_damping");
  EXPECT_EQ(effects[1].values, std::vector<double>{4.0});
  EXPECT_EQ(effects[2].type->name, "coulomb_friction");
  EXPECT_EQ(effects[2].values, (std::vector<double>{50.0, 0.0, 0.03, 0.0}));
  for (const double displacement : {0.01, 0.02, -0.4}) {
    const Motion motion{.displacement_m = displacement, .velocity_m_per_s = 0.7, .acceleration_m_per_s2 = 1.5};
    EXPECT_NEAR(force_at(moved.dofs[0], motion), force_at(plain.dofs[0], motion), 1e-12);
  }
}

/// Of two such dampers neither could take the other's place.
TEST_F(SiteFile, TwoDampersThatTakeAPlaceStayInTheLaw) {
  const std::string damper = "{type: viscous, damping_n_s_per_m: 3.0e4, exponent: 0.5}";
  const std::string friction = "{type: friction, friction_force_n: 50.0}";
  for (const std::string& law : {fmt::format("{{type: parallel, laws: [{}, {}]}}", damper, damper),
                                 fmt::format("{{type: parallel, laws: [{}, {}]}}", friction, friction)}) {
    const SiteModelFile plain = read("specimen: " + law + "\n");
    const SiteModelFile moved = read_site_model(directory_ / "site.yaml", {}, {}, Dampers::beside_law);
    EXPECT_EQ(moved.text, plain.text);
    EXPECT_TRUE(moved.dofs[0].effects.empty());
  }
}

TEST_F(SiteFile, EffectFollowsARecordedInputAndIsWrittenAgain) {
  const SiteModelFile site = read(
      "specimen: {type: elastic, stiffness_n_per_m: 100.0}\n"
      "effects: [{interface: specimen, effect: force_with_input, input: current_a, force_ratio_per_unit: 0.5, "
      "reference_input: 1.0, nominal_input: 3.0}]\n");
  const EffectType& type = with_input(*find_effect(EffectInterface::specimen, "force_with_input"), "current_a");
  ASSERT_EQ(site.dofs[0].effects.size(), 1U);
  EXPECT_EQ(site.dofs[0].effects[0].type, &type);
  EXPECT_EQ(force_at(site.dofs[0], {.displacement_m = 1.0}), 200.0);  // nothing is recorded: nominal
  const EffectType& damping = with_input(*find_effect(EffectInterface::specimen, "damping_with_input"), "speed_rpm");
  const std::vector<ListedEffect> added{{{&damping, {7.0, 0.0, 2.0}}, {}}};
  const SiteModelFile again = read(site.with_effects(added).text);
  ASSERT_EQ(again.dofs[0].effects.size(), 2U) << again.text;
  EXPECT_EQ(again.dofs[0].effects[0].type, &type);
  EXPECT_EQ(again.dofs[0].effects[1].type, &damping);
  EXPECT_EQ(again.dofs[0].effects[1].values, added[0].setting.values);
}

TEST_F(SiteFile, InputNeedsAPlainNameAndANominalValue) {
  const auto error_with = [&](const std::string& keys) {
    return error_of("effects: [{interface: specimen, effect: damping_with_input, damping_n_s_per_m_per_unit: 1.0, " +
                    keys + "}]\n");
  };
  EXPECT_EQ(error_with("input: current_a, nominal_input: 1.0"), "");
  EXPECT_THAT(error_with("nominal_input: 1.0"), testing::HasSubstr("site.yaml:1:"));
  EXPECT_THAT(error_with("nominal_input: 1.0"), testing::HasSubstr("input"));
  EXPECT_THAT(error_with("input: current_a"), testing::HasSubstr("nominal_input"));
  EXPECT_THAT(error_with("input: Current A, nominal_input: 1.0"),
              testing::HasSubstr("'Current A' is no name of a recorded input"));
  EXPECT_THAT(error_of("effects: [{interface: specimen, effect: inertia, mass_kg: 1.0, input: current_a}]\n"),
              testing::HasSubstr("input"));
}

TEST_F(SiteFile, RecordingWithoutAnInputOfTheModelIsRefused) {
  const SiteModelFile site = read(
      "effects: [{interface: specimen, effect: damping_with_input, input: current_a, damping_n_s_per_m_per_unit: 1.0, "
      "nominal_input: 1.0}]\n");
  Recording recording;
  recording.file = "plain.csv";
  recording.dofs.resize(1);
  try {
    require_match(site, {&recording, 1});
    FAIL() << "was accepted";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("plain.csv has no column input_current_a"));
  }
}

TEST_F(SiteFile, SaysThatItsRecordingsAreQuasiStatic) {
  const std::string parts = "specimen: {type: elastic, stiffness_n_per_m: 1.0}\n";
  EXPECT_FALSE(read(parts).is_quasi_static);
  for (const SiteModelFile& site : {read("quasi_static: true\n" + parts),
                                    read("quasi_static: true\nrig: {" + parts.substr(0, parts.size() - 1) + "}\n")}) {
    EXPECT_TRUE(site.is_quasi_static);
    EXPECT_TRUE(read(site.with_effects({}).text).is_quasi_static);
  }
}

TEST_F(SiteFile, WrongSettingIsCorrectedAtItsDegreeOfFreedom) {
  const SiteModelFile site = read(
      "compensator: {type: newmark_kinematics, delay_s: 0.01}\n"
      "specimen: [{type: elastic, stiffness_n_per_m: 1.0}, {type: elastic, stiffness_n_per_m: 2.0}]\n");
  const ListedEffect cause{{find_effect(EffectInterface::compensator, "setting_mismatch"), {0.005}}, 1};
  const SiteModelFile corrected = read(site.with_effects({&cause, 1}).text);
  EXPECT_EQ(corrected.dofs[0].compensator_delay.set_s, 0.01);
  EXPECT_EQ(corrected.dofs[1].compensator_delay.set_s, 0.015);
}

TEST_F(SiteFile, IsTheSameAtTopUnderRigAndInScenario) {
  const std::string parts =
      "transfer_system: {type: delay, delay_s: 0.002}\n"
      "specimen: {type: elastic, stiffness_n_per_m: 4.0e6}\n";
  const std::string beside = "control_rate_hz: 512\ncompensator: {type: polynomial_displacement, delay_s: 0.01}\n";
  for (const SiteModelFile& site :
       {read(beside + parts),
        read(beside + "rig:\n  type: simulated\n  transfer_system: {type: delay, delay_s: 0.002}\n"
                      "  specimen: {type: elastic, stiffness_n_per_m: 4.0e6}\n")}) {
    EXPECT_EQ(site.control_rate_hz, 512.0);
    EXPECT_EQ(site.dofs[0].removable_delay_s, 0.002);
    EXPECT_TRUE(site.dofs[0].make_compensator);
    EXPECT_EQ(force_at(site.dofs[0], {.displacement_m = 0.5}), 2.0e6);
    EXPECT_EQ(read(site.text).text, site.text);
  }
  const SiteModelFile site = read(kScenarioText);
  EXPECT_EQ(site.name, "storey_1");
  EXPECT_EQ(site.part, "the rig of storey_1");
  EXPECT_EQ(site.dofs[0].noise.force_noise_n, 50.0);
  EXPECT_EQ(read(site.text).text, site.text);
  EXPECT_EQ(read(site.text).dofs[0].removable_delay_s, 0.004);
}

/// From none at all to far ahead, so that a search for what was set finds a compensator everywhere.
TEST_F(SiteFile, CompensatorCanBeMadeForEveryAllowedDelay) {
  for (const char* text :
       {"{type: polynomial_displacement, delay_s: 0.01}",
        "{type: polynomial_displacement, delay_s: 0.01, point_spacing_s: 0.0029}",
        "{type: newmark_kinematics, delay_s: 0.01}", "{type: linear_acceleration, delay_s: 0.01}",
        "{type: linear_acceleration, delay_s: 0.01, point_spacing_s: 0.0029}",
        "{type: inverse_compensation, delay_s: 0.01}", "{type: adaptive_inverse, delay_s: 0.01}", "{type: none}"}) {
    const SiteModel model = read("compensator: " + std::string{text} + "\n").dofs[0];
    const DelaySetting setting = model.compensator_delay;
    EXPECT_GT(setting.most_s, 0.0) << text;
    for (const double share : {0.0, 0.01, 0.3, 1.0}) {
      const double delay_s = share * setting.most_s;
      EXPECT_NO_THROW(static_cast<void>(model.make_compensator(0.002, delay_s - setting.set_s))) << text << delay_s;
    }
    EXPECT_NO_THROW(static_cast<void>(model.make_compensator(0.002, 0.0))) << text;
  }
  EXPECT_EQ(read("compensator: {type: adaptive_time_series}\n").dofs[0].compensator_delay.most_s, 0.0);
}

TEST_F(SiteFile, AddedEffectsFollowExistingOnes) {
  for (const std::string& text :
       {std::string{"specimen: {type: elastic, stiffness_n_per_m: 10.0}\n"},
        std::string{"specimen: {type: elastic, stiffness_n_per_m: 10.0}\n"
                    "effects:\n  - {interface: force_sensor, effect: bias, bias_n: 1.0}\n"}}) {
    const SiteModelFile site = read(text);
    const std::vector<ListedEffect> more{{{find_effect(EffectInterface::specimen, "stiffness_error"), {0.0, -4.0}}, 0},
                                         {{find_effect(EffectInterface::force_sensor, "gain"), {0.5}}, std::nullopt}};
    const SiteModelFile longer = read(site.with_effects(more).text);
    ASSERT_EQ(longer.dofs[0].effects.size(), site.dofs[0].effects.size() + 2);
    const double bias_n = site.dofs[0].effects.empty() ? 0.0 : 1.0;
    EXPECT_DOUBLE_EQ(force_at(longer.dofs[0], {.displacement_m = 1.0}), 1.5 * (6.0 + bias_n));
    EXPECT_EQ(longer.with_effects({}).text, longer.text);
  }
}

TEST_F(SiteFile, CorrectedFrictionTakesThePlaceOfItsOwn) {
  const std::string friction = "{interface: specimen, effect: coulomb_friction, friction_force_n: 4.0}";
  const std::string bias = "{interface: force_sensor, effect: bias, bias_n: 1.0}";
  const std::vector<ListedEffect> added{
      {{find_effect(EffectInterface::specimen, "coulomb_friction"), {3.0, 0.0, 1e-3, 0.0}}, 0},
      {{find_effect(EffectInterface::force_sensor, "gain"), {0.5}}, 0}};
  for (const std::string& list : {fmt::format("[{}, {}]", friction, bias), fmt::format("[{}, {}]", bias, friction)}) {
    const SiteModelFile site = read("specimen: [{type: none}, {type: none}]\neffects: " + list + "\n");
    ASSERT_EQ(force_at(site.dofs[0], {.displacement_m = 1.0}), 5.0);
    const SiteModelFile corrected = read(site.with_effects(added).text);
    EXPECT_EQ(force_at(corrected.dofs[0], {.displacement_m = 1.0}), 1.5 * (3.0 + 1.0));
    EXPECT_EQ(force_at(corrected.dofs[1], {.displacement_m = 1.0}), 5.0);
    EXPECT_EQ(corrected.with_effects({}).text, corrected.text);
    // The same in a scenario's rig.
    const SiteModelFile in_rig = read("rig:\n" + [&] {
      std::string indented;
      std::istringstream lines{site.with_effects(added).rig};
      for (std::string line; std::getline(lines, line);) indented += "  " + line + "\n";
      return indented;
    }());
    EXPECT_EQ(force_at(in_rig.dofs[0], {.displacement_m = 1.0}), 1.5 * (3.0 + 1.0));
    EXPECT_EQ(force_at(in_rig.dofs[1], {.displacement_m = 1.0}), 5.0);
  }
}

/// A law in place of the specimen's own, as a diagnosis finds it.
class ReplacedLaw : public SiteFile {
 protected:
  static std::vector<LawParameter> written(std::span<const double> values) {
    return {{"stiffness_n_per_m", values[0]}, {"yield_force_n", values[1]}, {"hardening_ratio", 0.0}};
  }
  static inline const LawReplacement kLaw{.law = "bilinear", .in_words = "yields", .make = nullptr, .written = written};
  static inline const EffectType kType{.interface = EffectInterface::specimen,
                                       .name = "yielding",
                                       .equation = {},
                                       .source = {},
                                       .traits = {},
                                       .parameters = {},
                                       .replacement = &kLaw};
};

TEST_F(ReplacedLaw, StandsUnderSpecimenAndNotInTheList) {
  const std::vector<ListedEffect> law{{{&kType, {10.0, 4.0}}, std::nullopt}};
  for (const std::string& text :
       {std::string{"specimen: {type: elastic, stiffness_n_per_m: 3.0}\n"}, std::string{"name: without_specimen\n"},
        std::string{"specimen: {type: elastic, stiffness_n_per_m: 3.0}\n"
                    "effects:\n  - {interface: force_sensor, effect: bias, bias_n: 1.0}\n"}}) {
    SCOPED_TRACE(text);
    const SiteModelFile site = read(text);
    const SiteModelFile replaced = read(site.with_effects(law).text);
    EXPECT_EQ(replaced.dofs[0].effects.size(), site.dofs[0].effects.size());
    const double bias_n = site.dofs[0].effects.empty() ? 0.0 : 1.0;
    EXPECT_DOUBLE_EQ(force_at(replaced.dofs[0], {.displacement_m = 0.2}), 2.0 + bias_n);
    EXPECT_DOUBLE_EQ(force_at(replaced.dofs[0], {.displacement_m = 1.0}), 4.0 + bias_n);
  }
}

TEST_F(ReplacedLaw, ConcernsItsDegreeOfFreedomOnly) {
  const SiteModelFile site = read(
      "specimen:\n  - {type: elastic, stiffness_n_per_m: 3.0}\n"
      "  - {type: elastic, stiffness_n_per_m: 5.0}\n");
  const SiteModelFile replaced = read(site.with_effects(std::vector<ListedEffect>{{{&kType, {10.0, 4.0}}, 1}}).text);
  ASSERT_EQ(replaced.dofs.size(), 2U);
  EXPECT_DOUBLE_EQ(force_at(replaced.dofs[0], {.displacement_m = 1.0}), 3.0);
  EXPECT_DOUBLE_EQ(force_at(replaced.dofs[1], {.displacement_m = 1.0}), 4.0);
}

TEST_F(SiteFile, NamesKnownParts) {
  EXPECT_THAT(error_of("effects: [{interface: specimen, effect: coulomb_frictoin, friction_force_n: 1.0}]\n"),
              testing::HasSubstr("coulomb_friction"));
  EXPECT_THAT(error_of("effects: [{interface: specimn, effect: inertia, mass_kg: 1.0}]\n"),
              testing::HasSubstr("specimen"));
  EXPECT_THAT(error_of("effects: [{interface: specimen, effect: inertia}]\n"), testing::HasSubstr("mass_kg"));
  EXPECT_THAT(error_of("effects: [{interface: specimen, effect: coulomb_friction, friction_force_n: -1.0}]\n"),
              testing::HasSubstr("friction_force_n"));
  EXPECT_THAT(error_of("transfer_system: {type: delay, delay_s: 0.001}\n"
                       "effects: [{interface: transfer_system, effect: delay, delay_s: -0.002}]\n"),
              testing::HasSubstr("0.001 s of delay"));
  EXPECT_THAT(error_of("specimen: {type: elastic, stiffness_matrix_n_per_m: [[1.0]]}\n"),
              testing::HasSubstr("couples"));
  EXPECT_THAT(error_of("specimens: {type: none}\n"), testing::HasSubstr("did you mean 'specimen'"));
}

TEST_F(SiteFile, EffectCanApplyToOneDof) {
  const SiteModelFile site = read(
      "specimen: [{type: none}, {type: none}]\n"
      "effects:\n"
      "  - {interface: specimen, effect: viscous_damping, damping_n_s_per_m: 5.0, dof: 2}\n"
      "  - {interface: specimen, effect: inertia, mass_kg: 3.0}\n");
  ASSERT_EQ(site.dofs.size(), 2U);
  EXPECT_EQ(force_at(site.dofs[0], {.velocity_m_per_s = 1.0, .acceleration_m_per_s2 = 1.0}), 3.0);
  EXPECT_EQ(force_at(site.dofs[1], {.velocity_m_per_s = 1.0, .acceleration_m_per_s2 = 1.0}), 8.0);
}

TEST_F(SiteFile, AddsLawsInParallel) {
  const std::string text =
      "specimen: {type: parallel, laws: [{type: elastic, stiffness_n_per_m: 100.0}, "
      "{type: viscous, damping_n_s_per_m: 7.0}, {type: parallel, laws: {type: elastic, stiffness_n_per_m: 1.0}}]}\n";
  const SiteModelFile site = read(text);
  ASSERT_EQ(site.dofs.size(), 1U);
  EXPECT_EQ(force_at(site.dofs[0], {.displacement_m = 2.0, .velocity_m_per_s = 3.0}), 202.0 + 21.0);
  EXPECT_EQ(read(site.text).text, site.text);
  EXPECT_THAT(error_of("specimen: {type: parallel, laws: []}\n"), testing::HasSubstr("no law in parallel"));
  EXPECT_THAT(error_of("specimen: {type: parallel}\n"), testing::HasSubstr("laws"));
  EXPECT_THAT(error_of("specimen: {type: parallel, laws: [{type: elastik, stiffness_n_per_m: 1.0}]}\n"),
              testing::HasSubstr("did you mean 'elastic'"));
}

TEST_F(SiteFile, RefusesListsOfDifferentLengths) {
  EXPECT_THAT(error_of("transfer_system: [{type: ideal}, {type: ideal}, {type: ideal}]\n"
                       "specimen: [{type: none}, {type: none}]\n"),
              testing::AllOf(testing::HasSubstr("specimen"), testing::HasSubstr("2 given; expected 3"),
                             testing::HasSubstr("{type: parallel, laws: [...]}")));
  EXPECT_THAT(error_of("transfer_system: [{type: ideal}, {type: ideal}]\n"
                       "specimen: [{type: none}, {type: none}, {type: none}]\n"),
              testing::AllOf(testing::HasSubstr("transfer_system"), testing::HasSubstr("2 given; expected 3")));
  EXPECT_THAT(error_of("specimen: [{type: none}, {type: none}, {type: none}]\n"
                       "compensator: [{type: none}, {type: none}]\n"),
              testing::HasSubstr("expected one, or one for each degree of freedom"));
}

Recording recording_of(std::size_t dofs) {
  Recording recording;
  recording.file = "test.csv";
  recording.sample_period_s = kPeriod_s;
  recording.samples = 100;
  recording.dofs.resize(dofs);
  for (DofRecording& dof : recording.dofs) dof.of(Channel::measured_displacement).assign(recording.samples, 0.0);
  return recording;
}

TEST_F(SiteFile, ADiagnosisRefusesOtherDegreesOfFreedom) {
  const auto refusal = [&](const std::string& text, std::size_t dofs) -> std::string {
    const SiteModelFile model = read(text);
    const std::vector<Recording> recordings{recording_of(model.dofs.size()), recording_of(dofs)};
    try {
      require_match(model, recordings);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return {};
  };
  const std::string two =
      "specimen: [{type: elastic, stiffness_n_per_m: 1.0}, {type: viscous, damping_n_s_per_m: 1.0}]\n";
  EXPECT_THAT(refusal(two, 1),
              testing::AllOf(testing::HasSubstr("test.csv has 1 degrees of freedom"), testing::HasSubstr("has 2"),
                             testing::HasSubstr("{type: parallel, laws: [...]}")));
  EXPECT_THAT(refusal("specimen: {type: none}\n", 2), testing::HasSubstr("test.csv has 2 degrees of freedom"));
  EXPECT_EQ(refusal(two, 2), "");
}

}  // namespace
}  // namespace hybridtest
