#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "diagnosis/diagnose.hpp"
#include "diagnosis/identification/effect_fit.hpp"
#include "diagnosis/identification/smoothing_choice.hpp"
#include "diagnosis/verdict/causes.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "mechanics/laws/bouc_wen.hpp"
#include "mechanics/laws/friction.hpp"
#include "mechanics/laws/gap_spring.hpp"
#include "mechanics/laws/giuffre_menegotto_pinto.hpp"
#include "tests/unit/diagnosis/made_noise.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

namespace hybridtest {
namespace {

constexpr double kStiffness_n_per_m = kMadeStiffness_n_per_m;
constexpr double kStrength_n = 2.0e4;

struct NamedLaw {
  const char* name;
  std::function<std::unique_ptr<Law>()> make;
};

const std::array kLaws{
    NamedLaw{"elastic", [] { return std::make_unique<Elastic>(kStiffness_n_per_m); }},
    NamedLaw{"bilinear",
             [] {
               return std::make_unique<Bilinear>(Bilinear::Parameters{kStiffness_n_per_m, kStrength_n, 0.05});
             }},
    NamedLaw{"giuffre_menegotto_pinto",
             [] {
               GiuffreMenegottoPinto::Parameters parameters;
               parameters.stiffness_n_per_m = kStiffness_n_per_m;
               parameters.yield_force_n = kStrength_n;
               parameters.hardening_ratio = 0.05;
               return std::make_unique<GiuffreMenegottoPinto>(parameters);
             }},
    NamedLaw{"bouc_wen",
             [] {
               return std::make_unique<BoucWen>(BoucWen::Parameters{
                   .stiffness_n_per_m = kStiffness_n_per_m, .alpha = 0.05, .gamma_per_m = 50.0, .beta_per_m = 50.0});
             }},
    NamedLaw{"friction",
             [] {
               return std::make_unique<Friction>(
                   Friction::Parameters{.friction_force_n = 1e4, .presliding_displacement_m = 1e-3});
             }},
    NamedLaw{"gap",
             [] {
               return std::make_unique<GapSpring>(GapSpring::Parameters{kStiffness_n_per_m, 0.005});
             }},
};

/// What stands beside the law: nothing, damping, or damping and mass, with which force and motion are smoothed alike.
struct Beside {
  double damping_n_s_per_m;
  double mass_kg;
};
constexpr std::array kBeside{Beside{0.0, 0.0}, Beside{2e4, 0.0}, Beside{2e4, 2e3}};

SiteModel model_of(const NamedLaw& law, const Beside& beside) {
  SiteModel model = made_model();
  model.make_law = law.make;
  if (beside.damping_n_s_per_m > 0.0) {
    model.effects.push_back({find_effect(EffectInterface::specimen, "viscous_damping"), {beside.damping_n_s_per_m}});
  }
  if (beside.mass_kg > 0.0) {
    model.effects.push_back({find_effect(EffectInterface::specimen, "inertia"), {beside.mass_kg}});
  }
  return model;
}

double force_n(Law& law, const Beside& beside, double t, double strength) {
  constexpr double kStep_s = 1e-4;
  const double before_m = made_motion_m(std::max(0.0, t - kStep_s));
  const double after_m = made_motion_m(t + kStep_s);
  const double velocity_m_per_s = (after_m - before_m) / (2.0 * kStep_s);
  const double acceleration = (after_m - 2.0 * made_motion_m(t) + before_m) / (kStep_s * kStep_s);
  const double of_law_n = law.trial(made_motion_m(t), velocity_m_per_s);
  law.commit();
  return strength * of_law_n + beside.damping_n_s_per_m * velocity_m_per_s +
         beside.mass_kg * (t > 0.0 ? acceleration : 0.0);
}

/// A specimen that is this much stronger than the law, read with noise of 200 N; without the command.
Recording noisy_recording(const NamedLaw& law, const Beside& beside, const MadeNoise& noise, std::uint64_t draw,
                          double strength = 1.0) {
  const std::unique_ptr<Law> real = law.make();
  Random random{5, draw};
  Recording recording = made_recording([](double t) { return made_motion_m(t); },
                                       [&](double t) { return force_n(*real, beside, t, strength); }, 0.0);
  std::vector<double>& read_n = recording.dofs[0].of(Channel::measured_force);
  const std::vector<double> noise_n = made_noise(noise, read_n.size(), 200.0, kSitePeriod_s, draw);
  for (std::size_t i = 0; i < read_n.size(); ++i) read_n[i] += noise_n[i];
  for (double& x : recording.dofs[0].of(Channel::measured_displacement)) x += 1e-5 * random.normal();
  recording.dofs[0].of(Channel::command_displacement).clear();
  return recording;
}

/// The verdict on the model as it stands.
report::Verdict verdict_on(const SiteModel& model, const Recording& recording) {
  IdentificationProblem problem = make_problem(model, modelled_segments(model, recording, 0, 0));
  Selection selection;
  selection.baseline = fit_nothing(problem, false);
  selection.chosen = selection.baseline;
  settle_noise(problem, selection.chosen);
  return judge(problem, selection).verdict;
}

report::Verdict verdict_on(const NamedLaw& law, const Beside& beside, const MadeNoise& noise, std::uint64_t draw,
                           double strength = 1.0) {
  return verdict_on(model_of(law, beside), noisy_recording(law, beside, noise, draw, strength));
}

TEST(SettledNoise, RightModelIsNoneWithEveryLawAndSmoothing) {
  int wrong = 0;
  for (const NamedLaw& law : kLaws) {
    for (const Beside& beside : kBeside) {
      for (const MadeNoise& noise : {MadeNoise{}, MadeNoise{.correlation = 0.99}}) {
        const bool is_none = verdict_on(law, beside, noise, 1) == report::Verdict::none;
        wrong += is_none ? 0 : 1;
        EXPECT_TRUE(is_none || wrong <= 1) << law.name << ", " << beside.damping_n_s_per_m << " N s/m";
      }
    }
  }
  EXPECT_LE(wrong, 1);  // of 36; over 10 draws of each and an earthquake-like motion, 720, none was
}

/// What an actuator leaves of the measured motion is noise of the specimen's input, in a held-out recording too,
/// whatever law was found.
TEST(SettledNoise, ColouredNoiseOfTheMotionIsInTheFloorOfALaw) {
  const NamedLaw& bilinear = kLaws[1];
  constexpr double kNoise_m = 1e-4;
  std::array<Recording, 2> recordings;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const std::unique_ptr<Law> real = bilinear.make();
    recordings.at(i) = made_recording([](double t) { return made_motion_m(t); },
                                      [&](double t) {
                                        return force_n(*real, {0.0, 0.0}, t, 1.0);
                                      },
                                      10.0, i + 1);
    std::vector<double>& read_m = recordings.at(i).dofs[0].of(Channel::measured_displacement);
    const std::vector<double> noise_m =
        made_noise({.correlation = 0.95}, read_m.size(), kNoise_m, kSitePeriod_s, i + 1);
    for (std::size_t j = 0; j < read_m.size(); ++j) read_m[j] += noise_m[j];
  }
  recordings[1].file = "held_out.csv";
  recordings[1].role = RecordingRole::held_out;
  const Diagnosis diagnosis = diagnose(made_model(), recordings, {});
  EXPECT_EQ(diagnosis.report.verdict, report::Verdict::named);
  EXPECT_EQ(diagnosis.report.ranking.front().law, "bilinear");
  ASSERT_TRUE(diagnosis.report.interface_shrink);
  // Noise of the motion times the stiffness that the specimen has at the time; a law that follows its noise answers
  // less.
  const report::Shrink& shrink = *diagnosis.report.interface_shrink;
  EXPECT_NEAR(shrink.nrmse_after / shrink.floor_nrmse, 1.0, 0.15);
}

TEST(SettledNoise, HeldOutRecordingHasColouredNoiseToo) {
  const NamedLaw& bilinear = kLaws[1];
  const Beside damping{6e3, 0.0};
  constexpr MadeNoise kColoured{.correlation = 0.99};
  std::array recordings{noisy_recording(bilinear, damping, kColoured, 1),
                        noisy_recording(bilinear, damping, kColoured, 2)};
  recordings[1].file = "held_out.csv";
  recordings[1].role = RecordingRole::held_out;
  const Diagnosis diagnosis = diagnose(model_of(bilinear, {}), recordings, {});
  EXPECT_EQ(diagnosis.report.verdict, report::Verdict::named);
  ASSERT_TRUE(diagnosis.report.interface_shrink.has_value());
  const report::Shrink& left = *diagnosis.report.interface_shrink;
  // Two estimates of one deviation, each from 12 s of noise that a hundred samples, 0.2 s, correlate: 1 / sqrt(60).
  EXPECT_NEAR(left.nrmse_after, left.floor_nrmse, 0.25 * left.floor_nrmse);
}

/// Whatever the form of the law misses hardly changes while the motion turns; noise does.
TEST(SettledNoise, HeldOutRecordingHasColouredNoiseBesideALawToo) {
  const NamedLaw& bilinear = kLaws[1];
  constexpr MadeNoise kColoured{.correlation = 0.9};
  std::array recordings{noisy_recording(bilinear, {}, kColoured, 1), noisy_recording(bilinear, {}, kColoured, 2)};
  recordings[1].file = "held_out.csv";
  recordings[1].role = RecordingRole::held_out;
  const Diagnosis diagnosis = diagnose(made_model(), recordings, {});
  EXPECT_EQ(diagnosis.report.verdict, report::Verdict::named);
  EXPECT_EQ(diagnosis.report.ranking.front().law, "bilinear");
  ASSERT_TRUE(diagnosis.report.interface_shrink.has_value());
  const report::Shrink& left = *diagnosis.report.interface_shrink;
  // The noise is correlated over some 20 samples; the stretches have some 100 each, and their means are taken off.
  EXPECT_NEAR(left.nrmse_after, left.floor_nrmse, 0.25 * left.floor_nrmse);
}

/// Friction that changes with the place looks like noise to whatever holds velocity, displacement and path alone. It is
/// not there while the command rests; the noise is, also where that of the transducer hides the rest.
TEST(SettledNoise, FrictionThatChangesWithThePlaceIsNoNoise) {
  constexpr double kRest_s = 2.0;
  const auto motion_m = [](double t) { return t > kRest_s ? made_motion_m(t - kRest_s) : 0.0; };
  const auto verdict = [&](double friction_n, bool has_rest) {
    const auto force_n = [&](double t) {
      const double velocity_m_per_s = t > kRest_s ? made_velocity_m_per_s(t - kRest_s) : 0.0;
      return kStiffness_n_per_m * motion_m(t) +
             friction_n * std::tanh(velocity_m_per_s / 1e-3) * std::sin(motion_m(t) / 3e-3);
    };
    Recording recording = made_recording(motion_m, force_n, 200.0);
    Random random{7};
    DofRecording& dof = recording.dofs[0];
    for (double& x : dof.of(Channel::measured_displacement)) x += 4e-5 * random.normal();
    for (std::size_t i = 0; i < recording.samples; ++i) {
      dof.of(Channel::command_displacement)[i] = motion_m(kSitePeriod_s * static_cast<double>(i));
    }
    if (!has_rest) {
      recording.samples -= static_cast<std::size_t>(kRest_s / kSitePeriod_s);
      for (const Channel channel :
           {Channel::command_displacement, Channel::measured_displacement, Channel::measured_force}) {
        std::vector<double>& values = dof.of(channel);
        values.erase(values.begin(), values.end() - static_cast<std::ptrdiff_t>(recording.samples));
      }
    }
    return verdict_on(made_model(), recording);
  };
  EXPECT_NE(verdict(3000.0, true), report::Verdict::none);
  EXPECT_EQ(verdict(0.0, true), report::Verdict::none) << "control: the noise alone";
  EXPECT_EQ(verdict(3000.0, false), report::Verdict::none) << "control: what a recording without rest does not show";
}

/// Control. Friction beside damping is left out: while its amount is wrong, the widest smoothing seems the best one,
/// and what that does to a sliding force hides half of it.
TEST(SettledNoise, WrongModelIsNotNone) {
  for (const NamedLaw& law : kLaws) {
    for (const Beside& beside : kBeside) {
      if (std::string_view{law.name} == "friction" && beside.damping_n_s_per_m > 0.0) continue;
      EXPECT_NE(verdict_on(law, beside, {.correlation = 0.99}, 1, 1.5), report::Verdict::none) << law.name;
    }
  }
}

/// The load cell has an offset of a twentieth of the largest force, which drifts by a fiftieth. A wave as slow as the
/// recording is long is not taken off (control).
TEST(SettledNoise, SamplesAreAsIndependentBesideAnOffsetThatDrifts) {
  const auto independent = [](double offset_n, double drift_n, double wave_n) {
    const auto force_n = [&](double t) {
      const double part = t / 12.0;
      return kStiffness_n_per_m * made_motion_m(t) + offset_n + drift_n * part +
             wave_n * std::sin(2.0 * std::numbers::pi * part);
    };
    const Recording recording = made_recording(made_motion_m, force_n, 0.1);
    const IdentificationProblem problem = make_problem(made_model(), segments_of(recording, 0, 0));
    EXPECT_EQ(problem.segments.back().segment.to, Channel::measured_force);
    return problem.segments.back().independent;
  };
  const double alone = independent(0.0, 0.0, 0.0);
  // Noise by itself has a line, too, of a few percent of its slow part.
  EXPECT_NEAR(independent(1000.0, 400.0, 0.0), alone, 0.05 * alone);
  EXPECT_LT(independent(0.0, 0.0, 400.0), 0.5 * alone);
}

/// Noise of the transducer is ten times as much force in a model that is ten times too stiff as in the specimen. Of a
/// spring that is known from the slope of the recorded force; of a law that yields it is not.
TEST(SettledNoise, IsNoMoreThanTheBestFitLeaves) {
  constexpr double kReached_n = 10.0 * kStiffness_n_per_m * 0.02;
  const Recording recording = made_recording(
      made_motion_m, [](double t) { return kStiffness_n_per_m * made_motion_m(t); }, 0.1);
  const IdentificationProblem right = make_problem(made_model(), segments_of(recording, 0, 0));
  const FitSegment& beside = right.segments.back();
  const double left_n =
      (beside.measured - beside.baseline).norm() / std::sqrt(static_cast<double>(beside.measured.size()));
  SiteModel stiff = made_model();
  stiff.make_law = [] {
    return std::make_unique<Bilinear>(Bilinear::Parameters{10.0 * kStiffness_n_per_m, kReached_n, 0.1});
  };
  IdentificationProblem problem = make_problem(stiff, segments_of(recording, 0, 0));
  const FitSegment& force = problem.segments.back();
  ASSERT_EQ(force.segment.to, Channel::measured_force);
  EXPECT_GT(force.floor, 5.0 * left_n);
  const EffectType* const stiffness = find_effect(EffectInterface::specimen, "stiffness_error");
  settle_noise(problem, refit_effects(problem, {{stiffness, {-0.9, 0.0}}}, false));
  // One number fitted to thousands of samples takes off far less than a hundredth.
  EXPECT_NEAR(force.floor, left_n, 0.01 * left_n);
}

/// A law 2 % too strong, under noise that keeps its sign for a second: a dozen independent samples decide nothing, and
/// the model is right within what its numbers are known to.
TEST(SettledNoise, NumbersSlightlyOffUnderSlowNoiseAreCorrectedAndNoCauses) {
  const NamedLaw& bilinear = kLaws[1];
  for (const std::uint64_t draw : {1, 2, 3}) {
    const Recording recording = noisy_recording(bilinear, {}, {.correlation = 0.998}, draw, 0.98);
    const Diagnosis diagnosis = diagnose(model_of(bilinear, {}), {&recording, 1}, {});
    EXPECT_EQ(diagnosis.report.verdict, report::Verdict::none) << draw;
    EXPECT_FALSE(diagnosis.report.corrections.empty()) << draw;
  }
}

/// Control: a fifth too strong.
TEST(SettledNoise, StrengthFarOffUnderSlowNoiseIsNotNone) {
  const NamedLaw& bilinear = kLaws[1];
  const Recording recording = noisy_recording(bilinear, {}, {.correlation = 0.998}, 1, 0.8);
  EXPECT_NE(diagnose(model_of(bilinear, {}), {&recording, 1}, {}).report.verdict, report::Verdict::none);
}

}  // namespace
}  // namespace hybridtest
