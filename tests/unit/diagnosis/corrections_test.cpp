#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "diagnosis/diagnose.hpp"
#include "diagnosis/page/diagnosis_json.hpp"
#include "diagnosis/verdict/causes.hpp"
#include "diagnosis/verdict/library_fits.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "plant/transfer_systems/delay.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

/// Numbers of the user's model that are slightly off: corrected, and no causes.
namespace hybridtest {
namespace {

using report::Verdict;
using testing::HasSubstr;
using testing::Not;
using testing::UnorderedElementsAre;

double slope(const std::function<double(double)>& of, double time_s) {
  return (of(time_s + 1e-5) - of(time_s - 1e-5)) / 2e-5;
}

/// A site that differs from made_model() in the gain of its actuator and in the stiffness of its spring.
Recording site_with(double gain, double stiffness_ratio) {
  const auto moved_m = [gain](double t) { return gain * made_motion_m(t); };
  return made_recording(moved_m, [=](double t) { return stiffness_ratio * kMadeStiffness_n_per_m * moved_m(t); });
}

Diagnosis diagnosis_with(const SiteModel& model, const Recording& recording, const VerdictPolicy& policy = {}) {
  DiagnoseSettings settings;
  settings.threads = 2;
  settings.policy = policy;
  return diagnose(model, {&recording, 1}, settings);
}

Diagnosis diagnosis_of(const Recording& recording, const VerdictPolicy& policy = {}) {
  return diagnosis_with(made_model(), recording, policy);
}

std::vector<std::string> names_in(const std::vector<report::RankedCause>& entries, bool causes_alone) {
  std::vector<std::string> names;
  for (const report::RankedCause& entry : entries) {
    if (!causes_alone || entry.is_cause) names.push_back(entry.interface + " " + entry.effect);
  }
  return names;
}

TEST(Corrections, NumbersSlightlyOffAreNone) {
  const Diagnosis diagnosis = diagnosis_of(site_with(1.02, 1.015));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::none);
  EXPECT_THAT(names_in(diagnosis.report.ranking, true), testing::IsEmpty());
  EXPECT_THAT(names_in(diagnosis.report.corrections, false),
              UnorderedElementsAre("transfer_system gain", "specimen stiffness_error"));
  for (const report::RankedCause& number : diagnosis.report.corrections) {
    // Within the noise: 1 um of 20 mm, 20 N of 40 kN, over thousands of samples.
    if (number.effect == "gain") {
      EXPECT_NEAR(number.parameters[0].value, 0.02, 1e-4);
    }
    if (number.effect == "stiffness_error") {
      EXPECT_NEAR(number.parameters[1].value, 0.015 * kMadeStiffness_n_per_m, 1e-3 * kMadeStiffness_n_per_m);
    }
  }
  for (const char* interface : {"transfer_system", "specimen"}) {
    const auto gap = std::ranges::find(diagnosis.report.where, interface, &report::InterfaceGap::interface);
    ASSERT_NE(gap, diagnosis.report.where.end());
    EXPECT_TRUE(gap->is_corrected && !gap->is_at_fault) << interface;
  }
  // The augmented model has the right numbers, and the gap is gone with them.
  EXPECT_EQ(diagnosis.causes.size(), 2U);
  EXPECT_LT(diagnosis.report.interface_shrink->nrmse_after, 1.2 * diagnosis.report.interface_shrink->floor_nrmse);
  EXPECT_THAT(diagnosis_json(diagnosis), HasSubstr("\"corrections\": [\n  {"));
}

TEST(Corrections, NumbersFurtherOffAreCauses) {
  const Diagnosis diagnosis = diagnosis_of(site_with(1.02, 1.08));
  // Of an elastic specimen the force cannot tell its stiffness from the gain of the load cell.
  EXPECT_EQ(diagnosis.report.verdict, Verdict::set);
  EXPECT_THAT(names_in(diagnosis.report.ranking, true),
              UnorderedElementsAre("specimen stiffness_error", "force_sensor gain"));
  EXPECT_THAT(names_in(diagnosis.report.corrections, false), UnorderedElementsAre("transfer_system gain"));
}

/// A spring and a damper, of which the model has this share, and an actuator with a wrong gain.
Diagnosis diagnosis_of_damper(double known) {
  constexpr double kDamping_n_s_per_m = 0.1 * kMadeStiffness_n_per_m;
  SiteModel model = made_model();
  const EffectType* const damping = find_effect(EffectInterface::specimen, "viscous_damping");
  add_effect(model, {.type = damping, .values = {known * kDamping_n_s_per_m}});
  const auto moved_m = [](double t) { return 1.02 * made_motion_m(t); };
  return diagnosis_with(model, made_recording(moved_m, [&](double t) {
                          return kMadeStiffness_n_per_m * moved_m(t) +
                                 kDamping_n_s_per_m * 1.02 * made_velocity_m_per_s(t);
                        }));
}

TEST(Corrections, DampingOfTheModelSlightlyOffIsNone) {
  const Diagnosis diagnosis = diagnosis_of_damper(0.97);
  EXPECT_EQ(diagnosis.report.verdict, Verdict::none);
  EXPECT_THAT(names_in(diagnosis.report.corrections, false),
              UnorderedElementsAre("transfer_system gain", "specimen viscous_damping"));
}

TEST(Corrections, DampingOfTheModelFarOffIsACause) {  // control
  const Diagnosis diagnosis = diagnosis_of_damper(0.8);
  EXPECT_THAT(names_in(diagnosis.report.ranking, true), testing::Contains("specimen viscous_damping"));
}

TEST(Corrections, ChannelBringsNoNumberOfTheNextOne) {
  // The specimen pinches, which no stiffness mends. The sensor's gain, which the force shows too, must not bring one
  // along while the displacement is judged.
  const auto moved_m = [](double t) { return 1.03 * made_motion_m(t); };
  const Recording recording = made_recording(moved_m, [&](double t) {
    const double share = moved_m(t) / 0.006;
    return kMadeStiffness_n_per_m * moved_m(t) * (1.0 - 0.9 * std::exp(-share * share));
  });
  const IdentificationProblem whole = make_problem(made_model(), segments_of(recording, 0, 0));
  const auto numbers_at = [&](Channel channel, EffectInterface interface) {
    const IdentificationProblem problem = judged_at(whole, channel);
    const FitOutcome fit = fit_effects(problem, {find_effect(interface, "gain")}, true);
    std::vector<std::string> names;
    for (const EffectSetting& number : wrong_numbers(problem, fit)) {
      names.push_back(std::string{name_of(number.type->interface)} + " " + std::string{number.type->name});
    }
    return names;
  };
  EXPECT_THAT(numbers_at(Channel::measured_displacement, EffectInterface::displacement_sensor),
              Not(testing::Contains("specimen stiffness_error")));
  EXPECT_THAT(numbers_at(Channel::measured_force, EffectInterface::force_sensor),
              testing::Contains("specimen stiffness_error"));
}

/// What an actuator of 2 % too much gain and half a millisecond of delay leaves is little beside a zero of the
/// transducer of a fifth of the motion, but above the noise.
TEST(Corrections, NumbersAreCorrectedBesideALargeZero) {
  const auto moved_m = [](double t) { return 1.0015 * made_motion_m(t - 2e-5); };
  Recording recording = made_recording([&](double t) { return moved_m(t) + 0.004; },
                                       [&](double t) { return kMadeStiffness_n_per_m * moved_m(t); });
  Random random{7};
  for (double& read_m : recording.dofs[0].of(Channel::measured_displacement)) read_m += 2.5e-5 * random.normal();
  const Diagnosis diagnosis = diagnosis_of(recording);
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
  EXPECT_THAT(names_in(diagnosis.report.ranking, true), UnorderedElementsAre("displacement_sensor bias"));
  EXPECT_THAT(names_in(diagnosis.report.corrections, false), testing::Contains("transfer_system gain"));
}

/// A specimen that yields, of which every number of the model is off by this share, the stiffness up and the others
/// down. The actuator goes 1 % too far, and the load cell reads so many times as much.
Diagnosis diagnosis_of_yielding(double off, double force_gain) {
  constexpr double kStrength_n = 2.0e4;
  const auto moved_m = [](double t) { return 1.01 * made_motion_m(t); };
  Bilinear specimen{
      {.stiffness_n_per_m = kMadeStiffness_n_per_m, .yield_force_n = kStrength_n, .hardening_ratio = 0.1}};
  SiteModel model = made_model();
  model.make_law = [off] {
    return std::make_unique<Bilinear>(Bilinear::Parameters{.stiffness_n_per_m = (1.0 + off) * kMadeStiffness_n_per_m,
                                                           .yield_force_n = (1.0 - off) * kStrength_n,
                                                           .hardening_ratio = 0.1 * (1.0 - off)});
  };
  return diagnosis_with(model, made_recording(moved_m, [&](double t) {
                          const double force_n = specimen.trial(moved_m(t), 0.0);
                          specimen.commit();
                          return force_gain * force_n;
                        }));
}

TEST(Corrections, LawOfTheModelsOwnFormIsCorrected) {
  const Diagnosis diagnosis = diagnosis_of_yielding(0.02, 1.0);
  EXPECT_EQ(diagnosis.report.verdict, Verdict::none);
  EXPECT_THAT(names_in(diagnosis.report.ranking, true), testing::IsEmpty());
}

TEST(Corrections, GainOfTheLoadCellIsNotToldFromNumbersOfALawThatYields) {
  const Diagnosis diagnosis = diagnosis_of_yielding(0.02, 1.16);
  EXPECT_EQ(diagnosis.report.verdict, Verdict::set);
  EXPECT_THAT(names_in(diagnosis.report.ranking, true), testing::Contains("force_sensor gain"));
}

TEST(Corrections, PolicyDecidesWhatIsSlightlyOff) {
  const Recording recording = site_with(1.02, 1.015);
  const Diagnosis diagnosis = diagnosis_of(recording, {.numbers_within = 0.0});
  EXPECT_EQ(diagnosis.report.verdict, Verdict::set);
  EXPECT_THAT(names_in(diagnosis.report.ranking, true),
              testing::IsSupersetOf({"transfer_system gain", "specimen stiffness_error"}));
  EXPECT_THAT(diagnosis_json(diagnosis), HasSubstr("\"corrections\": []"));
}

TEST(Corrections, SingleWrongNumberIsTheCause) {
  const Diagnosis diagnosis = diagnosis_of(site_with(1.02, 1.0));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
  EXPECT_THAT(names_in(diagnosis.report.ranking, true), UnorderedElementsAre("transfer_system gain"));
  EXPECT_THAT(diagnosis.report.corrections, testing::IsEmpty());
}

TEST(Corrections, SingleWrongNumberBesideAGapOfNoKnownCauseIsNone) {
  const auto settled_beside = [](Verdict verdict, bool may_be_right = false) {
    Judgement number;
    number.may_be_right = may_be_right;
    number.verdict = Verdict::named;
    number.corrections = {0};
    number.only_corrects = true;
    Judgement other;
    other.verdict = verdict;
    std::array judgements{&other, &number};
    settle_corrections(judgements);
    return number;
  };
  EXPECT_EQ(settled_beside(Verdict::unknown).verdict, Verdict::none);
  EXPECT_THAT(settled_beside(Verdict::unknown).corrections, testing::SizeIs(1));
  EXPECT_EQ(settled_beside(Verdict::none).verdict, Verdict::named);  // control: nothing else is wrong
  EXPECT_THAT(settled_beside(Verdict::none).corrections, testing::IsEmpty());
  EXPECT_EQ(settled_beside(Verdict::none, true).verdict, Verdict::none) << "hardly a gap, and the number may be right";
}

TEST(Corrections, DampingThatTheModelLacksIsACause) {
  // 1.4 % of the spring's force.
  const Recording recording = made_recording(made_motion_m, [](double t) {
    return kMadeStiffness_n_per_m * made_motion_m(t) + 3.0e3 * slope(made_motion_m, t);
  });
  const Diagnosis diagnosis = diagnosis_of(recording);
  EXPECT_THAT(names_in(diagnosis.report.ranking, true), testing::Contains("specimen viscous_damping"));
}

TEST(Corrections, WrongGainOfTheActuatorEarnsASensorNothing) {
  // A lag of the transducer looks like this damping in the force. It must not lead for the wrong gain and delay of the
  // actuator, numbers that a fit of the transducer's lag may correct besides.
  const auto moved_m = [](double t) { return 0.94 * made_motion_m(t - 0.0005); };
  const Recording recording = made_recording(
      moved_m, [&](double t) { return kMadeStiffness_n_per_m * moved_m(t) + 1.0e4 * slope(moved_m, t); });
  const Diagnosis diagnosis = diagnosis_of(recording);
  // A frame that gives way under this spring and damper is a gain and a delay.
  EXPECT_EQ(diagnosis.report.verdict, Verdict::set);
  EXPECT_THAT(names_in(diagnosis.report.ranking, true),
              testing::IsSupersetOf({"transfer_system gain", "transfer_system compliance"}));
  EXPECT_THAT(names_in(diagnosis.report.ranking, true), Not(testing::Contains(HasSubstr("displacement_sensor"))));
  EXPECT_THAT(names_in(diagnosis.report.ranking, true), testing::Contains("specimen viscous_damping"));
}

/// An actuator that is this late, with a model of 4 ms, under a spring that is a little stiffer than its model.
Diagnosis diagnosis_of_actuator_late_by(double delay_s) {
  SiteModel model = made_model();
  model.make_transfer_system = [](double sample_period_s, double change_s) {
    return std::make_unique<Delay>(from_seconds(0.004 + change_s), from_seconds(sample_period_s));
  };
  model.removable_delay_s = 0.004;
  const auto moved_m = [delay_s](double t) { return made_motion_m(t - delay_s); };
  return diagnosis_with(model,
                        made_recording(moved_m, [&](double t) { return 1.015 * kMadeStiffness_n_per_m * moved_m(t); }));
}

TEST(Corrections, DelayFarFromThatOfTheModelIsACause) {
  // It changes less than a hundredth of the motion, which is slow.
  const Diagnosis diagnosis = diagnosis_of_actuator_late_by(0.0052);
  EXPECT_THAT(names_in(diagnosis.report.ranking, true), testing::Contains("transfer_system delay"));
  EXPECT_THAT(names_in(diagnosis.report.corrections, false), UnorderedElementsAre("specimen stiffness_error"));
}

TEST(Corrections, DelayNearThatOfTheModelIsNone) {  // control
  const Diagnosis diagnosis = diagnosis_of_actuator_late_by(0.0042);
  EXPECT_EQ(diagnosis.report.verdict, Verdict::none);
  EXPECT_THAT(names_in(diagnosis.report.corrections, false), testing::Contains("transfer_system delay"));
}

}  // namespace
}  // namespace hybridtest
