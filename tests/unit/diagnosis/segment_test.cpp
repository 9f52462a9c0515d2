#include "diagnosis/identification/segment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>

#include "core/random.hpp"
#include "diagnosis/identification/effect_fit.hpp"
#include "diagnosis/identification/smoothing_choice.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "mechanics/laws/giuffre_menegotto_pinto.hpp"
#include "tests/unit/diagnosis/made_noise.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

namespace hybridtest {
namespace {

constexpr double kMass_kg = 2.0e4;

/// The motion of made recordings, which begins without a jump of any derivative that is looked at.
double motion_m(double t) { return made_motion_m(t + 1.0) * std::pow(std::tanh(t), 4); }

double acceleration_m_per_s2(double t) {
  constexpr double kStep_s = 1e-3;
  return (motion_m(t + kStep_s) - 2.0 * motion_m(t) + motion_m(t - kStep_s)) / (kStep_s * kStep_s);
}

SiteModel mass_only() {
  SiteModel model = made_model();
  model.make_law = nullptr;
  model.effects.push_back({find_effect(EffectInterface::specimen, "inertia"), {kMass_kg}});
  return model;
}

double root_mean_square(const std::vector<double>& values) {
  double squares = 0.0;
  for (const double value : values) squares += value * value;
  return std::sqrt(squares / static_cast<double>(values.size()));
}

double residual_n(const SiteModel& model, const Segment& segment) {
  std::vector<double> residual = predict(model, segment);
  for (std::size_t i = 0; i < residual.size(); ++i) residual[i] -= segment.measured[i];
  return root_mean_square(residual);
}

const Segment& of_force(const std::vector<Segment>& segments) {
  return *std::ranges::find(segments, Channel::measured_force, &Segment::to);
}

TEST(ModelledSegments, MassIsCorrectWithinAccelerationNoise) {
  const Recording recording = made_recording(motion_m, [](double t) { return kMass_kg * acceleration_m_per_s2(t); });
  const SiteModel model = mass_only();
  const auto segments = modelled_segments(model, recording, 0, 0);
  const Segment& smooth = of_force(segments);
  const double floor_n = noise_floor(smooth, input_errors(model, smooth));
  // One draw of noise against another one over 6000 samples of some tens of independent ones each.
  EXPECT_NEAR(residual_n(model, smooth), floor_n, 0.15 * floor_n);
  // Windows as wide as the displacement alone bears leave more.
  const auto plain = segments_of(recording, 0, 0);
  EXPECT_GT(residual_n(model, of_force(plain)), residual_n(model, smooth));
  EXPECT_LT(residual_n(model, smooth), 0.01 * root_mean_square(smooth.measured));
}

TEST(ModelledSegments, WrongMassIsDetected) {
  const Recording recording =
      made_recording(motion_m, [](double t) { return 1.1 * kMass_kg * acceleration_m_per_s2(t); });
  const auto segments = modelled_segments(mass_only(), recording, 0, 0);
  const Segment& smooth = of_force(segments);
  // Where it is judged.
  const auto judged = [&](const std::vector<double>& values) {
    const auto end = static_cast<std::ptrdiff_t>(smooth.unjudged);
    return std::vector<double>(values.begin() + end, values.end() - end);
  };
  const double part =
      residual_n(mass_only(), smooth) * std::sqrt(6000.0 / (6000.0 - 2.0 * static_cast<double>(smooth.unjudged)));
  // Noise of half a hundredth of the force, against the motion in some hundred independent stretches.
  EXPECT_NEAR(part / root_mean_square(judged(smooth.measured)), 0.1 / 1.1, 5e-4);
}

TEST(ModelledSegments, UnjudgedEndsEqualTheMeasurement) {
  const Recording recording = made_recording(motion_m, [](double t) { return kMass_kg * acceleration_m_per_s2(t); });
  const auto segments = modelled_segments(mass_only(), recording, 0, 0);
  const Segment& smooth = of_force(segments);
  ASSERT_GT(smooth.unjudged, 3U);
  const std::vector<double> predicted = predict(mass_only(), smooth);
  EXPECT_EQ(predicted.front(), smooth.measured.front());
  EXPECT_EQ(predicted.back(), smooth.measured.back());
  EXPECT_EQ(predicted[smooth.unjudged - 1], smooth.measured[smooth.unjudged - 1]);
  EXPECT_NE(predicted[smooth.unjudged], smooth.measured[smooth.unjudged]);
}

TEST(ModelledSegments, ConverterStepsAreSmoothed) {
  SiteModel coarse = mass_only();
  coarse.effects.push_back({find_effect(EffectInterface::force_sensor, "quantization"), {200.0}});
  const Recording recording = made_recording(
      motion_m, [](double t) { return 200.0 * std::round(kMass_kg * acceleration_m_per_s2(t) / 200.0); }, 0.0);
  const auto segments = modelled_segments(coarse, recording, 0, 0);
  const Segment& smooth = of_force(segments);
  ASSERT_TRUE(smooth.is_smoothed());
  EXPECT_EQ(predict(coarse, smooth), predict(mass_only(), smooth));
  // Of an even error between half a step each way less than half is left.
  EXPECT_LT(residual_n(coarse, smooth), 0.5 * 200.0 / std::sqrt(12.0));
}

/// A force that is cut off has corners, which smoothing makes round.
TEST(SmoothedAlike, CornersOfTheForceAreSmoothedInThePrediction) {
  constexpr double kLimit_n = 3e4;
  const Recording recording = made_recording(
      motion_m, [kLimit_n](double t) { return std::clamp(kMadeStiffness_n_per_m * motion_m(t), -kLimit_n, kLimit_n); },
      0.0);
  SiteModel model = made_model();
  model.effects.push_back({find_effect(EffectInterface::force_sensor, "saturation"), {kLimit_n}});
  Segment smooth = smoothed_alike(of_force(segments_of(recording, 0, 0)), recording.dofs[0], 8.0);
  const double left_n = residual_n(model, smooth);
  // 1 um of noise times the stiffness, of which smoothing leaves a part.
  EXPECT_LT(left_n, 2.0);
  smooth.smoothed_by = 0.0;  // control: a force of the smoothed motion has its corners
  EXPECT_GT(residual_n(model, smooth), 20.0 * left_n);
}

TEST(ChangeBySmoothing, IsWhatNoiseOnTheMotionOfAYieldingLawChanged) {
  SiteModel model = made_model();
  model.make_law = [] {
    return std::make_unique<Bilinear>(Bilinear::Parameters{
        .stiffness_n_per_m = kMadeStiffness_n_per_m, .yield_force_n = 1.6e4, .hardening_ratio = 0.05});
  };
  Recording recording = made_recording(made_motion_m, [](double) { return 0.0; });
  DofRecording& dof = recording.dofs[0];
  dof.of(Channel::measured_force) = predict(model, segments_of(recording, 0, 0).back());
  EXPECT_TRUE(change_by_smoothing(model, segments_of(recording, 0, 0).back()).empty());  // control: no such noise
  const std::vector<double> noise_m = made_noise({.correlation = 0.8}, recording.samples, 1e-4, kSitePeriod_s, 1);
  for (std::size_t i = 0; i < recording.samples; ++i) dof.of(Channel::measured_displacement)[i] += noise_m[i];
  const Segment noisy = segments_of(recording, 0, 0).back();
  std::vector<double> left = change_by_smoothing(model, noisy);
  ASSERT_EQ(left.size(), recording.samples);
  const std::vector<double> predicted = predict(model, noisy);
  for (std::size_t i = 0; i < left.size(); ++i) left[i] += predicted[i] - noisy.measured[i];
  // Of the force that the noise took, no more than a half is left.
  EXPECT_LT(root_mean_square(left), 0.5 * residual_n(model, noisy));
}

std::unique_ptr<Law> steel() {
  return std::make_unique<GiuffreMenegottoPinto>(GiuffreMenegottoPinto::Parameters{
      .stiffness_n_per_m = kMadeStiffness_n_per_m, .yield_force_n = 1.6e4, .hardening_ratio = 0.05});
}

/// A slow motion and a fast one that is hardly faster in between: there the noise turns, far from the peaks.
double grazing_m(double t) {
  const double growth = std::min(1.0, t);
  return growth *
         (0.02 * std::sin(2.0 * std::numbers::pi * 0.3 * t) + 0.0031 * std::sin(2.0 * std::numbers::pi * 1.9 * t));
}

/// The specimen's segment of a specimen of steel that moves so, read with noise.
Segment of_steel(const std::function<double(double)>& moved_m, double noise_m) {
  SiteModel model = made_model();
  model.make_law = steel;
  const std::unique_ptr<Law> specimen = steel();
  Random random{5};
  const Recording recording = made_recording([&](double t) { return moved_m(t) + noise_m * random.normal(); },
                                             [&](double t) {
                                               const double force_n = specimen->trial(moved_m(t), 0.0);
                                               specimen->commit();
                                               return force_n;
                                             });
  return modelled_segments(model, recording, 0, 0).back();
}

/// What steel leaves of the force of a segment, over the force [rms].
double left_by_steel(const Segment& segment) {
  SiteModel model = made_model();
  model.make_law = steel;
  return residual_n(model, segment) / root_mean_square(segment.measured);
}

TEST(ModelledSegments, SteelDoesNotTurnInTheNoise) {
  const Segment segment = of_steel(grazing_m, 2e-5);
  EXPECT_GT(segment.reversal_noise_m, 0.0);
  Segment with_all = segment;
  with_all.reversal_noise_m = 0.0;
  // Noise times the stiffness is 40 N before it is smoothed.
  EXPECT_LT(left_by_steel(segment), 2e-3);
  EXPECT_GT(left_by_steel(with_all), 0.02);
}

/// A simulated specimen has each reversal of its motion, also those that are as small as the noise.
TEST(ModelledSegments, SteelTurnsWhereItIsSeenToTurn) {
  const Segment segment =
      of_steel([](double t) { return grazing_m(t) + 1.5e-5 * std::sin(2.0 * std::numbers::pi * 12.0 * t); }, 1e-5);
  EXPECT_EQ(segment.reversal_noise_m, 0.0);
}

/// What smoothing changes of a right model's force is none of it where its corners are smoothed too.
TEST(ModelledSegments, CornersThatAreSmoothedAreNoErrorOfSmoothing) {
  constexpr double kLimit_n = 3e4;
  constexpr double kDamping_n_s_per_m = 2e4;
  constexpr double kNoise_m = 5e-6;
  Random random{5};
  const Recording recording = made_recording(
      [&](double t) { return made_motion_m(t) + kNoise_m * random.normal(); },
      [kLimit_n](double t) {
        return std::clamp(kMadeStiffness_n_per_m * made_motion_m(t) + kDamping_n_s_per_m * made_velocity_m_per_s(t),
                          -kLimit_n, kLimit_n);
      });
  SiteModel model = made_model();
  model.effects.push_back({find_effect(EffectInterface::specimen, "viscous_damping"), {kDamping_n_s_per_m}});
  model.effects.push_back({find_effect(EffectInterface::force_sensor, "saturation"), {kLimit_n}});
  const Segment smooth = modelled_segments(model, recording, 0, 0).back();
  ASSERT_GT(smooth.smoothed_by, 0.0);
  Segment cornered = smooth;
  cornered.smoothed_by = 0.0;
  std::vector<double> corners_n = predict(model, cornered);
  const std::vector<double> rounded_n = predict(model, smooth);
  for (std::size_t i = 0; i < corners_n.size(); ++i) corners_n[i] -= rounded_n[i];
  // What is left: damping makes the noise that the narrowest window leaves a force, some of which is beyond the limit.
  EXPECT_LT(smooth.smoothing_error, 0.3 * root_mean_square(corners_n));
}

TEST(SegmentsToSearch, MassThatTheModelLacksIsLookedForSmoothed) {
  // A transducer with noise, whose second derivative over windows that suit the displacement is mostly noise.
  Random random{5};
  const Recording recording = made_recording(
      [&](double t) { return motion_m(t) + 2e-4 * random.normal(); },
      [](double t) { return kMadeStiffness_n_per_m * motion_m(t) + 0.1 * kMass_kg * acceleration_m_per_s2(t); });
  const auto segments = segments_to_search(made_model(), recording, 0, 0);
  ASSERT_TRUE(of_force(segments).is_smoothed());
  const FitOutcome fit = fit_effects(make_problem(made_model(), {of_force(segments)}),
                                     {find_effect(EffectInterface::specimen, "inertia")}, false);
  EXPECT_NEAR(fit.effects[0].values[0], 0.1 * kMass_kg, 0.02 * 0.1 * kMass_kg);
}

/// Dry friction explains more of the gap than the mass does.
TEST(SegmentsToSearch, MassBesideDryFrictionIsLookedForSmoothed) {
  constexpr double kFriction_n = 6e3;
  constexpr double kHeld_m = 2e-4;
  const std::vector<double> noise_m = made_noise({.correlation = 0.75}, 6000, 1e-5, kSitePeriod_s, 1);
  double before_m = motion_m(0.0);
  double held_m = 0.0;
  const auto rubs_n = [&](double t) {
    held_m = std::clamp(held_m + motion_m(t) - before_m, -kHeld_m, kHeld_m);
    before_m = motion_m(t);
    return kFriction_n * held_m / kHeld_m;
  };
  const auto measured_m = [&](double t) {
    return motion_m(t) + noise_m[static_cast<std::size_t>(std::llround(t / kSitePeriod_s))];
  };
  const Recording recording = made_recording(measured_m, [&](double t) {
    return kMadeStiffness_n_per_m * motion_m(t) + rubs_n(t) + 0.1 * kMass_kg * acceleration_m_per_s2(t);
  });
  const auto mass_in = [](const Segment& segment) {
    const FitOutcome fit = fit_effects(
        make_problem(made_model(), {segment}),
        {find_effect(EffectInterface::specimen, "coulomb_friction"), find_effect(EffectInterface::specimen, "inertia")},
        false);
    return fit.effects[1].values[0];
  };
  const auto segments = segments_to_search(made_model(), recording, 0, 0);
  ASSERT_TRUE(of_force(segments).is_smoothed());
  // The noise that smoothing leaves hides a twentieth.
  EXPECT_NEAR(mass_in(of_force(segments)), 0.1 * kMass_kg, 0.06 * 0.1 * kMass_kg);
  // Control: the noise of an acceleration that is not smoothed hides more.
  EXPECT_LT(mass_in(of_force(segments_of(recording, 0, 0))), 0.9 * 0.1 * kMass_kg);
}

TEST(SegmentsToSearch, WithoutAMissingMassNothingIsSmoothed) {
  const auto with_friction_n = [](double t) {
    return 2e6 * motion_m(t) + 3e3 * std::tanh((motion_m(t + 1e-4) - motion_m(t - 1e-4)) / 2e-6);
  };
  for (const Recording& recording : {made_recording(motion_m, [](double t) { return 2e6 * motion_m(t); }),
                                     made_recording(
                                         motion_m, [](double t) { return 1.8e6 * motion_m(t); }, 0.0),
                                     made_recording(motion_m, with_friction_n)}) {
    for (const Segment& segment : segments_to_search(made_model(), recording, 0, 0)) {
      EXPECT_EQ(segment.measured, recording.dofs[0].of(segment.to));
    }
  }
}

/// Dry friction that comes up over half a millimetre, in cycles of nearly constant speed: what it lacks behind each
/// reversal is a mass below zero.
TEST(SegmentsToSearch, FrictionIsNoMassBelowZero) {
  constexpr double kFriction_n = 4e3;
  const auto cycle_m = [](double t) {
    return 0.02 * std::asin(0.97 * std::sin(std::numbers::pi * t)) / std::asin(0.97);
  };
  Random random{5};
  double before_m = 0.0;
  double friction_n = 0.0;
  const auto rubs_n = [&](double t) {
    const double way_m = cycle_m(t) - before_m;
    before_m += way_m;
    const double limit_n = std::copysign(kFriction_n, way_m);
    friction_n = limit_n + (friction_n - limit_n) * std::exp(-std::abs(way_m) / 5e-4);
    return kMadeStiffness_n_per_m * cycle_m(t) + friction_n;
  };
  const Recording recording = made_recording([&](double t) { return cycle_m(t) + 1e-5 * random.normal(); }, rubs_n);
  EXPECT_FALSE(of_force(segments_to_search(made_model(), recording, 0, 0)).is_smoothed());
}

TEST(ModelledSegments, SpringIsJudgedByTheRecordedForce) {
  const Recording recording = made_recording(motion_m, [](double t) { return 2e6 * motion_m(t); });
  for (const Segment& segment : modelled_segments(made_model(), recording, 0, 0)) {
    EXPECT_EQ(segment.measured, recording.dofs[0].of(segment.to));
    EXPECT_EQ(segment.unjudged, 0U);
  }
  EXPECT_EQ(modelled_segments(mass_only(), recording, 0, 0).size(), 2U);
}

}  // namespace
}  // namespace hybridtest
