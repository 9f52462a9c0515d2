// A force of the specimen that the user writes as a formula: what is read, what it computes, how it is written again.

#include "scenario/catalogue/formula.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "core/config_error.hpp"
#include "scenario/formula_file.hpp"
#include "scenario/site_model_file.hpp"
#include "tests/unit/scenario/scenario_file.hpp"

namespace hybridtest {
namespace {

using testing::HasSubstr;

constexpr double kPeriod_s = 1e-3;

std::unique_ptr<Effect> made(const std::string& added_force_n, const std::vector<double>& values = {},
                             const std::vector<FormulaNumber>& numbers = {}, const std::string& input = {}) {
  return formula_effect({.name = "made", .added_force_n = added_force_n, .input = input, .numbers = numbers})
      .make(values, kPeriod_s);
}

/// Force with the formula beside a law of 10 N, at the last of some samples.
double force_of(Effect& effect, const std::vector<StageSample>& samples) {
  double force_n = 0.0;
  for (const StageSample& sample : samples) {
    force_n = 10.0;
    effect.after(sample, sample.motion, force_n);
  }
  return force_n - 10.0;
}

TEST(Formula, KnowsMotionTimeAndTheForceBeforeIt) {
  const StageSample sample{.motion = {.displacement_m = 2.0, .velocity_m_per_s = -3.0, .acceleration_m_per_s2 = 5.0},
                           .time_s = 7.0};
  for (const auto& [formula, force_n] : {std::pair{"x", 2.0}, {"v", -3.0}, {"a", 5.0}, {"t", 7.0}, {"F", 10.0}}) {
    EXPECT_EQ(force_of(*made(formula), {sample}), force_n) << formula;
  }
}

TEST(Formula, KnowsWhatTheSpecimenWentThrough) {
  // Out by 3 m and back through zero.
  std::vector<StageSample> samples;
  for (const double x : {0.0, 3.0, 0.0, -1.0, 0.0}) {
    samples.push_back({.motion = {.displacement_m = x}});
  }
  for (const auto& [formula, value] : {std::pair{"path", 8.0}, {"peak", 3.0}, {"cycles", 0.5}, {"energy", 0.0}}) {
    const auto effect = made(formula);
    EXPECT_EQ(force_of(*effect, samples), value) << formula;
    effect->reset();
    EXPECT_EQ(force_of(*effect, {samples.front()}), 0.0) << formula;
  }
  // A friction of 5 N over 3 m and back; a sample has the force of the one before. By trapezoids, up to the last zero
  // of the force: 7.5 J on the way out, of which the way back takes 3.75 J.
  samples = {{.motion = {.displacement_m = 0.0}},
             {.motion = {.displacement_m = 3.0}, .force_n = 0.0},
             {.motion = {.displacement_m = 0.0}, .force_n = 5.0},
             {.motion = {.displacement_m = 0.0}, .force_n = -5.0}};
  EXPECT_EQ(force_of(*made("energy"), samples), 3.75);
}

TEST(Formula, FollowsItsInputOrTheNominalValue) {
  const auto effect = made("c_n * temperature_c", {2.0, 20.0}, {{.name = "c_n"}}, "temperature_c");
  const std::array inputs{1.0, 50.0};
  const StageSample sample{.motion = {}, .inputs = inputs.data()};
  EXPECT_EQ(force_of(*effect, {sample}), 40.0);
  effect->follow_input(1);
  EXPECT_EQ(force_of(*effect, {sample}), 100.0);
}

TEST(Formula, IsOneTypeForOneFormula) {
  const Formula formula{.name = "made", .added_force_n = "c*x", .input = {}, .numbers = {{.name = "c"}}};
  Formula other = formula;
  other.numbers[0].high = 5.0;
  EXPECT_EQ(&formula_effect(formula), &formula_effect(Formula{formula}));
  EXPECT_NE(&formula_effect(formula), &formula_effect(other));
}

struct LinearCase {
  const char* formula;
  std::vector<bool> is_linear;        // one per number, p and q
  std::vector<bool> removes_at_zero;  // likewise
};

/// Of the closed form of each.
TEST(Formula, FindsTheNumbersInWhichItIsLinear) {
  for (const LinearCase& one : {
           LinearCase{"p*v + q*x", {true, true}, {true, true}},
           {"p*sign(v)*abs(v)^q", {true, false}, {true, false}},
           {"p*(exp(q*x) - 1)", {true, false}, {true, true}},
           {"p*x + q", {true, true}, {true, true}},
           {"x^2*(p + 1) + q", {false, false}, {false, false}},  // nothing removes it
           {"min(p, 0.5)*x*exp(q)", {false, false}, {true, false}},
           {"tanh(v/p)*q", {false, true}, {false, true}},
       }) {
    SCOPED_TRACE(one.formula);
    const EffectType& type =
        formula_effect({.name = "made",
                        .added_force_n = one.formula,
                        .input = {},
                        .numbers = {{.name = "p", .low = -1.0, .high = 2.0}, {.name = "q", .low = -1.0, .high = 2.0}}});
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(type.parameters[i].is_linear, one.is_linear[i]) << type.parameters[i].name;
      EXPECT_EQ(type.parameters[i].neutral == 0.0, one.removes_at_zero[i]) << type.parameters[i].name;
    }
  }
}

TEST(Formula, OfAProductOneNumberIsLinear) {
  const EffectType& type =
      formula_effect({.name = "made",
                      .added_force_n = "p*q*x",
                      .input = {},
                      .numbers = {{.name = "p", .low = 0.0, .high = 2.0}, {.name = "q", .low = 0.0, .high = 2.0}}});
  EXPECT_NE(type.parameters[0].is_linear, type.parameters[1].is_linear);
}

TEST(Formula, NeedsTimeWhereItUsesWhatOneSampleDoesNotShow) {
  for (const auto& [formula, needs_time] :
       {std::pair{"x*peak", false}, {"path*energy*cycles*F", false}, {"v", true}, {"a", true}, {"t*x", true}}) {
    EXPECT_EQ(formula_effect({.name = "made", .added_force_n = formula, .input = {}, .numbers = {}}).traits.needs_time,
              needs_time)
        << formula;
  }
}

class FormulaText : public testing::Test {
 protected:
  SiteModelFile read(const std::string& effect) {
    std::ofstream{directory_ / "site.yaml"} << "specimen: {type: elastic, stiffness_n_per_m: 100.0}\neffects:\n  - "
                                            << "{interface: specimen, effect: formula, " << effect << "}\n";
    return read_site_model(directory_ / "site.yaml");
  }
  std::string error_of(const std::string& effect) {
    return error_from([&] { static_cast<void>(read(effect)); });
  }
  std::string error_of_file(const std::string& text) {
    std::ofstream{directory_ / "formulas.yaml"} << text;
    return error_from([&] { static_cast<void>(read_formulas(directory_ / "formulas.yaml")); });
  }
  TemporaryDirectory directory_;

