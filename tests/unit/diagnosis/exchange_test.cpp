#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "diagnosis/diagnose.hpp"
#include "diagnosis/identification/effect_fit.hpp"
#include "diagnosis/identification/smoothing_choice.hpp"
#include "diagnosis/verdict/causes.hpp"
#include "diagnosis/verdict/selection.hpp"
#include "mechanics/laws/bouc_wen.hpp"
#include "tests/unit/diagnosis/answers.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

// What a candidate needs beside it is not known when it is fitted by itself.
namespace hybridtest {
namespace {

using report::Verdict;

constexpr double kDamping_n_s_per_m = 4.0e3;

std::unique_ptr<Law> smooth_law(double strength) {
  return std::make_unique<BoucWen>(BoucWen::Parameters{
      .stiffness_n_per_m = strength * kMadeStiffness_n_per_m, .alpha = 0.1, .gamma_per_m = 30.0, .beta_per_m = 70.0});
}

Diagnosis diagnosis_with(const SiteModel& model, const std::function<double(double)>& force_n) {
  return diagnosis_of(model, made_recording(made_motion_m, force_n));
}

TEST(Exchange, LawGivesWayToItsNumbersWhenDampingIsKnown) {
  // A law in place of the model's own has more parameters, which also imitate the damping, and leads by itself.
  SiteModel model = made_model();
  model.make_law = [] { return smooth_law(1.0); };
  const std::unique_ptr<Law> real = smooth_law(0.76);
  const Diagnosis diagnosis = diagnosis_with(model, [&](double t) {
    const double force_n = real->trial(made_motion_m(t), 0.0);
    real->commit();
    return force_n + kDamping_n_s_per_m * made_velocity_m_per_s(t);
  });
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
  bool has_damping = false;
  for (const report::RankedCause& cause : diagnosis.report.ranking) {
    if (!cause.is_cause) continue;
    EXPECT_NE(cause.effect, "hysteresis_law");
    if (cause.effect != "viscous_damping") continue;
    has_damping = true;
    // 20 N of noise on a velocity of 0.1 m/s, 6000 times: 3 N s/m; and the smoothing of the velocity.
    EXPECT_NEAR(cause.parameters[0].value, kDamping_n_s_per_m, 0.02 * kDamping_n_s_per_m);
  }
  EXPECT_TRUE(has_damping);
}

TEST(Exchange, LawOfTheSameFormGivesWayToAStrengthAndDampingThatIsSlight) {
  // By itself the damping would be taken for none, beside a force that is 4 % too small.
  SiteModel model = made_model();
  model.make_law = [] { return smooth_law(1.0); };
  const std::unique_ptr<Law> real = smooth_law(0.96);
  const Diagnosis diagnosis = diagnosis_with(model, [&](double t) {
    const double force_n = real->trial(made_motion_m(t), 0.0);
    real->commit();
    return force_n + 0.1 * kDamping_n_s_per_m * made_velocity_m_per_s(t);
  });
  EXPECT_THAT(causes_of(diagnosis), testing::ElementsAre("viscous_damping"));
  EXPECT_FALSE(diagnosis.report.corrections.empty());
}

/// Stiffness, strength and hardening, each off by as much as the load takes from the stiffness, are exactly such a
/// load.
TEST(Exchange, LoadIsNotThreeNumbersOfTheLaw) {
  SiteModel model = made_model();
  model.make_law = [] { return smooth_law(1.0); };
  constexpr double kSofter = 0.98;
  constexpr double kLoadOverHeight_n_per_m = 0.12 * kMadeStiffness_n_per_m;
  const std::unique_ptr<Law> real = smooth_law(kSofter);
  const Diagnosis diagnosis = diagnosis_with(model, [&](double t) {
    const double force_n = real->trial(made_motion_m(t), 0.0);
    real->commit();
    return force_n - kLoadOverHeight_n_per_m * made_motion_m(t);
  });
  ASSERT_THAT(causes_of(diagnosis), testing::ElementsAre("geometric_stiffness"));
  const report::RankedCause& load = diagnosis.report.ranking.front();
  // Of a law 2 % too soft, the stiffness and the load may each take a part: by as much.
  EXPECT_NEAR(find_parameter(load, "axial_force_n")->value / find_parameter(load, "height_m")->value,
              kLoadOverHeight_n_per_m, (1.0 - kSofter) * kMadeStiffness_n_per_m);
}

report::RankedCause cause_with(const char* effect, double share, bool is_indistinguishable) {
  report::RankedCause cause;
  cause.effect = effect;
  cause.share = share;
  cause.is_cause = true;
  cause.is_indistinguishable = is_indistinguishable;
  return cause;
}

TEST(SettleSet, CertainCauseWithTheLargestShareIsNamed) {
  report::DiagnosisReport report;
  report.verdict = Verdict::set;
  report.ranking = {cause_with("friction", 0.9, false), cause_with("gain", 0.1, true),
                    cause_with("compliance", 0.0, true)};
  settle_set(report, false);
  EXPECT_EQ(report.verdict, Verdict::named);
  EXPECT_TRUE(report.ranking[1].is_cause) << "it was chosen";
  EXPECT_FALSE(report.ranking[2].is_cause);
  EXPECT_TRUE(report.ranking[2].is_indistinguishable) << "still told as an alternative";
}

TEST(SettleSet, NamesNothingThatLeavesAPartOrMayBeAbsent) {
  report::DiagnosisReport report;
  const auto settled = [&](bool leaves_a_part, bool may_be_absent) {
    report.verdict = Verdict::set;
    report.ranking = {cause_with("friction", 0.9, false), cause_with("gain", 0.1, true),
                      cause_with("compliance", 0.0, true)};
    report.ranking[1].may_be_absent = may_be_absent;
    report.ranking[2].may_be_absent = true;  // no cause any more
    settle_set(report, leaves_a_part);
    return report.verdict;
  };
  EXPECT_EQ(settled(false, false), Verdict::named);
  EXPECT_EQ(settled(true, false), Verdict::partial);
  EXPECT_EQ(settled(false, true), Verdict::partial);
}

TEST(SettleSet, CertainCausesComeBeforeOneChosenOfSeveral) {
  report::DiagnosisReport report;
  report.verdict = Verdict::set;
  report.ranking = {cause_with("friction", 0.7, false), cause_with("gain", 0.2, true), cause_with("gap", 0.1, false),
                    cause_with("compliance", 0.0, true)};
  settle_set(report, false);
  std::vector<std::string> effects;
  for (const report::RankedCause& cause : report.ranking) effects.push_back(cause.effect);
  EXPECT_THAT(effects, testing::ElementsAre("friction", "gap", "gain", "compliance"));
}

TEST(SettleSet, DoubtAboutTheLargestShareStaysASet) {  // control
  report::DiagnosisReport report;
  report.verdict = Verdict::set;
  report.ranking = {cause_with("gain", 0.9, true), cause_with("friction", 0.1, false),
                    cause_with("compliance", 0.0, true)};
  settle_set(report, false);
  EXPECT_EQ(report.verdict, Verdict::set);
  EXPECT_TRUE(report.ranking[2].is_cause);
}

/// A stiffness 5 % off, and the friction that was searched with it; the real one helps the motion, so that none is
/// left.
TEST(DropGone, EffectOfSizeZeroIsDropped) {
  for (const double friction_n : {-300.0, 300.0}) {
    const Recording recording = made_recording(made_motion_m, [&](double t) {
      return 1.05 * kMadeStiffness_n_per_m * made_motion_m(t) +
             (made_velocity_m_per_s(t) > 0.0 ? friction_n : -friction_n);
    });
    const IdentificationProblem problem = make_problem(made_model(), modelled_segments(made_model(), recording, 0, 0));
    FitOutcome fit = refit_effects(
        problem,
        {{find_effect(EffectInterface::specimen, "stiffness_error"), {0.0, 0.05 * kMadeStiffness_n_per_m}},
         {find_effect(EffectInterface::specimen, "coulomb_friction"), {100.0, 0.0, 1e-5, 0.0}}},
        false);
    ASSERT_EQ(fit.effects.size(), 2U);
    drop_gone(problem, fit);
    // Control: a friction that is there stays.
    EXPECT_EQ(fit.effects.size(), friction_n > 0.0 ? 2U : 1U);
    EXPECT_EQ(fit.effects.front().type->name, "stiffness_error");
  }
}

/// A stiffness 5 % off, beside damping or none.
TEST(DropGone, EffectThatMayBeAbsentIsDroppedWhereTheOthersPredictAsWell) {
  for (const double damping_n_s_per_m : {0.0, 1.0e4}) {
    const Recording recording = made_recording(
        made_motion_m,
        [&](double t) {
          return 1.05 * kMadeStiffness_n_per_m * made_motion_m(t) + damping_n_s_per_m * made_velocity_m_per_s(t);
        },
        20.0, 4);
    const IdentificationProblem problem = make_problem(made_model(), modelled_segments(made_model(), recording, 0, 0));
    FitOutcome fit = refit_effects(
        problem,
        {{find_effect(EffectInterface::specimen, "stiffness_error"), {0.0, 0.05 * kMadeStiffness_n_per_m}},
         {find_effect(EffectInterface::specimen, "viscous_damping"), {10.0}}},
        false);
    ASSERT_NE(fit.effects.back().values.front(), 0.0) << "not gone, but within what is not known of it";
    drop_gone(problem, fit);
    EXPECT_EQ(fit.effects.size(), damping_n_s_per_m > 0.0 ? 2U : 1U);  // control: damping that is there stays
  }
}

}  // namespace
}  // namespace hybridtest
