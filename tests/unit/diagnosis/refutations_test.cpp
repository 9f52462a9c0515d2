#include "diagnosis/verdict/refutations.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "diagnosis/identification/law_candidates.hpp"
#include "diagnosis/identification/search_table.hpp"
#include "diagnosis/verdict/causes.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

namespace hybridtest {
namespace {

using enum EffectInterface;
using testing::HasSubstr;
using testing::IsEmpty;

double spring_n(double time_s) { return kMadeStiffness_n_per_m * made_motion_m(time_s); }

/// Two seconds at rest, the motion, and rest again.
double between_rests_m(double time_s) { return time_s < 2.0 || time_s > 10.0 ? 0.0 : made_motion_m(time_s - 2.0); }

IdentificationProblem problem_of(const Recording& recording) {
  return make_problem(made_model(), segments_of(recording, 0, 0));
}

/// A fit with these values, as sure as `error` of each.
Candidate fit_of(EffectInterface interface, std::string_view effect, const std::vector<double>& values,
                 double error = 1e-9) {
  Candidate candidate;
  candidate.type = find_effect(interface, effect);
  candidate.fit.effects.push_back({candidate.type, values});
  candidate.fit.parameters.emplace_back();
  for (const double value : values) {
    candidate.fit.parameters.back().push_back({.value = value, .standard_error = error});
  }
  const auto count = static_cast<Eigen::Index>(values.size());
  candidate.fit.covariances.emplace_back(error * error * Eigen::MatrixXd::Identity(count, count));
  return candidate;
}

TEST(Refutation, LoadCellLimitThatReadingsPass) {
  const auto clipped_n = [](double t) { return std::clamp(spring_n(t), -30e3, 30e3); };
  const IdentificationProblem problem = problem_of(made_recording(made_motion_m, clipped_n));
  EXPECT_THAT(refutation(problem, fit_of(force_sensor, "saturation", {30e3})), IsEmpty());
  EXPECT_THAT(refutation(problem, fit_of(force_sensor, "saturation", {20e3})),
              HasSubstr("of the readings pass its limit"));
  EXPECT_THAT(refutation(problem, fit_of(force_sensor, "saturation", {40e3})), HasSubstr("no reading comes near"));
  // A limit that what is left beside it makes unsure by half of it is passed all the same.
  EXPECT_THAT(refutation(problem, fit_of(force_sensor, "saturation", {26e3}, 7e3)),
              HasSubstr("of the readings pass its limit"));
}

/// A smoothed force overshoots at the corners of a clipped one. What counts is what the cell read.
TEST(Refutation, LoadCellLimitThatOnlyTheSmoothedForcePasses) {
  const auto clipped_n = [](double t) { return std::clamp(5.0 * spring_n(t), -30e3, 30e3); };
  const Recording recording = made_recording(made_motion_m, clipped_n);
  std::vector<Segment> segments = segments_of(recording, 0, 0);
  for (Segment& segment : segments) {
    if (segment.to == Channel::measured_force) segment = smoothed_alike(segment, recording.dofs[0], 20.0);
  }
  const std::vector<double>& smooth_n = segments.back().measured;
  ASSERT_GT(std::ranges::count_if(smooth_n, [](double value) { return value > 1.06 * 30e3; }), 10);
  const IdentificationProblem problem = make_problem(made_model(), segments);
  EXPECT_THAT(refutation(problem, fit_of(force_sensor, "saturation", {30e3})), IsEmpty());
  EXPECT_THAT(refutation(problem, fit_of(force_sensor, "saturation", {20e3})),
              HasSubstr("of the readings pass its limit"));
  EXPECT_THAT(refutation(problem, fit_of(force_sensor, "saturation", {40e3})), HasSubstr("no reading comes near"));
}

/// A second and a half of the rest is not judged, as where a recording is smoothed: the prediction is set to the
/// readings there.
TEST(Refutation, BiasIsReadWhereItIsJudged) {
  constexpr double kBias_n = 2e3;
  IdentificationProblem problem = problem_of(
      made_recording(between_rests_m, [](double t) { return kMadeStiffness_n_per_m * between_rests_m(t) + kBias_n; }));
  FitSegment& fit = problem.segments.back();
  ASSERT_EQ(fit.segment.to, Channel::measured_force);
  fit.segment.unjudged = static_cast<std::size_t>(1.5 / kSitePeriod_s);
  const auto unjudged = static_cast<Eigen::Index>(fit.segment.unjudged / fit.averaged);
  fit.baseline.head(unjudged) = fit.measured.head(unjudged);
  EXPECT_THAT(refutation(problem, fit_of(force_sensor, "bias", {kBias_n})), IsEmpty());
  EXPECT_THAT(refutation(problem, fit_of(force_sensor, "bias", {3.0 * kBias_n})), HasSubstr("at rest before the test"));
}

/// A column of 1 m under the load whose P / h is the specimen's stiffness; and one of which a stiffness that is as much
/// off takes nearly all back.
TEST(Refutation, LoadUnderWhichNoSpecimenWouldStand) {
  const IdentificationProblem problem = problem_of(made_recording(made_motion_m, spring_n));
  EXPECT_THAT(refutation(problem, fit_of(specimen, "geometric_stiffness", {kMadeStiffness_n_per_m, 1.0})), IsEmpty());
  EXPECT_THAT(refutation(problem, fit_of(specimen, "geometric_stiffness", {100.0 * kMadeStiffness_n_per_m, 1.0})),
              HasSubstr("would stand under that load"));
}

TEST(Refutation, StrokeAndSpeedLimitThatMotionPasses) {
  const auto stopped_m = [](double t) { return std::clamp(made_motion_m(t), -0.02, 0.02); };
  const IdentificationProblem stopped = problem_of(made_recording(stopped_m, spring_n));
  EXPECT_THAT(refutation(stopped, fit_of(transfer_system, "stroke_limit", {0.02})), IsEmpty());
  EXPECT_THAT(refutation(stopped, fit_of(transfer_system, "stroke_limit", {0.015})), HasSubstr("pass its limit"));
  EXPECT_THAT(refutation(stopped, fit_of(transfer_system, "stroke_limit", {0.03})), HasSubstr("no reading comes near"));

  // A triangle of 0.05 m/s, under 20 um of noise: sample by sample the speed would be 0.014 m/s wrong.
  const auto triangle_m = [](double t) { return 0.05 / 2.0 * std::abs(std::fmod(t, 1.0) - 0.5) * 2.0; };
  Recording recording = made_recording(triangle_m, spring_n);
  Random random{8};
  for (double& value : recording.dofs[0].of(Channel::measured_displacement)) value += 2e-5 * random.normal();
  const IdentificationProblem slow = problem_of(recording);
  EXPECT_THAT(refutation(slow, fit_of(transfer_system, "velocity_limit", {0.05})), IsEmpty());
  EXPECT_THAT(refutation(slow, fit_of(transfer_system, "velocity_limit", {0.04})), HasSubstr("pass its limit"));
  EXPECT_THAT(refutation(slow, fit_of(transfer_system, "velocity_limit", {0.08})), HasSubstr("no reading comes near"));
}

TEST(Refutation, BiasAndDriftThatRestContradicts) {
  const auto force_of = [](double bias_n, double drift_n_per_s) {
    return [=](double t) { return kMadeStiffness_n_per_m * between_rests_m(t) + bias_n + drift_n_per_s * t; };
  };
  const IdentificationProblem clean = problem_of(made_recording(between_rests_m, force_of(0.0, 0.0)));
  EXPECT_THAT(refutation(clean, fit_of(force_sensor, "bias", {500.0})), HasSubstr("at rest before the test"));
  EXPECT_THAT(refutation(clean, fit_of(force_sensor, "drift", {50.0})), HasSubstr("between rests at the same place"));
  EXPECT_THAT(refutation(problem_of(made_recording(between_rests_m, force_of(500.0, 0.0))),
                         fit_of(force_sensor, "bias", {500.0})),
              IsEmpty());
  EXPECT_THAT(refutation(problem_of(made_recording(between_rests_m, force_of(0.0, 50.0))),
                         fit_of(force_sensor, "drift", {50.0})),
              IsEmpty());
  // Without rest there is nothing to say.
  const IdentificationProblem moving = problem_of(
      made_recording([](double t) { return made_motion_m(t + 3.0); }, [](double t) { return spring_n(t + 3.0); }));
  EXPECT_THAT(refutation(moving, fit_of(force_sensor, "bias", {500.0})), IsEmpty());
}

TEST(Refutation, IntervalThatHoldsNoEffect) {
  const IdentificationProblem problem = problem_of(made_recording(made_motion_m, spring_n));
  EXPECT_THAT(refutation(problem, fit_of(specimen, "viscous_damping", {100.0}, 60.0)),
              HasSubstr("the interval of damping_n_s_per_m holds the value at which it is absent"));
  EXPECT_THAT(refutation(problem, fit_of(specimen, "viscous_damping", {100.0}, 40.0)), IsEmpty());
  EXPECT_THAT(refutation(problem, fit_of(specimen, "viscous_damping", {0.0}, 0.0)), HasSubstr("absent"))
      << "at its bound";
  Candidate broken = fit_of(specimen, "fracture", {0.2, 5.0}, 0.0);
  broken.fit.parameters[0][0].standard_error = 0.3;
  EXPECT_THAT(refutation(problem, broken), HasSubstr("lost_ratio"));
  EXPECT_THAT(refutation(problem, fit_of(transfer_system, "bandwidth", {0.02, 0.1}, 0.02)), IsEmpty()) << "a shape";
}

/// A life of 2 m, known to 1 m: its inverse, which an endless life makes zero, is known to half of itself. Known to 3
/// m, it may be endless.
TEST(Refutation, LifeThatMayBeEndless) {
  const IdentificationProblem problem = problem_of(made_recording(made_motion_m, spring_n));
  const auto is_needless_with = [&](double error_m) {
    Candidate fading = fit_of(specimen, "stiffness_degradation_with_peak", {2.0, 0.0});
    fading.fit.parameters[0][0].beside_wrong_numbers = error_m;
    return is_needless(problem, fading.fit, 0);
  };
  EXPECT_FALSE(is_needless_with(0.5));
  EXPECT_TRUE(is_needless_with(1.5));
}

TEST(Refutation, ShapeThatMakesUpForTheSizeIsHeld) {
  // Of a tall column the load over the height is known to a hundredth, and each alone to a half.
  const IdentificationProblem problem = problem_of(made_recording(made_motion_m, spring_n));
  Candidate column = fit_of(specimen, "geometric_stiffness", {1e5, 3.0});
  column.fit.parameters[0][0].standard_error = column.fit.parameters[0][0].beside_wrong_numbers = 0.6e5;
  column.fit.parameters[0][1].standard_error = column.fit.parameters[0][1].beside_wrong_numbers = 1.8;
  const auto with_correlation = [&](double correlation) {
    Candidate same = column;
    same.fit.covariances[0] = Eigen::Matrix2d{{0.36e10, correlation * 1.08e5}, {correlation * 1.08e5, 3.24}};
    return refutation(problem, same);
  };
  EXPECT_THAT(with_correlation(0.9999), IsEmpty());
  EXPECT_THAT(with_correlation(0.0), HasSubstr("axial_force_n"));
}

TEST(Refutation, ColumnTooTallForItsHeightToShowIsNotCutOff) {
  // Of such a column only the load over the height shows. Control: a contact stiffer than the range is cut off.
  const IdentificationProblem problem = problem_of(made_recording(made_motion_m, spring_n));
  const auto at_highest = [&](const char* name, std::size_t parameter, std::vector<double> values) {
    const EffectType& type = *find_effect(specimen, name);
    const SearchRange& range = *search_range(type, type.parameters[parameter]);
    values[parameter] = range.high * problem.scales.of(range.scale);
    Candidate candidate = fit_of(specimen, name, values);
    candidate.fit.parameters[0][parameter].at_bound = true;
    return is_cut_off(problem, candidate.fit, 0);
  };
  EXPECT_FALSE(at_highest("geometric_stiffness", 1, {1e5, 0.0}));
  EXPECT_TRUE(at_highest("contact", 0, {0.0, 0.01, 0.0, 1.0}));
}

TEST(Refutation, IntervalThatIsReportedIsNotNarrowedByAShapeHeld) {
  // The shape makes up for the size, so something is there; what is reported of the size alone holds none of it.
  const IdentificationProblem problem = problem_of(made_recording(made_motion_m, spring_n));
  Candidate column = fit_of(specimen, "geometric_stiffness", {1e5, 3.0});
  column.fit.covariances[0] = Eigen::Matrix2d{{0.36e10, 0.9999 * 1.08e5}, {0.9999 * 1.08e5, 3.24}};
  for (ParameterEstimate& estimate : column.fit.parameters[0]) {
    estimate.standard_error = estimate.beside_wrong_numbers = 0.6 * estimate.value;
  }
  EXPECT_THAT(refutation(problem, column), IsEmpty());
  EXPECT_TRUE(may_be_absent(problem, column.fit, 0));
  for (ParameterEstimate& estimate : column.fit.parameters[0]) estimate.beside_wrong_numbers = 0.4 * estimate.value;
  EXPECT_FALSE(may_be_absent(problem, column.fit, 0));
}

TEST(Judge, GivesNoNameToWhatMayBeAbsentByItsInterval) {
  const auto damped_n = [](double t) {
    return spring_n(t) + 3e4 * (made_motion_m(t + 5e-4) - made_motion_m(t - 5e-4)) / 1e-3;
  };
  const IdentificationProblem problem = problem_of(made_recording(made_motion_m, damped_n));
  Candidate damping;
  damping.type = find_effect(specimen, "viscous_damping");
  damping.fit = fit_effects(problem, {damping.type}, false);
  Selection selection;
  selection.baseline = fit_nothing(problem, false);
  selection.chosen = damping.fit;
  damping.probability = 0.9;
  selection.library.push_back(damping);
  EXPECT_EQ(judge(problem, selection).verdict, report::Verdict::named);
  EXPECT_THAT(judge(problem, selection).may_be_absent, IsEmpty());
  ParameterEstimate& estimate = selection.chosen.parameters[0][0];
  estimate.beside_wrong_numbers = 0.6 * estimate.value;
  EXPECT_EQ(judge(problem, selection).verdict, report::Verdict::partial);
  EXPECT_THAT(judge(problem, selection).may_be_absent, testing::ElementsAre(0U));
}

/// A law that is a little too strong has a loop that looks late, and the force before it early.
TEST(Refutation, TransducerLagThatTheForceOfALawThatYieldsDoesNotShow) {
  constexpr double kLate_s = 1.1e-3;
  const auto law = [](double strength_n) {
    return std::make_unique<Bilinear>(Bilinear::Parameters{
        .stiffness_n_per_m = kMadeStiffness_n_per_m, .yield_force_n = strength_n, .hardening_ratio = 0.05});
  };
  SiteModel model = made_model();
  model.make_law = [&] { return law(1.03 * 1.5e4); };
  const auto moved_m = [](double t) { return made_motion_m(std::max(0.0, t - kLate_s)); };
  const auto refuted = [&](double lag_s) {
    const std::unique_ptr<Law> specimen = law(1.5e4);
    const auto force_n = [&](double t) {
      const double force = specimen->trial(moved_m(t + lag_s), 0.0);
      specimen->commit();
      return force;
    };
    const IdentificationProblem problem = make_problem(model, segments_of(made_recording(moved_m, force_n), 0, 0));
    return refutation(problem, fit_of(displacement_sensor, "lag", {kLate_s, 0.0}));
  };
  EXPECT_THAT(refuted(0.0), HasSubstr("the force comes"));
  EXPECT_THAT(refuted(kLate_s), IsEmpty()) << "the force is as early as the reading is late";
}

TEST(Judge, GivesNoNameToSoManyEffectsThatTheyMayStandForAnother) {
  const EffectSetting damper{find_effect(specimen, "viscous_damping"), {3e4}};
  const EffectSetting cubic{find_effect(specimen, "cubic_stiffness"), {1e10}};
  const EffectSetting stop{find_effect(specimen, "contact"), {4e6, 0.004, 0.0, 1.0}};
  const EffectSetting friction{find_effect(specimen, "coulomb_friction"), {3e3, 0.0, 1e-4, 0.0}};
  const EffectSetting fading{find_effect(specimen, "relaxation"), {1e6, 0.1}};
  const auto judged = [&](const std::vector<EffectSetting>& effects) {
    std::vector<Segment> segments = segments_of(made_recording(made_motion_m, spring_n), 0, 0);
    Segment& segment = segments.back();
    const std::vector<double> with_n = predict(made_model(), segment, effects);
    const std::vector<double> without_n = predict(made_model(), segment);
    for (std::size_t i = 0; i < with_n.size(); ++i) segment.measured[i] += with_n[i] - without_n[i];
    const IdentificationProblem problem = make_problem(made_model(), segments);
    Selection selection;
    selection.baseline = fit_nothing(problem, false);
    selection.chosen = refit_effects(problem, effects, false);
    selection.library.push_back({.type = effects.front().type, .fit = selection.chosen, .probability = 0.9});
    return judge(problem, selection);
  };
  EXPECT_EQ(judged({cubic, friction, damper}).verdict, report::Verdict::named) << "damping is a number of the model";
  EXPECT_FALSE(judged({cubic, friction, damper}).is_pieced_together);
  EXPECT_EQ(judged({cubic, stop}).verdict, report::Verdict::partial) << "two curves";
  EXPECT_TRUE(judged({cubic, stop}).is_pieced_together);
  EXPECT_EQ(judged({cubic, friction, fading}).verdict, report::Verdict::partial) << "three effects";
  EXPECT_TRUE(judged({cubic, friction, fading}).is_pieced_together);
}

TEST(Refutation, IntervalsOfEarlierEffectsMayBeWide) {
  const IdentificationProblem problem = problem_of(made_recording(made_motion_m, spring_n));
  Candidate pair = fit_of(specimen, "viscous_damping", {100.0}, 40.0);
  pair.fit.effects.push_back({find_effect(specimen, "inertia"), {5.0}});
  pair.fit.parameters.push_back({{.value = 5.0, .standard_error = 4.0, .beside_wrong_numbers = 4.0}});
  pair.fit.covariances.emplace_back(Eigen::MatrixXd::Constant(1, 1, 16.0));
  EXPECT_THAT(refutation(problem, pair), IsEmpty());
  pair.type = find_effect(specimen, "inertia");
  EXPECT_THAT(refutation(problem, pair), HasSubstr("mass_kg"));
}

TEST(Refutation, EffectThatTheOthersTakeBack) {
  // A load cell that is 2 ms late, and a damper of nearly the stiffness times as much: the force of one is that of the
  // other, with the other sign.
  const IdentificationProblem problem = problem_of(made_recording(made_motion_m, spring_n));
  const auto beside_lag = [&](double share) {
    Candidate pair = fit_of(force_sensor, "lag", {0.002, 0.0});
    pair.fit.effects.push_back({find_effect(specimen, "viscous_damping"), {share * 0.002 * kMadeStiffness_n_per_m}});
    pair.fit.parameters.push_back({{.value = 1.0, .standard_error = 1e-9}});
    pair.fit.covariances.emplace_back(Eigen::MatrixXd::Constant(1, 1, 1e-18));
    pair.type = find_effect(specimen, "viscous_damping");
    return refutation(problem, pair);
  };
  EXPECT_THAT(beside_lag(0.95), HasSubstr("alone it would change more than ten times"));
  EXPECT_THAT(beside_lag(0.8), IsEmpty());
}

/// A motion that is read late has its force early: where the two go together, it is the actuator that is late.
TEST(Refutation, LagOfATransducerWhoseForceIsNoEarlier) {
  constexpr double kLag_s = 0.01;
  const auto late_m = [](double t) { return made_motion_m(t - kLag_s); };
  const auto problem_with = [&](double force_lag_s) {
    return problem_of(made_recording(late_m, [=](double t) { return spring_n(t - force_lag_s); }));
  };
  const Candidate lag = fit_of(displacement_sensor, "lag", {kLag_s, 0.0});
  EXPECT_THAT(refutation(problem_with(kLag_s), lag), HasSubstr("before what the model has for the reading"));
  EXPECT_THAT(refutation(problem_with(0.6 * kLag_s), lag), HasSubstr("before what the model has for the reading"));
  EXPECT_THAT(refutation(problem_with(0.4 * kLag_s), lag), IsEmpty());
  EXPECT_THAT(refutation(problem_with(0.0), lag), IsEmpty());
}

TEST(Refutation, EarlierEffectThatRestContradictsIsNeedless) {
  // A bias that was needed before the damping was found: it does not speak against the damping, it goes.
  const IdentificationProblem problem =
      problem_of(made_recording(between_rests_m, [](double t) { return kMadeStiffness_n_per_m * between_rests_m(t); }));
  Candidate pair = fit_of(force_sensor, "bias", {500.0});
  pair.fit.effects.push_back({find_effect(specimen, "viscous_damping"), {100.0}});
  pair.fit.parameters.push_back({{.value = 100.0, .standard_error = 1.0, .beside_wrong_numbers = 1.0}});
  pair.fit.covariances.emplace_back(Eigen::MatrixXd::Constant(1, 1, 1.0));
  pair.type = find_effect(specimen, "viscous_damping");
  EXPECT_THAT(refutation(problem, pair), IsEmpty());
  EXPECT_TRUE(is_needless(problem, pair.fit, 0));
  EXPECT_FALSE(is_needless(problem, pair.fit, 1));
}

TEST(Refutation, FurtherEffectAtTheEndOfItsRange) {
  const IdentificationProblem problem = problem_of(made_recording(made_motion_m, spring_n));
  Candidate lag = fit_of(transfer_system, "bandwidth", {0.004, 2.0});
  lag.fit.parameters[0][1].at_bound = true;  // a resonance, as sharp as is searched
  EXPECT_TRUE(is_cut_off(problem, lag.fit, 0));
  EXPECT_THAT(refutation(problem, lag), IsEmpty());  // alone it may be larger than the library expects
  Candidate further = lag;
  further.fit.effects.push_back({find_effect(transfer_system, "gain"), {0.02}});
  further.fit.parameters.push_back({{.value = 0.02, .standard_error = 1e-9}});
  further.fit.covariances.emplace_back(Eigen::MatrixXd::Constant(1, 1, 1e-18));
  EXPECT_THAT(refutation(problem, further), HasSubstr("at the limit of its search range"));

  lag.fit.effects[0].values[1] = lag.fit.parameters[0][1].value = 0.0;  // one pole: no limit that was chosen
  EXPECT_FALSE(is_cut_off(problem, lag.fit, 0));
  Candidate friction = fit_of(specimen, "coulomb_friction", {100.0, 0.0, 1e-6, 0.0});
  friction.fit.parameters[0][2].at_bound = true;  // as sharp as is searched
  EXPECT_FALSE(is_cut_off(problem, friction.fit, 0));
  Candidate deadband = fit_of(transfer_system, "deadband", {2e-5});
  EXPECT_FALSE(is_cut_off(problem, deadband.fit, 0));
  deadband.fit.parameters[0][0].at_bound = true;  // smaller than is searched, and not absent
  EXPECT_TRUE(is_cut_off(problem, deadband.fit, 0));
}

TEST(Refutation, FrictionThatIsASpringMostOfTheWay) {
  const IdentificationProblem problem = problem_of(made_recording(made_motion_m, spring_n));
  EXPECT_THAT(refutation(problem, fit_of(specimen, "coulomb_friction", {3e3, 0.0, 0.012, 0.0}, 0.0001)),
              HasSubstr("of the path, as a spring that yields"));
  EXPECT_THAT(refutation(problem, fit_of(specimen, "coulomb_friction", {3e3, 0.0, 0.001, 0.0}, 0.0001)), IsEmpty());
}

TEST(Refutation, PowerOfTheVelocityThatIsASimplerDamping) {
  const IdentificationProblem problem = problem_of(made_recording(made_motion_m, spring_n));
  const auto damper = [&](double exponent, double error) {
    Candidate candidate = fit_of(specimen, "nonlinear_viscous_damping", {1.0e4, exponent, 0.0});
    candidate.fit.parameters[0][1].beside_wrong_numbers = error;
    return refutation(problem, candidate);
  };
  EXPECT_THAT(damper(0.9, 0.04), IsEmpty());
  EXPECT_THAT(damper(0.9, 0.06), HasSubstr("may as well be linear"));
  EXPECT_THAT(damper(1.9, 0.04), IsEmpty());
  EXPECT_THAT(damper(1.9, 0.06), HasSubstr("may as well be quadratic"));
  Candidate smallest = fit_of(specimen, "nonlinear_viscous_damping", {1.0e4, 0.1, 0.0});
  smallest.fit.parameters[0][1].at_bound = true;
  EXPECT_THAT(refutation(problem, smallest), HasSubstr("may as well be dry friction"));
  Candidate beside = fit_of(specimen, "coulomb_friction", {3.0e3, 0.0, 0.001, 0.0}, 0.0001);
  const Candidate damping = fit_of(specimen, "nonlinear_viscous_damping", {1.0e4, 0.5, 0.0});
  beside.fit.effects.push_back(damping.fit.effects.front());
  beside.fit.parameters.push_back(damping.fit.parameters.front());
  beside.fit.covariances.push_back(damping.fit.covariances.front());
  beside.type = damping.type;
  EXPECT_THAT(refutation(problem, beside), HasSubstr("may as well be dry friction"));
}

TEST(Refutation, RelaxationThatIsHardlyMoreThanADashpot) {
  const IdentificationProblem problem = problem_of(made_recording(made_motion_m, spring_n));
  Candidate relaxation = fit_of(specimen, "relaxation", {1.0e5, 0.03});
  EXPECT_THAT(refutation(problem, relaxation), IsEmpty());
  relaxation.fit.parameters[0][1].at_bound = true;
  EXPECT_THAT(refutation(problem, relaxation), HasSubstr("may as well be a viscous damping"));
  // The longest is no dashpot.
  Candidate longest = fit_of(specimen, "relaxation", {1.0e5, 100.0});
  longest.fit.parameters[0][1].at_bound = true;
  EXPECT_THAT(refutation(problem, longest), IsEmpty());
}

TEST(Refutation, PartThatBrokeBeforeTheRecordingsShowIt) {
  const IdentificationProblem problem = problem_of(made_recording(made_motion_m, spring_n));
  const auto broken_at = [&](double instant_s) {
    Candidate fracture = fit_of(specimen, "fracture", {0.02, instant_s});
    fracture.fit.segments = fit_nothing(problem, false).segments;
    return fracture;
  };
  // 2 % of the spring: until 5 ms at most 0.1 N, until 0.5 s up to 250 N, beside 20 N of noise.
  EXPECT_THAT(refutation(problem, broken_at(0.005)), HasSubstr("do not show the part that broke at 5.00"));
  EXPECT_THAT(refutation(problem, broken_at(0.5)), IsEmpty());
  Candidate whenever = broken_at(0.5);
  whenever.fit.parameters[0][1].beside_wrong_numbers = 0.5;
  EXPECT_THAT(refutation(problem, whenever), HasSubstr("do not tell when"));
  // The recording ends at 12 s: by its interval the part may as well never have broken.
  whenever = broken_at(11.5);
  EXPECT_THAT(refutation(problem, whenever), IsEmpty());
  whenever.fit.parameters[0][1].beside_wrong_numbers = 0.5;
  EXPECT_THAT(refutation(problem, whenever), HasSubstr("do not tell when"));
}

TEST(Refutation, FurtherEffectIsJudgedByTheIntervalThatIsReported) {
  const IdentificationProblem problem = problem_of(made_recording(made_motion_m, spring_n));
  Candidate inertia = fit_of(specimen, "inertia", {5.0}, 1.0);
  inertia.fit.parameters[0][0].beside_wrong_numbers = 4.0;
  EXPECT_THAT(refutation(problem, inertia), IsEmpty());
  inertia.fit.effects.push_back({find_effect(specimen, "viscous_damping"), {100.0}});
  inertia.fit.parameters.push_back({{.value = 100.0, .standard_error = 4.0}});
  EXPECT_THAT(refutation(problem, inertia), HasSubstr("mass_kg"));
}

TEST(LawWithoutLoop, IsASelfCentringOneWithoutAFlagAndAlone) {
  const IdentificationProblem problem = problem_of(made_recording(made_motion_m, spring_n));
  const auto laws = law_candidates(true);
  const auto law =
      std::ranges::find(laws, "self_centring", [](const LawCandidate& l) { return l.type.replacement->law; });
  ASSERT_NE(law, laws.end());
  const auto fit_with = [&](const ParameterEstimate& flag) {
    FitOutcome fit;
    fit.effects.push_back({&law->type, {1e6, 0.01, 0.1, flag.value}});
    fit.parameters.push_back({{.value = 1e6}, {.value = 0.01}, {.value = 0.1}, flag});
    return fit;
  };
  const ParameterEstimate open{.value = 0.6, .standard_error = 0.1, .beside_wrong_numbers = 0.1};
  const ParameterEstimate doubtful{.value = 0.1, .standard_error = 0.1, .beside_wrong_numbers = 0.1};
  const ParameterEstimate closed{.value = 1e-5, .at_bound = true};
  EXPECT_FALSE(is_law_without_loop(problem, fit_with(open), 0));
  EXPECT_TRUE(is_law_without_loop(problem, fit_with(doubtful), 0));
  EXPECT_TRUE(is_law_without_loop(problem, fit_with(closed), 0));
  EXPECT_FALSE(is_law_without_loop(problem, fit_with({.value = 1.0, .at_bound = true}), 0));
  FitOutcome beside_friction = fit_with(closed);
  beside_friction.effects.push_back({find_effect(specimen, "coulomb_friction"), {100.0, 0.0, 1e-3, 0.0}});
  beside_friction.parameters.emplace_back(3);
  EXPECT_FALSE(is_law_without_loop(problem, beside_friction, 0));
  EXPECT_FALSE(is_law_without_loop(problem, beside_friction, 1)) << "friction is no law";
}

TEST(Refutation, DropsWhatIsRefutedAndKeepsTheOrder) {
  const IdentificationProblem problem = problem_of(made_recording(made_motion_m, spring_n));
  std::vector<Candidate> candidates{fit_of(specimen, "viscous_damping", {100.0}),
                                    fit_of(force_sensor, "saturation", {1e3}),
                                    fit_of(specimen, "coulomb_friction", {3e3, 0.0, 0.001, 0.0})};
  for (std::size_t i = 0; i < candidates.size(); ++i) candidates[i].score = 3.0 - static_cast<double>(i);
  drop_refuted(problem, candidates);
  ASSERT_EQ(candidates.size(), 2U);
  EXPECT_EQ(candidates[0].score, 3.0);
  EXPECT_EQ(candidates[1].score, 1.0);
}

/// The verdict on a gap that is so many floors high, of which an effect was chosen that leaves nearly all.
report::Verdict verdict_on_gap(double floors) {
  const auto unrelated_n = [](double t) { return spring_n(t) + 500.0 * std::sin(3.0 * t); };
  IdentificationProblem problem = problem_of(made_recording(made_motion_m, unrelated_n));
  Selection selection;
  for (FitSegment& fit : problem.segments) {
    if (!fit.is_suspect) continue;
    const double gap_n = (fit.measured - fit.baseline).norm() / std::sqrt(static_cast<double>(fit.measured.size()));
    fit.floor = fit.sample_floor = gap_n / floors;
    fit.weight = 1.0 / fit.floor;
  }
  selection.baseline = fit_nothing(problem, false);
  selection.chosen = fit_effects(problem, {find_effect(specimen, "cubic_stiffness")}, false);
  selection.library.push_back({.type = selection.chosen.effects.front().type, .fit = selection.chosen});
  return judge(problem, selection).verdict;
}

TEST(Judge, GapOfLessThanTwoFloorsThatNothingExplainsIsNone) {
  EXPECT_EQ(verdict_on_gap(1.5), report::Verdict::none);
  EXPECT_EQ(verdict_on_gap(4.0), report::Verdict::unknown);
}

}  // namespace
}  // namespace hybridtest
