#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <span>
#include <vector>

#include "diagnosis/identification/effect_fit.hpp"
#include "diagnosis/identification/problem.hpp"
#include "diagnosis/identification/search.hpp"
#include "diagnosis/verdict/shrink.hpp"
#include "diagnosis/verdict/told_noise.hpp"
#include "tests/unit/diagnosis/made_noise.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

/// The noise of a measured displacement goes through everything that a candidate makes of the motion: a damping makes
/// more of it, a lag takes it away. What is left of a gap is compared without that; OpenedCase has answers.
namespace hybridtest {
namespace {

constexpr double kForceNoise_n = 2.0;

/// Of a transducer whose noise is much more force, times the stiffness, than the load cell's own.
Recording with_noisy_motion(double noise_m, const std::function<double(double)>& force_n) {
  Random random{9};
  return made_recording([&](double t) { return made_motion_m(t) + noise_m * random.normal(); }, force_n, kForceNoise_n);
}

FitSegment of_force(const IdentificationProblem& problem) { return problem.segments.back(); }

TEST(NoiseOfInput, IsThatOfDisplacementTimesStiffnessAndOfVelocityTimesDamping) {
  constexpr double kDamping_n_s_per_m = 1.0e5;
  const Recording recording =
      with_noisy_motion(2e-5, [](double t) { return kMadeStiffness_n_per_m * made_motion_m(t); });
  const auto problem = make_problem(made_model(), segments_of(recording, 0, 0));
  const FitSegment fit = of_force(problem);
  const EffectSetting damping{.type = find_effect(EffectInterface::specimen, ModelNumber::damping),
                              .values = {kDamping_n_s_per_m}};
  const auto made_of = [&](double damping_n_s_per_m) {
    std::vector<double> noise;
    for (const Motion& motion : fit.segment.noise) {
      noise.push_back(kMadeStiffness_n_per_m * motion.displacement_m + damping_n_s_per_m * motion.velocity_m_per_s);
    }
    return fit.average(noise).squaredNorm() / static_cast<double>(fit.measured.size());
  };
  EXPECT_NEAR(fit.noise_of_input, made_of(0.0), 1e-9 * made_of(0.0));
  EXPECT_NEAR(noise_of_input(problem, fit, std::span{&damping, 1}), made_of(kDamping_n_s_per_m),
              1e-9 * made_of(kDamping_n_s_per_m));
  EXPECT_GT(made_of(kDamping_n_s_per_m), 2.0 * made_of(0.0));
}

/// A spring ten times too stiff makes ten times as much of the noise, and a specimen does not.
TEST(NoiseOfInput, FloorIsThatOfASpringAsStiffAsTheRecordingShows) {
  const Recording recording =
      with_noisy_motion(2e-5, [](double t) { return kMadeStiffness_n_per_m * made_motion_m(t); });
  const auto fit_with = [&](double ratio) {
    SiteModel model = made_model();
    model.make_law = [ratio] { return std::make_unique<Elastic>(ratio * kMadeStiffness_n_per_m); };
    return of_force(make_problem(model, segments_of(recording, 0, 0)));
  };
  const FitSegment right = fit_with(1.0);
  for (const double ratio : {0.1, 10.0}) {
    const FitSegment far = fit_with(ratio);
    // The slope of force on a noisy displacement is known to some parts in a million.
    EXPECT_NEAR(far.channels.of_means, right.channels.of_means, 1e-4 * right.channels.of_means) << ratio;
    EXPECT_NEAR(far.channels.per_sample, right.channels.per_sample, 1e-4 * right.channels.per_sample) << ratio;
    // Control: what the model itself makes of the noise.
    EXPECT_NEAR(far.noise_of_input, ratio * ratio * right.noise_of_input, 1e-9 * far.noise_of_input) << ratio;
  }
}

/// The friction of the model makes a hundred times as much of the noise as the spring, and is not there.
TEST(NoiseOfInput, FinalFloorIsThatBesideWhatTakesThePlaceOfAnElement) {
  const Recording recording =
      with_noisy_motion(1e-6, [](double t) { return kMadeStiffness_n_per_m * made_motion_m(t); });
  SiteModel model = made_model();
  EffectSetting friction = absent(*find_effect(EffectInterface::specimen, "coulomb_friction"));
  friction.values.front() = 2.0e3;
  model.effects.push_back(friction);
  IdentificationProblem problem = make_problem(model, segments_of(recording, 0, 0));
  friction.values.front() = 0.0;
  const FitOutcome gone = refit_effects(problem, {friction}, false);
  settle_noise(problem, gone);
  const double beside_model_n = of_force(problem).channels.of_means;
  settle_final_noise(problem, gone);
  // Of the spring alone: 2 N of the displacement and 2 N of the load cell.
  const double right_n = of_force(make_problem(made_model(), segments_of(recording, 0, 0))).channels.of_means;
  EXPECT_GT(beside_model_n, 3.0 * right_n) << "control";
  EXPECT_NEAR(of_force(problem).floor, right_n, 0.1 * right_n);
}

TEST(NoiseOfInput, IsLessBehindALag) {
  const Recording recording =
      with_noisy_motion(2e-5, [](double t) { return kMadeStiffness_n_per_m * made_motion_m(t); });
  const auto problem = make_problem(made_model(), segments_of(recording, 0, 0));
  const FitSegment fit = of_force(problem);
  const EffectSetting lag{.type = find_effect(EffectInterface::force_sensor, "lag"), .values = {0.1, 0.0}};
  EXPECT_LT(noise_of_input(problem, fit, std::span{&lag, 1}), 0.5 * fit.noise_of_input);
}

TEST(NoiseOfInput, OfAnExactInputIsNone) {
  const Recording recording =
      made_recording(made_motion_m, [](double t) { return kMadeStiffness_n_per_m * made_motion_m(t); });
  const auto problem = make_problem(made_model(), segments_of(recording, 0, 0));
  const EffectSetting delay{.type = find_effect(EffectInterface::transfer_system, ModelNumber::delay),
                            .values = {0.01}};
  EXPECT_EQ(problem.segments.front().noise_of_input, 0.0);
  EXPECT_EQ(noise_of_input(problem, problem.segments.front(), std::span{&delay, 1}), 0.0);
}

/// A stiffness that is lost within half a cycle and given back by a free number would make four times the noise.
TEST(NoiseOfInput, IsNotAskedOfWhatDegrades) {
  const Recording recording =
      with_noisy_motion(2e-5, [](double t) { return kMadeStiffness_n_per_m * made_motion_m(t); });
  const auto problem = make_problem(made_model(), segments_of(recording, 0, 0));
  const auto more_noise_of = [&](const EffectType* type) {
    return fit_effects(problem, {type}, true).segments.back().more_noise;
  };
  EXPECT_EQ(more_noise_of(find_effect(EffectInterface::specimen, "stiffness_degradation_with_cycles")), 0.0);
  EXPECT_NE(more_noise_of(find_effect(EffectInterface::specimen, "cubic_stiffness")), 0.0);  // control
}

/// With less left than the noise would be, the noise is in proportion.
TEST(NoiseOfInput, IsTakenOffWhatIsLeft) {
  FitSegment fit;
  fit.measured = Eigen::VectorXd::Zero(10);
  fit.noise_of_input = 1.0;
  SegmentResult result;
  result.held_out_squares = {20.0, 30.0};  // a mean square of 5
  const auto left_with = [&](double more_noise) {
    result.more_noise = more_noise;
    return result.left(fit);
  };
  EXPECT_DOUBLE_EQ(left_with(0.0), 5.0);
  EXPECT_DOUBLE_EQ(left_with(3.0), 2.0);
  EXPECT_DOUBLE_EQ(left_with(-0.5), 5.5);
  EXPECT_DOUBLE_EQ(left_with(4.0), 1.0);
  EXPECT_DOUBLE_EQ(left_with(9.0),
                   0.5);  // 5 are left where the noise would be 10: half of it, and the model's own stays
}

/// Of a spring and a damper, whose motion is read with this noise [m], one value per sample.
Recording with_slow_noise(const std::vector<double>& noise_m, double damping_n_s_per_m) {
  return made_recording(
      [&](double t) { return made_motion_m(t) + noise_m[static_cast<std::size_t>(std::llround(t / kSitePeriod_s))]; },
      [&](double t) {
        return kMadeStiffness_n_per_m * made_motion_m(t) + damping_n_s_per_m * made_velocity_m_per_s(t);
      },
      kForceNoise_n);
}

TEST(NoiseOfInput, ColouredNoiseIsTakenOffWhereItIsTold) {
  const std::vector<double> noise = made_noise({0.95, 0.0}, 6000, 1e-4, kSitePeriod_s, 1);
  constexpr double kDamping_n_s_per_m = 5.0e4;
  const Recording recording = with_slow_noise(noise, kDamping_n_s_per_m);
  std::vector<Segment> segments = segments_of(recording, 0, 0);
  const EffectType* const damping = find_effect(EffectInterface::specimen, ModelNumber::damping);
  const auto left_of_noise = [&] {
    const auto problem = make_problem(made_model(), segments);
    const FitSegment fit = of_force(problem);
    const double of_spring = std::pow(kMadeStiffness_n_per_m, 2) * fit.average(noise).squaredNorm() /
                             static_cast<double>(fit.measured.size());
    return fit_effects(problem, {damping}, true).segments.back().left(fit) / of_spring;
  };
  EXPECT_GT(left_of_noise(), 4.0);  // control: of white noise of that level
  segments.back().told_noise = motion_of_readings(segments.back(), noise);
  // The damping is fitted to a motion with noise, and comes out a little too small.
  EXPECT_NEAR(left_of_noise(), 1.0, 0.1);
}

/// A spring and a damper as modelled, with slow noise of the motion: without it the floor is of white noise alone.
TEST(NoiseOfInput, FloorHasTheNoiseThatIsTold) {
  const std::vector<double> noise = made_noise({0.7, 0.0}, 6000, 5e-5, kSitePeriod_s, 1);
  constexpr double kDamping_n_s_per_m = 5.0e4;
  const Recording recording = with_slow_noise(noise, kDamping_n_s_per_m);
  SiteModel model = made_model();
  add_effect(model,
             {.type = find_effect(EffectInterface::specimen, ModelNumber::damping), .values = {kDamping_n_s_per_m}});
  std::vector<Segment> segments = segments_of(recording, 0, 0);
  const auto force = [&] { return of_force(make_problem(model, segments)); };
  const FitSegment untold = force();
  const double left_n =
      (untold.measured - untold.baseline).norm() / std::sqrt(static_cast<double>(untold.measured.size()));
  EXPECT_LT(untold.channels.of_means, 0.8 * left_n);  // control
  segments.back().told_noise = motion_of_readings(segments.back(), noise);
  // Beside it the load cell has noise of a hundredth.
  EXPECT_NEAR(force().channels.of_means, left_n, 0.02 * left_n);
}

/// Noise adds cycles, by which the specimen would lose its stiffness.
TEST(NoiseOfInput, CyclesThatItAddsAreNoFloor) {
  const std::vector<double> noise = made_noise({0.7, 0.0}, 6000, 1e-4, kSitePeriod_s, 1);
  const Recording recording = with_slow_noise(noise, 0.0);
  std::vector<Segment> segments = segments_of(recording, 0, 0);
  segments.back().told_noise = motion_of_readings(segments.back(), noise);
  const EffectSetting fading{find_effect(EffectInterface::specimen, "stiffness_degradation_with_cycles"), {50.0, 0.0}};
  const double floor =
      shrink_on(made_model(), {&fading, 1}, std::span<const Segment>{segments}.last(1), 1, {}).floor_nrmse;
  const double of_motion =
      std::sqrt(mean_square(noise) / mean_square(recording.dofs[0].of(Channel::measured_displacement)));
  // The specimen is a spring: noise over motion. The window over the readings leaves a little less of the noise.
  EXPECT_NEAR(floor, of_motion, 0.15 * of_motion);
}

TEST(NoiseOfInput, ErrorOfReadingsBecomesMotionAsTheReadingsDo) {
  const Recording recording =
      with_noisy_motion(2e-5, [](double t) { return kMadeStiffness_n_per_m * made_motion_m(t); });
  const DofRecording& dof = recording.dofs[0];
  const std::vector<double>& readings = dof.of(Channel::measured_displacement);
  const Segment plain = segments_of(recording, 0, 0).back();
  for (const Segment& segment : {plain, smoothed_alike(plain, dof, 5.0)}) {
    const std::vector<Motion> motion = motion_of_readings(segment, readings);
    ASSERT_EQ(motion.size(), segment.input.size());
    for (std::size_t i = 0; i < motion.size(); ++i) {
      ASSERT_EQ(motion[i].displacement_m, segment.input[i].displacement_m);
      ASSERT_EQ(motion[i].velocity_m_per_s, segment.input[i].velocity_m_per_s);
      ASSERT_EQ(motion[i].acceleration_m_per_s2, segment.input[i].acceleration_m_per_s2);
    }
  }
}

TEST(ToldNoise, IsWhatAnExplainedActuatorLeavesAndNothingElse) {
  const std::vector<double> noise = made_noise({0.95, 0.0}, 6000, 1e-4, kSitePeriod_s, 1);
  const Recording recording = with_slow_noise(noise, 0.0);
  SiteModel model = made_model();
  const auto told_by = [&](Channel channel) {
    std::vector<Segment> segments = segments_of(recording, 0, 0);
    IdentificationProblem problem = judged_at(make_problem(model, segments), channel);
    settle_noise(problem, fit_nothing(problem, false));
    const bool is_told = tell_noise(problem, fit_nothing(problem, false), model, segments);
    EXPECT_EQ(is_told, !segments.back().told_noise.empty());
    return segments.back();
  };
  const auto size_m = [](const std::vector<Motion>& motion) {
    double squares = 0.0;
    for (const Motion& one : motion) squares += one.displacement_m * one.displacement_m;
    return std::sqrt(squares / static_cast<double>(motion.size()));
  };
  const Segment told = told_by(Channel::measured_displacement);
  // The floor, which it is brought to, is that of the noise within a tenth.
  EXPECT_NEAR(size_m(told.told_noise), size_m(motion_of_readings(told, noise)), 0.1 * size_m(told.told_noise));
  EXPECT_TRUE(told_by(Channel::measured_force).told_noise.empty()) << "the actuator was not asked about there";
  model.effects.push_back({find_effect(EffectInterface::transfer_system, "gain"), {0.1}});
  EXPECT_TRUE(told_by(Channel::measured_displacement).told_noise.empty()) << "what is left is no noise";
}

}  // namespace
}  // namespace hybridtest
