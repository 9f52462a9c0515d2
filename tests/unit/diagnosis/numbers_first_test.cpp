#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/diagnose.hpp"
#include "diagnosis/identification/effect_fit.hpp"
#include "diagnosis/verdict/growth.hpp"
#include "diagnosis/verdict/leaders.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "tests/unit/diagnosis/answers.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

/// Numbers of the user's model are expected to be off, several at once, and are looked for together before anything
/// else.
namespace hybridtest {
namespace {

using report::Verdict;
using testing::UnorderedElementsAre;

constexpr double kYieldForce_n = 2.0e4;
constexpr double kHardeningRatio = 0.07;
constexpr double kLargest_m = 0.028;

std::unique_ptr<Law> yielding(double stiffness_ratio, double strength_ratio, double hardening_ratio = kHardeningRatio) {
  return std::make_unique<Bilinear>(Bilinear::Parameters{.stiffness_n_per_m = stiffness_ratio * kMadeStiffness_n_per_m,
                                                         .yield_force_n = strength_ratio * kYieldForce_n,
                                                         .hardening_ratio = hardening_ratio});
}

/// Softens by this share of its elastic force at the largest displacement.
double cubic_n_per_m3(double share) { return -share * kMadeStiffness_n_per_m / (kLargest_m * kLargest_m); }

struct Damped {
  double damping_n_s_per_m = 0.0;
  double softening = 0.0;
};

std::ostream& operator<<(std::ostream& out, const Damped& beyond) {
  return out << beyond.damping_n_s_per_m << " N s/m, softens by " << beyond.softening;
}

/// A specimen that yields, whose stiffness and strength are 3 % more than in the model, damped and with a cubic force
/// that the model lacks.
Diagnosis diagnosis_with(const Damped& beyond) {
  SiteModel model = made_model();
  model.make_law = [] { return yielding(1.0, 1.0); };
  const std::unique_ptr<Law> real = yielding(1.03, 1.03);
  const Recording recording = made_recording(made_motion_m, [&](double t) {
    const double x_m = made_motion_m(t);
    const double law_n = real->trial(x_m, 0.0);
    real->commit();
    return law_n + beyond.damping_n_s_per_m * made_velocity_m_per_s(t) +
           cubic_n_per_m3(beyond.softening) * std::pow(x_m, 3);
  });
  return diagnosis_of(model, recording);
}

double first_parameter_of(const Diagnosis& diagnosis, std::string_view effect) {
  const auto& ranking = diagnosis.report.ranking;
  const auto found = std::ranges::find(ranking, effect, &report::RankedCause::effect);
  return found == ranking.end() ? NAN : found->parameters.front().value;
}

/// Of the causes. Whatever is named is likelier than not.
double least_probability(const Diagnosis& diagnosis) {
  double least = 1.0;
  for (const report::RankedCause& entry : diagnosis.report.ranking) {
    if (entry.is_cause) least = std::min(least, entry.probability);
  }
  return least;
}

class NumbersFirst : public testing::TestWithParam<Damped> {};

TEST_P(NumbersFirst, CubicForceBesideALawThatIsOffIsNoOtherLaw) {
  // By itself none of these numbers shows that it is off, and another law takes up all of it in part.
  const Diagnosis diagnosis = diagnosis_with(GetParam());
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
  EXPECT_THAT(causes_of(diagnosis), UnorderedElementsAre("cubic_stiffness", "viscous_damping"));
  EXPECT_THAT(effects_of(diagnosis.report.corrections), UnorderedElementsAre("stiffness_error", "strength_error"));
  // Noise of 20 N over 6000 samples of a cubic force of some kilonewtons, and the smoothing of the force.
  const double cubic = cubic_n_per_m3(GetParam().softening);
  EXPECT_NEAR(first_parameter_of(diagnosis, "cubic_stiffness"), cubic, 0.02 * std::abs(cubic));
  EXPECT_NEAR(first_parameter_of(diagnosis, "viscous_damping"), GetParam().damping_n_s_per_m,
              0.02 * GetParam().damping_n_s_per_m);
  EXPECT_GT(least_probability(diagnosis), 0.5);
}

INSTANTIATE_TEST_SUITE_P(SlightAndStrong, NumbersFirst,
                         testing::Values(Damped{.damping_n_s_per_m = 1.0e3, .softening = 0.05},
                                         Damped{.damping_n_s_per_m = 4.0e3, .softening = 0.3}));

TEST(NumbersFirstAlone, LawThatIsOffIsCorrected) {  // control: nothing else is found where nothing else is
  const Diagnosis diagnosis = diagnosis_with({});
  EXPECT_EQ(diagnosis.report.verdict, Verdict::none);
  EXPECT_THAT(effects_of(diagnosis.report.corrections), UnorderedElementsAre("stiffness_error", "strength_error"));
}

/// Stiffness, strength and hardening all slightly off are nearly a friction that yields where the law does.
TEST(NumbersFirstAlone, WholeLawThatIsOffIsNoFriction) {
  constexpr double kStiffnessError = 0.012;
  constexpr double kStrengthError = 0.02;
  constexpr double kHardeningError = -0.0014;
  constexpr double kZero_n = 330.0;
  SiteModel model = made_model();
  model.make_law = [] { return yielding(1.0, 1.0); };
  const std::unique_ptr<Law> real =
      yielding(1.0 + kStiffnessError, 1.0 + kStrengthError, kHardeningRatio + kHardeningError);
  const Diagnosis diagnosis = diagnosis_of(model, made_recording(made_motion_m, [&](double t) {
                                             const double force_n = real->trial(made_motion_m(t), 0.0);
                                             real->commit();
                                             return force_n + kZero_n;
                                           }));
  EXPECT_THAT(causes_of(diagnosis), UnorderedElementsAre("bias"));
  EXPECT_THAT(effects_of(diagnosis.report.corrections),
              UnorderedElementsAre("stiffness_error", "strength_error", "hardening_error"));
  EXPECT_NEAR(first_parameter_of(diagnosis, "bias"), kZero_n, 0.01 * kZero_n);
}

/// The zero of a load cell is a gap of its own, under which a stiffness that is slightly off does not show.
TEST(NeededNumbers, AreFoundWithTheZeroThatHidesThem) {
  constexpr double kStiffnessError = 0.002;
  constexpr double kZero_n = -1300.0;
  const auto effects_at_zero = [&](double zero_n) {
    const IdentificationProblem problem =
        make_problem(made_model(), segments_of(made_recording(made_motion_m,
                                                              [&](double t) {
                                                                return (1.0 + kStiffnessError) *
                                                                           kMadeStiffness_n_per_m * made_motion_m(t) +
                                                                       zero_n;
                                                              }),
                                               0, 0));
    Selection selection;
    selection.baseline = fit_nothing(problem, false);
    selection.by_numbers = refit_effects(problem, numbers_of(problem), false);
    selection.library = {
        {.type = find_effect(EffectInterface::specimen, "cubic_stiffness"), .fit = selection.baseline}};
    const std::optional<FitOutcome> needed = needed_numbers(problem, selection);
    std::vector<std::string> names;
    if (needed) {
      for (const EffectSetting& effect : needed->effects) names.emplace_back(effect.type->name);
    }
    return names;
  };
  EXPECT_THAT(effects_at_zero(kZero_n), UnorderedElementsAre("stiffness_error", "bias"));
  EXPECT_THAT(effects_at_zero(0.0), UnorderedElementsAre("stiffness_error"));
}

TEST(FurtherEffect, IsFoundThoughItMovesANumberThatWasFoundBefore) {
  constexpr double kHalfLife_s = 150.0;
  constexpr double kDamping_n_s_per_m = 4.0e3;
  // 4 % too soft from the beginning, and 7 % softer at the end: the mean of both is a wrong stiffness, beside which
  // nothing fades.
  const Diagnosis diagnosis =
      diagnosis_of(made_model(), made_recording(made_motion_m, [](double t) {
                     return 0.96 * kMadeStiffness_n_per_m / (1.0 + t / kHalfLife_s) * made_motion_m(t) +
                            kDamping_n_s_per_m * made_velocity_m_per_s(t);
                   }));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
  EXPECT_THAT(causes_of(diagnosis), UnorderedElementsAre("stiffness_degradation_with_time", "viscous_damping"));
  EXPECT_THAT(effects_of(diagnosis.report.corrections), UnorderedElementsAre("stiffness_error"));
  EXPECT_GT(least_probability(diagnosis), 0.5);
  // Noise of 20 N, 6000 times, on a force of 30 kN that fades by 7 %: 0.01 %; and the smoothing of the motion.
  EXPECT_NEAR(first_parameter_of(diagnosis, "stiffness_degradation_with_time"), kHalfLife_s, 0.01 * kHalfLife_s);
  EXPECT_NEAR(first_parameter_of(diagnosis, "viscous_damping"), kDamping_n_s_per_m, 0.02 * kDamping_n_s_per_m);
}

/// A specimen that stays elastic, `1 + error` times as stiff as a model that yields at forty times the largest force.
class UnreachedStrength : public testing::TestWithParam<double> {};

TEST_P(UnreachedStrength, StiffnessIsARatioOfTheLaw) {
  SiteModel model = made_model();
  model.make_law = [] { return yielding(1.0, 100.0); };
  const double stiffness_n_per_m = (1.0 + GetParam()) * kMadeStiffness_n_per_m;
  const Recording recording =
      made_recording(made_motion_m, [&](double t) { return stiffness_n_per_m * made_motion_m(t); });
  const Diagnosis diagnosis = diagnosis_of(model, recording);
  const auto found = std::ranges::find(diagnosis.report.ranking, "stiffness_error", &report::RankedCause::effect);
  ASSERT_NE(found, diagnosis.report.ranking.end());
  EXPECT_TRUE(found->is_cause);
  // 20 N of noise on up to 56 kN, in 6000 samples.
  EXPECT_NEAR(find_parameter(*found, "stiffness_error_ratio")->value, GetParam(), 1e-4 * (1.0 + GetParam()));
  EXPECT_EQ(find_parameter(*found, "stiffness_n_per_m")->value, 0.0);
}

INSTANTIATE_TEST_SUITE_P(FromATenthToTenTimes, UnreachedStrength, testing::Values(-0.9, 0.2, 9.0));

/// A load cell whose gain goes up and down by 6 % in three seconds, which is no effect of the library, and a model
/// whose stiffness is off by this share.
class GapOfNoLibrary : public testing::TestWithParam<double> {};

TEST_P(GapOfNoLibrary, IsNotToldInPartForAStiffnessThatIsOff) {
  SiteModel model = made_model();
  const double believed_n_per_m = (1.0 + GetParam()) * kMadeStiffness_n_per_m;
  model.make_law = [=] { return std::make_unique<Elastic>(believed_n_per_m); };
  const Diagnosis diagnosis = diagnosis_of(model, made_recording(made_motion_m, [](double t) {
                                             const double gain =
                                                 1.0 + 0.06 * std::sin(2.0 * std::numbers::pi * t / 3.0);
                                             return gain * kMadeStiffness_n_per_m * made_motion_m(t);
                                           }));
  for (const std::string& cause : causes_of(diagnosis)) EXPECT_EQ(cause, "stiffness_error");
}

INSTANTIATE_TEST_SUITE_P(SoftRightAndStiff, GapOfNoLibrary, testing::Values(-0.2, 0.0, 0.2, 0.3));

/// Of what is fitted beside a model, the first one predicts best and leaves all of the gap: it is refused. That does
/// not count against a number of the model, which is told in its place; it makes an effect that is no number doubtful.
TEST(GrownEffect, ProbabilityOfANumberIsNotThatAgainstWhatIsRefused) {
  const auto probability_of = [](std::string_view name, double parameter, const std::function<double(double)>& n) {
    const IdentificationProblem problem = make_problem(
        made_model(),
        segments_of(
            made_recording(made_motion_m, [&](double t) { return kMadeStiffness_n_per_m * made_motion_m(t) + n(t); }),
            0, 0));
    const Growth nothing{.fit = fit_nothing(problem, false), .accepted = {}};
    const EffectType* const type = find_effect(EffectInterface::specimen, name);
    Candidate refused{.type = find_effect(EffectInterface::force_sensor, "lag"), .fit = nothing.fit};
    Candidate right{.type = type, .fit = refit_effects(problem, {{type, {parameter}}}, false)};
    right.score = score_of(problem, right.fit);
    refused.score = right.score + 100.0;
    const std::optional<Growth> next = grown(problem, nothing.fit, nothing, {refused, right});
    return next && next->accepted.back().type == type ? next->accepted.back().probability : -1.0;
  };
  constexpr double kDamping_n_s_per_m = 2e4;
  EXPECT_GT(probability_of("viscous_damping", kDamping_n_s_per_m,
                           [](double t) { return kDamping_n_s_per_m * made_velocity_m_per_s(t); }),
            0.99);
  constexpr double kCubic_n_per_m3 = -3e8;
  const double doubtful = probability_of("cubic_stiffness", kCubic_n_per_m3,
                                         [](double t) { return kCubic_n_per_m3 * std::pow(made_motion_m(t), 3); });
  EXPECT_GE(doubtful, 0.0) << "it is accepted";
  EXPECT_LT(doubtful, 0.01);
}

}  // namespace
}  // namespace hybridtest
