#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "diagnosis/diagnose.hpp"
#include "diagnosis/identification/law_candidates.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "mechanics/laws/bouc_wen_baber_noori.hpp"
#include "mechanics/laws/elastic.hpp"
#include "mechanics/laws/friction.hpp"
#include "mechanics/laws/peak_oriented.hpp"
#include "mechanics/laws/self_centring.hpp"
#include "mechanics/laws/takeda.hpp"
#include "tests/unit/diagnosis/answers.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

/// A specimen whose law has another form than that of the model.
namespace hybridtest {
namespace {

using report::Verdict;

constexpr double kYield_n = 16e3;  // at 8 mm, of 28 mm
constexpr double kHardening = 0.05;
constexpr double kLargest_m = 0.028;

std::unique_ptr<Law> real_bilinear() {
  return std::make_unique<Bilinear>(Bilinear::Parameters{kMadeStiffness_n_per_m, kYield_n, kHardening});
}

/// The force of a law along the made motion, with noise.
Recording recording_of(Law& law) {
  return made_recording(made_motion_m, [&](double time_s) {
    const double force_n = law.trial(made_motion_m(time_s), 0.0);
    law.commit();
    return force_n;
  });
}

/// Likewise with a friction beside it.
Recording recording_of(Law& law, Friction friction) {
  return made_recording(made_motion_m, [&](double time_s) {
    const double force_n = law.trial(made_motion_m(time_s), 0.0) + friction.trial(made_motion_m(time_s), 0.0);
    law.commit();
    friction.commit();
    return force_n;
  });
}

SiteModel elastic_model(double stiffness_n_per_m) {
  SiteModel model = made_model();
  model.make_law = [stiffness_n_per_m] { return std::make_unique<Elastic>(stiffness_n_per_m); };
  return model;
}

const report::RankedCause& only_cause(const Diagnosis& diagnosis) {
  const auto count = std::ranges::count_if(diagnosis.report.ranking, &report::RankedCause::is_cause);
  EXPECT_EQ(count, 1);
  return diagnosis.report.ranking.front();
}

double value_of(const report::RankedCause& cause, std::string_view name) {
  const report::ReportedParameter* const parameter = find_parameter(cause, name);
  return parameter == nullptr ? std::nan("") : parameter->value;
}

/// An amplifier gives way before its limit: no effect of the library has quite that curve. A self-centring law whose
/// loop is closed comes nearest.
TEST(LawForm, LoadCellThatGivesWayAtItsLimitIsNoLaw) {
  constexpr double kLimit_n = 28e3;  // half of what the specimen gives
  const Recording recording = made_recording(made_motion_m, [&](double time_s) {
    const double force_n = kMadeStiffness_n_per_m * made_motion_m(time_s);
    return force_n / std::pow(1.0 + std::pow(std::abs(force_n) / kLimit_n, 12), 1.0 / 12.0);
  });
  const Diagnosis diagnosis = diagnosis_of(elastic_model(kMadeStiffness_n_per_m), recording);
  EXPECT_EQ(diagnosis.report.verdict, Verdict::partial);
  const report::RankedCause& cause = diagnosis.report.ranking.front();
  EXPECT_EQ(cause.interface + "." + cause.effect, "force_sensor.saturation");
  EXPECT_NEAR(value_of(cause, "limit_n"), kLimit_n, 0.02 * kLimit_n);  // 2 to the power 1/12 is 6 % at the corner
}

/// A rocking wall softens and comes back the same way: no limit of a load cell bends a force like that.
TEST(LawForm, SpecimenThatSoftensWithoutALoopIsALaw) {
  const SelfCentring::Parameters rocking{kMadeStiffness_n_per_m, 16e3, 0.2, 0.0};
  SiteModel bilinear = made_model();
  bilinear.make_law = [] {
    return std::make_unique<Bilinear>(Bilinear::Parameters{kMadeStiffness_n_per_m, kYield_n, kHardening});
  };
  for (const SiteModel& model : {elastic_model(kMadeStiffness_n_per_m), bilinear}) {
    SelfCentring law{rocking};
    const Diagnosis diagnosis = diagnosis_of(model, recording_of(law));
    EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
    const report::RankedCause& cause = only_cause(diagnosis);
    EXPECT_EQ(cause.law, "self_centring");
    EXPECT_NEAR(value_of(cause, "stiffness_n_per_m"), kMadeStiffness_n_per_m, 1e-3 * kMadeStiffness_n_per_m);
    EXPECT_NEAR(value_of(cause, "activation_force_n"), 16e3, 16.0);
    EXPECT_NEAR(value_of(cause, "hardening_ratio"), 0.2, 1e-3);
    EXPECT_EQ(value_of(cause, "flag_ratio"), 0.0);
  }
}

/// However much stronger it is: the recordings tell that it does not yield, and nothing of its strength.
TEST(LawForm, SpecimenThatDoesNotYieldIsAStrengthThatIsWrong) {
  SiteModel model = made_model();
  model.make_law = [] {
    return std::make_unique<Bilinear>(Bilinear::Parameters{0.9 * kMadeStiffness_n_per_m, kYield_n, kHardening});
  };
  Elastic real{kMadeStiffness_n_per_m};
  const Diagnosis diagnosis = diagnosis_of(model, recording_of(real));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
  EXPECT_EQ(only_cause(diagnosis).effect, "strength_error");
  const report::ReportedParameter* const strength = find_parameter(only_cause(diagnosis), "strength_error_ratio");
  ASSERT_NE(strength, nullptr);
  // The largest force, less what it passed the model's strength by.
  EXPECT_GE(strength->value, kMadeStiffness_n_per_m * kLargest_m / kYield_n - 1.1);
  EXPECT_TRUE(strength->is_at_least);
  EXPECT_FALSE(strength->ci95);
  ASSERT_EQ(diagnosis.report.corrections.size(), 1U);
  EXPECT_NEAR(value_of(diagnosis.report.corrections.front(), "stiffness_error_ratio"), 1.0 / 0.9 - 1.0, 1e-3);
}

/// Whatever the user believes of the stiffness, from a tenth to ten times the real one.
TEST(LawForm, YieldingUnderAnElasticModelIsOneCause) {
  const auto real = real_bilinear();
  const Recording recording = recording_of(*real);
  for (const double share : {0.1, 1.0, 10.0}) {
    SCOPED_TRACE(share);
    const Diagnosis diagnosis = diagnosis_of(elastic_model(share * kMadeStiffness_n_per_m), recording);
    EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
    const report::RankedCause& cause = only_cause(diagnosis);
    EXPECT_EQ(cause.effect, "yielding");
    EXPECT_EQ(cause.law, "bilinear");
    // 20 N of noise on 16 kN, 6000 samples: a thousandth is ten times what the noise leaves.
    EXPECT_NEAR(value_of(cause, "stiffness_n_per_m"), kMadeStiffness_n_per_m, 1e-3 * kMadeStiffness_n_per_m);
    EXPECT_NEAR(value_of(cause, "yield_force_n"), kYield_n, 1e-3 * kYield_n);
    EXPECT_NEAR(value_of(cause, "hardening_ratio"), kHardening, 1e-3);
  }
}

/// Elastic, perfectly plastic under an axial load P at the height h: bilinear with k - P / h before and -P / h after
/// yielding. Beside a spring of any stiffness nothing else can be told, and nothing else is.
TEST(LawForm, YieldingUnderAnAxialLoadSoftens) {
  constexpr double kLoadOverHeight_n_per_m = 0.05 * kMadeStiffness_n_per_m;
  constexpr double kBefore_n_per_m = kMadeStiffness_n_per_m - kLoadOverHeight_n_per_m;
  Bilinear column{{kMadeStiffness_n_per_m, kYield_n, 0.0}};
  const Recording recording = made_recording(made_motion_m, [&](double time_s) {
    const double force_n = column.trial(made_motion_m(time_s), 0.0);
    column.commit();
    return force_n - kLoadOverHeight_n_per_m * made_motion_m(time_s);
  });
  for (const double share : {0.1, 1.0}) {
    SCOPED_TRACE(share);
    const Diagnosis diagnosis = diagnosis_of(elastic_model(share * kMadeStiffness_n_per_m), recording);
    EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
    const report::RankedCause& cause = only_cause(diagnosis);
    EXPECT_EQ(cause.effect, "yielding");
    EXPECT_EQ(cause.law, "bilinear");
    EXPECT_NEAR(value_of(cause, "stiffness_n_per_m"), kBefore_n_per_m, 1e-3 * kBefore_n_per_m);
    EXPECT_NEAR(value_of(cause, "hardening_ratio"), -kLoadOverHeight_n_per_m / kBefore_n_per_m, 1e-3);
  }
}

/// A wall that rocks: what its weight takes beyond the uplift is a negative hardening.
TEST(LawForm, WallThatRocksSoftens) {
  SelfCentring wall{{kMadeStiffness_n_per_m, kYield_n, -0.05, 0.1}};
  const Diagnosis diagnosis = diagnosis_of(elastic_model(kMadeStiffness_n_per_m), recording_of(wall));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
  const report::RankedCause& cause = only_cause(diagnosis);
  EXPECT_EQ(cause.law, "self_centring");
  EXPECT_NEAR(value_of(cause, "hardening_ratio"), -0.05, 1e-3);  // as in YieldingUnderAnElasticModelIsOneCause
  EXPECT_NEAR(value_of(cause, "flag_ratio"), 0.1, 1e-3);
}

/// A wall that rocks on a joint that rubs: the loop is that of the friction, and the law has none.
TEST(LawForm, FrictionBesideAWallThatRocksIsACauseOfItsOwn) {
  constexpr double kFriction_n = 2e3;
  SelfCentring wall{{kMadeStiffness_n_per_m, kYield_n, -0.05, 0.0}};
  const Recording recording = recording_of(wall, Friction{{kFriction_n, 3e-4}});
  const Diagnosis diagnosis = diagnosis_of(elastic_model(kMadeStiffness_n_per_m), recording);
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
  ASSERT_EQ(std::ranges::count_if(diagnosis.report.ranking, &report::RankedCause::is_cause), 2);
  EXPECT_EQ(diagnosis.report.ranking[0].law, "self_centring");
  EXPECT_NEAR(value_of(diagnosis.report.ranking[0], "hardening_ratio"), -0.05, 1e-3);
  EXPECT_EQ(value_of(diagnosis.report.ranking[0], "flag_ratio"), 0.0);
  EXPECT_EQ(diagnosis.report.ranking[1].effect, "coulomb_friction");
  EXPECT_NEAR(value_of(diagnosis.report.ranking[1], "friction_force_n"), kFriction_n, 0.01 * kFriction_n);
}

/// Two sliders in a row, the weaker on the flatter dish: a friction, and a law that yields beside it.
TEST(LawForm, TwoSlidersInARowAreAFrictionAndALawThatYields) {
  Bilinear second{{kMadeStiffness_n_per_m, kYield_n, 0.15}};
  const Recording recording = recording_of(second, Friction{{5e3, 2e-4}});
  const Diagnosis diagnosis = diagnosis_of(elastic_model(kMadeStiffness_n_per_m), recording);
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
  EXPECT_EQ(causes_of(diagnosis), (std::vector<std::string>{"coulomb_friction", "yielding"}));
}

/// A brace that hardens with its path and is stronger in compression, the more the further it went. What bilinear and
/// other laws leave of it is a fifteenth of the force, and no function of the motion; but it is not there where the
/// motion turns.
TEST(LawForm, WhatALawLeavesIsNoNoise) {
  double slip_m = 0.0;
  double path_m = 0.0;
  const Recording recording = made_recording(made_motion_m, [&](double time_s) {
    const double displacement_m = made_motion_m(time_s);
    const double trial_n = kMadeStiffness_n_per_m * (displacement_m - slip_m);
    const double asymmetry = trial_n < 0.0 ? 1.0 + 3.0 * std::abs(displacement_m) : 1.0;
    const double strength_n = 10e3 * (1.0 - 0.4 * std::expm1(-path_m / 0.05)) * asymmetry;
    const double beyond_m = std::max(0.0, std::abs(trial_n) - strength_n) / kMadeStiffness_n_per_m;
    slip_m += std::copysign(beyond_m, trial_n);
    path_m += beyond_m;
    return kMadeStiffness_n_per_m * (displacement_m - slip_m + 0.03 * displacement_m);
  });
  const Diagnosis diagnosis = diagnosis_of(elastic_model(kMadeStiffness_n_per_m), recording);
  EXPECT_TRUE(diagnosis.report.verdict == Verdict::partial || diagnosis.report.set_leaves_a_part);
  ASSERT_TRUE(diagnosis.report.interface_shrink);
  EXPECT_LT(diagnosis.report.interface_shrink->floor_nrmse, 0.1 * diagnosis.report.interface_shrink->nrmse_after);
}

TEST(LawForm, WrongStrengthAloneIsNoMissingEffect) {
  const auto real = real_bilinear();
  SiteModel model = made_model();
  model.make_law = [] {
    return std::make_unique<Bilinear>(Bilinear::Parameters{kMadeStiffness_n_per_m, 1.25 * kYield_n, kHardening});
  };
  const Diagnosis diagnosis = diagnosis_of(model, recording_of(*real));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
  EXPECT_EQ(only_cause(diagnosis).effect, "strength_error");
  EXPECT_NEAR(value_of(only_cause(diagnosis), "strength_error_ratio"), -0.2, 1e-3);
}

/// More hardening or less: one number, though three others together could make it.
TEST(LawForm, WrongHardeningAloneIsOneNumber) {
  const auto real = real_bilinear();
  const Recording recording = recording_of(*real);
  for (const double modelled : {kHardening + 0.1, 0.0}) {
    SCOPED_TRACE(modelled);
    SiteModel model = made_model();
    model.make_law = [modelled] {
      return std::make_unique<Bilinear>(Bilinear::Parameters{kMadeStiffness_n_per_m, kYield_n, modelled});
    };
    const Diagnosis diagnosis = diagnosis_of(model, recording);
    EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
    EXPECT_EQ(only_cause(diagnosis).effect, "hardening_error");
    const double error = (kHardening - modelled) / (1.0 - modelled);
    EXPECT_NEAR(value_of(only_cause(diagnosis), "hardening_error_ratio"), error, 1e-3);
  }
}

/// Concrete that cracks before it yields.
TEST(LawForm, CrackingIsPartOfTheLaw) {
  Takeda real{{.stiffness_n_per_m = kMadeStiffness_n_per_m,
               .yield_force_n = kYield_n,
               .hardening_ratio = kHardening,
               .cracking_force_n = 5e3,
               .cracked_ratio = 0.4}};
  const Diagnosis diagnosis = diagnosis_of(elastic_model(kMadeStiffness_n_per_m), recording_of(real));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
  const report::RankedCause& cause = only_cause(diagnosis);
  EXPECT_EQ(cause.law, "takeda");
  // 20 N of noise on 16 kN, 6000 samples.
  EXPECT_NEAR(value_of(cause, "yield_force_n"), kYield_n, 2e-3 * kYield_n);
  EXPECT_NEAR(value_of(cause, "cracking_force_n"), 5e3, 0.01 * 5e3);
  EXPECT_NEAR(value_of(cause, "cracked_ratio"), 0.4, 0.01);
}

/// A law of thirteen numbers, under a model of another form.
TEST(LawForm, LawOfManyNumbersIsFittedToTheNoise) {
  const BoucWenBaberNoori::Parameters real{.stiffness_n_per_m = kMadeStiffness_n_per_m,
                                           .alpha = 0.03,
                                           .n = 1.2,
                                           .gamma_per_m = 130.0,
                                           .beta_per_m = 200.0,
                                           .strength_degradation_per_j = 2e-4,
                                           .stiffness_degradation_per_j = 4e-4,
                                           .pinching = 0.85,
                                           .pinching_rate_per_j = 3e-3,
                                           .pinching_level = 0.1,
                                           .pinching_width_m = 0.0015,
                                           .width_share = 0.3};
  BoucWenBaberNoori law{real};
  SiteModel bilinear = made_model();
  bilinear.make_law = [] {
    return std::make_unique<Bilinear>(Bilinear::Parameters{kMadeStiffness_n_per_m, kYield_n, kHardening});
  };
  const Diagnosis diagnosis = diagnosis_of(bilinear, recording_of(law));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
  const report::RankedCause& cause = only_cause(diagnosis);
  EXPECT_EQ(cause.law, "bouc_wen_baber_noori");
  // What the numbers of the loop tell for certain; width and its share make up for each other.
  EXPECT_NEAR(value_of(cause, "stiffness_n_per_m"), kMadeStiffness_n_per_m, 0.01 * kMadeStiffness_n_per_m);
  EXPECT_NEAR(value_of(cause, "n"), real.n, 0.02 * real.n);
  EXPECT_NEAR(value_of(cause, "pinching"), real.pinching, 0.02 * real.pinching);
  EXPECT_NEAR(value_of(cause, "strength_degradation_per_j"), 2e-4, 0.05 * 2e-4);
  EXPECT_NEAR(value_of(cause, "stiffness_degradation_per_j"), 4e-4, 0.05 * 4e-4);
}

/// With both wrong it is still the law of the model, and not another one of the same form.
TEST(LawForm, WrongStrengthAndStiffnessAreNoOtherLaw) {
  const auto real = real_bilinear();
  SiteModel model = made_model();
  model.make_law = [] {
    return std::make_unique<Bilinear>(Bilinear::Parameters{1.1 * kMadeStiffness_n_per_m, 1.25 * kYield_n, kHardening});
  };
  const Diagnosis diagnosis = diagnosis_of(model, recording_of(*real));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
  const auto value = [&](std::string_view effect, std::string_view parameter) {
    const auto found = std::ranges::find(diagnosis.report.ranking, effect, &report::RankedCause::effect);
    return found == diagnosis.report.ranking.end() || !found->is_cause ? std::nan("") : value_of(*found, parameter);
  };
  EXPECT_EQ(std::ranges::count_if(diagnosis.report.ranking, &report::RankedCause::is_cause), 2);
  EXPECT_NEAR(value("strength_error", "strength_error_ratio"), -0.2, 1e-3);
  EXPECT_NEAR(value("stiffness_error", "stiffness_error_ratio"), 1.0 / 1.1 - 1.0, 1e-3);
}

struct Bristles {
  double of_largest = 0.0;  // motion over which they give way
  double damping_n_s_per_m = 0.0;
};

std::ostream& operator<<(std::ostream& out, const Bristles& bristles) {
  return out << bristles.of_largest << " of the motion, " << bristles.damping_n_s_per_m << " N s/m";
}

/// Dry friction beside a spring, with bristles that give way over a small part of the motion (Dahl, 1968): neither dry
/// friction nor a law that yields has quite that loop, and beside damping the law of a magnetorheological damper has.
class FrictionWithBristles : public testing::TestWithParam<Bristles> {};

TEST_P(FrictionWithBristles, IsNoLaw) {
  constexpr double kFriction_n = 8e3;
  double share = 0.0;
  double last_m = 0.0;
  const Recording recording = made_recording(made_motion_m, [&](double time_s) {
    const double way_m = made_motion_m(time_s) - last_m;
    last_m += way_m;
    const double limit = std::copysign(1.0, way_m);
    share = limit + (share - limit) * std::exp(-std::abs(way_m) / (GetParam().of_largest * kLargest_m));
    return kMadeStiffness_n_per_m * last_m + kFriction_n * share +
           GetParam().damping_n_s_per_m * made_velocity_m_per_s(time_s);
  });
  const Diagnosis diagnosis = diagnosis_of(elastic_model(kMadeStiffness_n_per_m), recording);
  // Its exponent is one: no damping has to stand for the corners of the loop.
  std::vector<std::string> expected{"coulomb_friction"};
  if (GetParam().damping_n_s_per_m > 0.0) expected.emplace_back("viscous_damping");
  EXPECT_EQ(causes_of(diagnosis), expected);
  for (const report::RankedCause& cause : diagnosis.report.ranking) {
    if (cause.is_cause && cause.effect == "coulomb_friction") {
      // 20 N of noise in 6000 readings leave 0.3 N.
      EXPECT_NEAR(value_of(cause, "friction_force_n"), kFriction_n, 0.002 * kFriction_n);
      EXPECT_NEAR(value_of(cause, "presliding_exponent"), 1.0, 0.02);
    } else if (cause.is_cause) {
      // A hundredth of the smaller one: beside a friction, which has the same sign at all velocities.
      EXPECT_NEAR(value_of(cause, "damping_n_s_per_m"), GetParam().damping_n_s_per_m, 300.0);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(LawForm, FrictionWithBristles,
                         testing::Values(Bristles{.of_largest = 0.003}, Bristles{.of_largest = 0.01},
                                         Bristles{.of_largest = 0.015}, Bristles{0.01, 3e4}, Bristles{0.01, 1e5}));

/// It reloads towards its largest displacement: called a fracture with certainty before.
TEST(LawForm, PeakOrientedSpecimenIsALawOfAnotherForm) {
  PeakOriented::Parameters parameters;
  parameters.stiffness_n_per_m = kMadeStiffness_n_per_m;
  parameters.yield_force_n = kYield_n;
  parameters.hardening_ratio = kHardening;
  PeakOriented real{parameters};
  SiteModel model = made_model();
  model.make_law = real_bilinear;
  const Diagnosis diagnosis = diagnosis_of(model, recording_of(real));
  EXPECT_EQ(diagnosis.report.ranking.front().effect, "hysteresis_law");
  EXPECT_EQ(diagnosis.report.ranking.front().law, "peak_oriented");
  EXPECT_GT(diagnosis.report.interface_shrink->variance_removed, 0.999);
}

/// A gap of another size at another interface.
TEST(VerdictPerInterface, NoInterfaceHidesACauseAtAnother) {
  const auto late_m = [](double t) { return made_motion_m(t - 0.005); };
  Recording recording = made_recording(late_m, [&](double t) {
    const double rises = late_m(t + 1e-5) - late_m(t - 1e-5);
    return kMadeStiffness_n_per_m * late_m(t) + (rises > 0.0 ? 300.0 : -300.0);
  });
  const Diagnosis diagnosis = diagnosis_of(made_model(), recording);
  const auto has_cause = [&](std::string_view interface, std::string_view effect) {
    return std::ranges::any_of(diagnosis.report.ranking, [&](const report::RankedCause& cause) {
      return cause.is_cause && cause.interface == interface && cause.effect == effect;
    });
  };
  EXPECT_TRUE(has_cause("transfer_system", "delay"));
  EXPECT_TRUE(has_cause("specimen", "coulomb_friction"));
  for (const char* interface : {"transfer_system", "specimen"}) {
    const auto gap = std::ranges::find(diagnosis.report.where, interface, &report::InterfaceGap::interface);
    ASSERT_NE(gap, diagnosis.report.where.end());
    ASSERT_TRUE(gap->verdict.has_value()) << interface;
    EXPECT_TRUE(report::names_a_cause(*gap->verdict)) << interface;
  }
}

TEST(LawCandidates, StartFromTheirOwnLawsParameters) {
  for (const bool law_is_spring : {true, false}) {
    for (const LawCandidate& candidate : law_candidates(law_is_spring)) {
      SCOPED_TRACE(candidate.type.replacement->law);
      ASSERT_EQ(candidate.ranges.size(), candidate.type.parameters.size());
      std::vector<double> values;
      for (const SearchRange& range : candidate.ranges) values.push_back(0.5 * (range.low + range.high));
      values[0] = 2.0e6;
      values[1] = 0.01;
      const auto law = candidate.type.replacement->make(values);
      ASSERT_NE(law, nullptr);
      // The first is the stiffness, or of what slides the friction.
      const bool is_stiffness = candidate.type.parameters.front().name == "stiffness_n_per_m";
      EXPECT_EQ(is_stiffness, candidate.type.parameters.front().unit == "N/m");
      if (is_stiffness) {
        EXPECT_NEAR(law->initial_stiffness_n_per_m(), 2.0e6, 1.0);
      }
      // The force is proportional to the first parameter, the others held.
      std::vector<double> twice = values;
      twice[0] *= 2.0;
      const auto stiffer = candidate.type.replacement->make(twice);
      for (const double displacement_m : {0.004, 0.015, -0.02, 0.001, 0.018}) {
        const double force_n = law->trial(displacement_m, 0.0);
        EXPECT_NEAR(stiffer->trial(displacement_m, 0.0), 2.0 * force_n, 1e-6 * std::abs(force_n));
        law->commit();
        stiffer->commit();
      }
      values[0] = 0.0;
      EXPECT_EQ(candidate.type.replacement->make(values), nullptr);
    }
  }
}

}  // namespace
}  // namespace hybridtest