 private:
  template <class Read>
  static std::string error_from(Read&& read) {
    try {
      read();
    } catch (const ConfigError& error) {
      return error.what();
    }
    return {};
  }
};

TEST_F(FormulaText, IsReadAndWrittenAgain) {
  const SiteModelFile site = read(
      "name: heated_damper, added_force_n: \"c_n_s_per_m * v\n * exp(-loss_per_k * (temperature_c - 20))\", "
      "input: temperature_c, parameters: {c_n_s_per_m: 300, loss_per_k: 0.02}, nominal_input: 25");
  ASSERT_EQ(site.dofs[0].effects.size(), 1U);
  const EffectSetting& effect = site.dofs[0].effects.front();
  EXPECT_EQ(effect.type->name, "heated_damper");
  EXPECT_EQ(effect.type->input, "temperature_c");
  EXPECT_EQ(effect.type->parameters[0].unit, "N s/m");
  EXPECT_EQ(effect.values, (std::vector<double>{300.0, 0.02, 25.0}));
  const std::vector<ListedEffect> added{
      {{&formula_effect({.name = "second", .added_force_n = "k*x^3", .input = {}, .numbers = {{.name = "k"}}}), {7.5}},
       {}}};
  const std::string text = site.with_effects(added).text;
  std::ofstream{directory_ / "again.yaml"} << text;
  const SiteModelFile again = read_site_model(directory_ / "again.yaml");
  ASSERT_EQ(again.dofs[0].effects.size(), 2U) << text;
  EXPECT_EQ(again.dofs[0].effects[0].type, effect.type);
  EXPECT_EQ(again.dofs[0].effects[0].values, effect.values);
  EXPECT_EQ(again.dofs[0].effects[1].type, added[0].setting.type);
  EXPECT_EQ(again.dofs[0].effects[1].values, added[0].setting.values);
}

TEST_F(FormulaText, WhatIsWrongIsSaid) {
  const std::string named = "name: mine, added_force_n: ";
  EXPECT_EQ(error_of(named + "\"k*x\", parameters: {k: 1}"), "");
  EXPECT_THAT(error_of(named + "\"k*y\", parameters: {k: 1}"), HasSubstr("site.yaml:3:"));
  EXPECT_THAT(error_of(named + "\"k*y\", parameters: {k: 1}"), HasSubstr("'y' is none of its parameters"));
  EXPECT_THAT(error_of(named + "\"k*x +\", parameters: {k: 1}"), HasSubstr("ends too early"));
  EXPECT_THAT(error_of(named + "\"k*(x\", parameters: {k: 1}"), HasSubstr("arenthes"));
  EXPECT_THAT(error_of(named + "\"x = 2\""), HasSubstr("expected '=='"));
  EXPECT_THAT(error_of(named + "\"x, v\""), HasSubstr("more than one value"));
  EXPECT_THAT(error_of(named + "\"x\", parameters: {k: 1}"), HasSubstr("does not use 'k'"));
  EXPECT_THAT(error_of(named + "\"x*sin\", parameters: {sin: 1}"), HasSubstr("'sin' of a parameter is taken"));
  EXPECT_THAT(error_of(named + "\"x*v\", parameters: {v: 1}"), HasSubstr("'v' of a parameter is taken"));
  EXPECT_THAT(error_of(named + "\"x*K\", parameters: {K: 1}"), HasSubstr("'K' is no name of a parameter"));
  EXPECT_THAT(error_of(named + "\"x*k\", parameters: {k: big}"), HasSubstr("big"));
  EXPECT_THAT(error_of(named + "\"x*u\", input: u"), HasSubstr("nominal_input"));
  EXPECT_THAT(error_of("name: inertia, added_force_n: x"), HasSubstr("none that an effect of the specimen has"));
  EXPECT_THAT(error_of(named + "\"a1+a2+a3+a4+a5+a6+a7+a8+a9\", parameters: {a1: 1, a2: 1, a3: 1, a4: 1, a5: 1, a6: "
                               "1, a7: 1, a8: 1, a9: 1}"),
              HasSubstr("9 parameters; expected 8 at most"));
  EXPECT_THAT(error_of(named + "x, stiffness_n_per_m: 1"), HasSubstr("stiffness_n_per_m"));
}

TEST_F(FormulaText, FileGivesRangesToSearch) {
  const std::string head = "formulas:\n  - name: mine\n    added_force_n: k*x\n    parameters: ";
  EXPECT_EQ(error_of_file(head + "{k: {from: -1, to: 2}}\n"), "");
  const std::vector<const EffectType*> formulas = read_formulas(directory_ / "formulas.yaml");
  ASSERT_EQ(formulas.size(), 1U);
  EXPECT_EQ(formulas[0]->parameters[0].low, -1.0);
  EXPECT_EQ(formulas[0]->parameters[0].high, 2.0);
  EXPECT_THAT(error_of_file(head + "{k: 3}\n"), HasSubstr("formulas.yaml:4:"));
  EXPECT_THAT(error_of_file(head + "{k: {from: 2, to: 2}}\n"), HasSubstr("more than 'from'"));
  EXPECT_THAT(error_of_file(head + "{k: {from: 2}}\n"), HasSubstr("to"));
  EXPECT_THAT(error_of_file("formulas:\n  - {name: mine, added_force_n: x}\n"), HasSubstr("expected at least one"));
  EXPECT_THAT(error_of_file(head + "{k: {from: 0, to: 2}}\n  - {name: mine, added_force_n: x}\n"),
              HasSubstr("two formulas have the name 'mine'"));
}

}  // namespace
}  // namespace hybridtest
