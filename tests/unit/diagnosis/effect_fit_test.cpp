#include "diagnosis/identification/effect_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/tuning.hpp"
#include "diagnosis/verdict/held_out_loss.hpp"
#include "diagnosis/verdict/library_fits.hpp"
#include "mechanics/laws/bouc_wen.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

namespace hybridtest {
namespace {

using enum EffectInterface;

double spring_n(double time_s) { return kMadeStiffness_n_per_m * made_motion_m(time_s); }

IdentificationProblem problem_of(const Recording& recording) {
  return make_problem(made_model(), segments_of(recording, 0, 0));
}

TEST(FitEffects, FindsActuatorDelay) {
  const double delay_s = 0.0137;
  const auto measured_m = [&](double t) { return t > delay_s ? made_motion_m(t - delay_s) : 0.0; };
  const auto problem =
      problem_of(made_recording(measured_m, [&](double t) { return kMadeStiffness_n_per_m * measured_m(t); }));
  const FitOutcome fit = fit_effects(problem, {find_effect(transfer_system, "delay")}, false);
  // Noise of 1e-6 m on a velocity of 0.1 m/s, 6000 times: 1e-7 s; the line interpolates between samples of 2 ms.
  EXPECT_NEAR(fit.effects[0].values[0], delay_s, 2e-5);
  EXPECT_FALSE(fit.parameters[0][0].at_bound);
}

TEST(FitEffects, FindsDryFriction) {
  const auto friction_n = [](double t) {
    const double velocity = made_motion_m(t + 1e-4) - made_motion_m(t - 1e-4);
    return velocity == 0.0 ? 0.0 : std::copysign(3000.0, velocity);
  };
  const auto problem = problem_of(made_recording(made_motion_m, [&](double t) { return spring_n(t) + friction_n(t); }));
  const FitOutcome fit = fit_effects(problem, {find_effect(specimen, "coulomb_friction")}, false);
  // The pre-sliding element turns over a way instead of at once, and averaging over four samples rounds the sign:
  // a sample or two of about sixty between reversals.
  EXPECT_NEAR(fit.effects[0].values[0], 3000.0, 0.02 * 3000.0);
}

TEST(FitEffects, NarrowValleyIsFoundBesideAnOptionalParameter) {
  // A play of a hundredth of the stroke, beside a law that yields.
  for (const double clearance_m : {1.7e-4, 2.5e-4, 3.7e-4, 5.3e-4, 8.1e-4}) {
    SiteModel model = made_model();
    model.make_law = [] {
      return std::make_unique<BoucWen>(BoucWen::Parameters{
          .stiffness_n_per_m = 1e4, .alpha = 0.25, .n = 1.0, .gamma_per_m = 60.0, .beta_per_m = 170.0});
    };
    SiteModel real = model;
    real.effects.push_back({find_effect(specimen, "backlash"), {clearance_m, 1.0}});
    Recording recording = made_recording(
        made_motion_m, [](double) { return 0.0; }, 0.01);
    recording.dofs[0].of(Channel::measured_force) = predict(real, segments_of(recording, 0, 0).back());
    const auto problem = make_problem(model, segments_of(recording, 0, 0));
    const FitOutcome fit = fit_effects(problem, {find_effect(specimen, "backlash")}, false);
    EXPECT_NEAR(fit.effects[0].values[0], clearance_m, 0.01 * clearance_m);
  }
}

TEST(FitEffects, KeepsParameterInItsRange) {
  const auto problem = problem_of(made_recording(made_motion_m, [](double t) {
    const double velocity = made_motion_m(t + 1e-4) - made_motion_m(t - 1e-4);
    return spring_n(t) - (velocity == 0.0 ? 0.0 : std::copysign(3000.0, velocity));
  }));
  const FitOutcome fit = fit_effects(problem, {find_effect(specimen, "coulomb_friction")}, false);
  EXPECT_EQ(fit.effects[0].values[0], 0.0);  // friction that pushes is none
  EXPECT_TRUE(fit.parameters[0][0].at_bound);
}

/// However long the noise remembers.
TEST(HeldOutScore, EachBlockThatIsLeftOutCountsForOneSample) {
  IdentificationProblem problem = problem_of(made_recording(made_motion_m, [](double t) { return 1.2 * spring_n(t); }));
  FitSegment& fit = problem.segments.back();
  fit.independent = 1.0;
  const FitOutcome found = fit_effects(problem, {find_effect(specimen, ModelNumber::stiffness)}, false);
  const FitOutcome nothing = fit_nothing(problem, false);
  const auto allowed = [&](const FitOutcome& outcome) {
    return outcome.segments.back().left(fit) + 1.0 / (fit.weight * fit.weight);
  };
  // Of 12 s, each with a cycle of 0.9 Hz.
  EXPECT_EQ(fit.block_begins.size(), 12U);
  EXPECT_NEAR(held_out_score(problem, found) - held_out_score(problem, nothing),
              0.5 * 11.0 * std::log(allowed(nothing) / allowed(found)), 1e-6);
  fit.independent = 100.0;
  EXPECT_NEAR(held_out_score(problem, found) - held_out_score(problem, nothing),
              0.5 * 100.0 * std::log(allowed(nothing) / allowed(found)), 1e-6);
}

/// A rival that leaves more by the same factor everywhere is worse for certain, however large the factor. One that is
/// better in half of the blocks and worse in the others, by as much, is neither. By hand: of n samples, in B blocks
/// with squares r and c, n / 2 times the sum of r / (sum of r) - c / (sum of c), and its standard deviation between
/// blocks.
TEST(HeldOutLoss, StandardErrorIsThatOfTheLogarithm) {
  IdentificationProblem problem = problem_of(made_recording(made_motion_m, [](double t) { return 1.2 * spring_n(t); }));
  for (FitSegment& fit : problem.segments) fit.is_suspect = fit.segment.to == Channel::measured_force;
  FitSegment& force = problem.segments.back();
  force.independent = 100.0;
  force.weight = 1e9;  // nothing is allowed beside
  const FitOutcome nothing = fit_nothing(problem, false);
  const auto leaving = [&](std::vector<double> squares) {
    FitOutcome outcome = nothing;
    outcome.segments.back().held_out_squares = std::move(squares);
    return outcome;
  };
  const FitOutcome even = leaving({1e6, 1e6, 1e6, 1e6});
  const Loss certain = loss_by(problem, leaving({9e6, 9e6, 9e6, 9e6}), even);
  EXPECT_NEAR(certain.nats, 0.5 * 100.0 * std::log(9.0), 1e-6);
  EXPECT_NEAR(certain.standard_error, 0.0, 1e-6);
  EXPECT_TRUE(certain.is_certain());
  const Loss neither = loss_by(problem, leaving({1.5e6, 0.5e6, 1.5e6, 0.5e6}), even);
  EXPECT_NEAR(neither.nats, 0.0, 1e-6);
  EXPECT_NEAR(neither.standard_error, 50.0 * std::sqrt(4.0 / 3.0 * 4.0) * 0.125, 1e-6);
  EXPECT_FALSE(neither.is_certain());
  // What one block alone has more, in units of what the others have, is as uncertain as it is large, but its logarithm
  // is less.
  const Loss in_one = loss_by(problem, leaving({1e6, 1e6, 1e6, 97e6}), even);
  EXPECT_NEAR(in_one.standard_error_of_squares, 50.0 * 24.0, 1e-3);
  EXPECT_NEAR(in_one.standard_error, 50.0 * 0.96, 1e-3);
}

/// As few as there are blocks of 12 s, or of white noise all: half their logarithm, at most what thirty seconds cost.
TEST(HeldOutScore, ParameterCostsHalfTheLogarithmOfTheSamples) {
  IdentificationProblem problem = problem_of(made_recording(made_motion_m, [](double t) { return 1.2 * spring_n(t); }));
  for (FitSegment& fit : problem.segments) fit.is_suspect = fit.segment.to == Channel::measured_force;
  FitSegment& force = problem.segments.back();
  force.independent = 1.0;
  EXPECT_DOUBLE_EQ(parameter_cost(problem), 0.5 * std::log(11.0)) << "each block counts for one";
  force.independent = 60.0;
  EXPECT_DOUBLE_EQ(parameter_cost(problem), 0.5 * std::log(60.0));
  force.independent = 1e4;
  EXPECT_DOUBLE_EQ(parameter_cost(problem), tuning::kParameterPrior);
}

TEST(FitEffects, RemovesAtMostTheExistingAmount) {
  const EffectType* const damping = find_effect(specimen, "viscous_damping");
  const auto found = [&](double real_n_s_per_m, double known_n_s_per_m) {
    SiteModel model = made_model();
    model.effects.push_back({damping, {known_n_s_per_m}});
    const Recording recording = made_recording(made_motion_m, [&](double t) {
      return spring_n(t) + real_n_s_per_m * (made_motion_m(t + 1e-4) - made_motion_m(t - 1e-4)) / 2e-4;
    });
    return fit_effects(make_problem(model, segments_of(recording, 0, 0)), {damping}, false).effects[0].values[0];
  };
  EXPECT_NEAR(found(-5.0e3, 3.0e3), -3.0e3, 1e-9);
  EXPECT_EQ(found(-5.0e3, 0.0), 0.0);
  // Control: what is there is taken off. 20 N of noise on a velocity of 0.1 m/s, 6000 times: 3 N s/m; and the smoothing
  // of the velocity.
  EXPECT_NEAR(found(5.0e3, 8.0e3), -3.0e3, 15.0);
}

TEST(FitEffects, SolvesNonlinearEffectsJointly) {
  const double gain = 0.2;
  const double damping_n_s_per_m = 4.0e4;
  const auto problem = problem_of(made_recording(made_motion_m, [&](double t) {
    const double velocity_m_per_s = (made_motion_m(t + 1e-4) - made_motion_m(t - 1e-4)) / 2e-4;
    return (1.0 + gain) * (spring_n(t) + damping_n_s_per_m * velocity_m_per_s);
  }));
  const FitOutcome fit =
      fit_effects(problem, {find_effect(specimen, "viscous_damping"), find_effect(force_sensor, "gain")}, false);
  // Each alone is linear; taken to be so together they give a damping that has the gain in it twice, 20 % too much.
  // What is left is the smoothing of a velocity of 2.3 Hz over neighbouring samples, and 20 N of noise on 10 kN.
  EXPECT_NEAR(fit.effects[0].values[0], damping_n_s_per_m, 2e-3 * damping_n_s_per_m);
  EXPECT_NEAR(fit.effects[1].values[0], gain, 1e-3);
}

/// Of two recordings of a load cell that is late, the second is one block: what it leaves when it is left out, as a
/// multiple of what it leaves of a fit that never saw it; and likewise when it is fitted.
struct LeftOfBlock {
  double left_out = 0.0;
  double fitted = 0.0;
};

LeftOfBlock left_of_block(double late_s, double later_s) {
  const auto late_segment = [](double by_s, std::uint64_t seed) {
    const auto force_n = [by_s](double t) { return t > by_s ? spring_n(t - by_s) : 0.0; };
    return segments_of(made_recording(made_motion_m, force_n, 20.0, seed), 0, 0).back();
  };
  const std::vector<Segment> segments{late_segment(late_s, 3), late_segment(later_s, 4)};
  IdentificationProblem both = make_problem(made_model(), segments);
  FitSegment& block = both.segments.back();
  block.block_begins = {0, block.measured.size()};
  const std::vector<const EffectType*> effects{find_effect(force_sensor, "lag")};
  const FitOutcome fit = fit_effects(both, effects, false);
  const FitOutcome without = fit_effects(make_problem(made_model(), {segments.front()}), effects, false);
  const auto left_by = [&](const FitOutcome& outcome) {
    return (block.measured - predict(both, block, outcome.effects)).squaredNorm();
  };
  return {.left_out = fit.segments.back().held_out_squares[0] / left_by(without),
          .fitted = left_by(fit) / left_by(without)};
}

TEST(FitEffects, BlockThatIsLeftOutLeavesWhatAFitWithoutItLeaves) {
  // The block is half of all data. Without it the time constant is a ninth less, then three sevenths less: one step
  // with the slopes of the fit to all is off by a hundredth and by a twelfth of what is left.
  const LeftOfBlock slightly = left_of_block(0.008, 0.010);
  EXPECT_NEAR(slightly.left_out, 1.0, 1e-3);
  EXPECT_LT(slightly.fitted, 0.5);  // control: what it leaves when it is fitted is no measure of it
  const LeftOfBlock much = left_of_block(0.02, 0.05);
  // A search ends where a step gains less than 1e-5 of what is left: the time constant is known to a third of a
  // percent, and the block's part of what is left to two percent.
  EXPECT_NEAR(much.left_out, 1.0, 0.02);
  EXPECT_LT(much.fitted, 0.5);
}

/// Cycles of growing amplitude: late instants weigh more than early ones.
TEST(FitEffects, FindsTimeOfFracture) {
  const double lost = 0.3;
  const double instant_s = 8.371;
  const auto growing_m = [](double t) { return 0.002 * t * std::sin(2.0 * std::numbers::pi * 1.1 * t); };
  const auto problem = problem_of(made_recording(
      growing_m, [&](double t) { return (t < instant_s ? 1.0 : 1.0 - lost) * kMadeStiffness_n_per_m * growing_m(t); }));
  const FitOutcome fit = fit_effects(problem, {find_effect(specimen, "fracture")}, false);
  EXPECT_NEAR(fit.effects[0].values[0], lost, 1e-3);  // 20 N of noise on 30 kN, 250 times a second
  // It breaks over one sample, and what is compared are means of two.
  EXPECT_NEAR(fit.effects[0].values[1], instant_s, 2.0 * kSitePeriod_s);
  // One block alone tells it: its interval is as long as a few samples, and holds it.
  EXPECT_LT(half_interval_95(fit.parameters[0][1]), 0.05);
  EXPECT_LT(std::abs(fit.effects[0].values[1] - instant_s), half_interval_95(fit.parameters[0][1]) + kSitePeriod_s);
  // The block in which it breaks is not thought to have broken at any other time.
  const FitSegment& segment = problem.segments.back();
  EXPECT_LT(fit.segments.back().held_out_mean_square(segment),
            0.01 * fit_nothing(problem, false).segments.back().held_out_mean_square(segment));
}

/// A drift [m/s] of micrometres beside a force whose numbers are as large in newtons: as sure as straight lines through
/// the same noise are.
TEST(FitEffects, IntervalsDoNotSufferFromUnits) {
  const double drift_m_per_s = 2e-6;
  const auto drifting_m = [&](double t) { return made_motion_m(t) + drift_m_per_s * t; };
  const auto problem = problem_of(made_recording(drifting_m, spring_n));
  for (const std::vector<const EffectType*>& beside :
       {std::vector<const EffectType*>{}, {find_effect(specimen, "fracture")}}) {
    std::vector<const EffectType*> effects{find_effect(displacement_sensor, "drift"),
                                           find_effect(displacement_sensor, "bias")};
    effects.insert(effects.end(), beside.begin(), beside.end());
    const FitOutcome fit = fit_effects(problem, effects, true);
    EXPECT_LT(std::abs(fit.effects[0].values[0] - drift_m_per_s), half_interval_95(fit.parameters[0][0]));
    EXPECT_LT(half_interval_95(fit.parameters[0][0]), 0.2 * drift_m_per_s);
  }
}

/// Noise that is loud while the specimen moves far and quiet else: of one level it would be thought to be where it
/// hardly hurts as well.
TEST(FitEffects, IntervalsReflectNoiseDistribution) {
  Random random{9};
  const auto motion_m = [](double t) { return std::fmod(t, 4.0) < 1.0 ? 5.0 * made_motion_m(t) : made_motion_m(t); };
  const auto level_n = [](double t) { return std::fmod(t, 4.0) < 1.0 ? 8000.0 : 0.0; };
  const auto problem = problem_of(made_recording(
      motion_m, [&](double t) { return kMadeStiffness_n_per_m * motion_m(t) + level_n(t) * random.normal(); }));
  const FitOutcome fit = fit_effects(problem, {find_effect(specimen, "stiffness_error")}, false);
  double squares = 0.0;
  double loud = 0.0;
  const FitSegment& segment = problem.segments.back();
  for (std::size_t i = 0; i < segment.segment.input.size(); ++i) {
    const double level = level_n(kSitePeriod_s * static_cast<double>(i));
    const double x = segment.segment.input[i].displacement_m;
    squares += x * x;
    loud += x * x * level * level;
  }
  const double expected = std::sqrt(loud) / squares;  // of least squares, sample by sample
  // Three loud seconds lie in about six blocks: a deviation from six is known to 1 / sqrt(12).
  EXPECT_NEAR(fit.parameters[0][1].standard_error, expected, 0.3 * expected);
  // Control: white noise of one level and as much energy would have left less than two thirds of it.
  double energy = 0.0;
  for (std::size_t i = 0; i < segment.segment.input.size(); ++i) {
    energy += std::pow(level_n(kSitePeriod_s * static_cast<double>(i)), 2);
  }
  EXPECT_LT(std::sqrt(energy / static_cast<double>(segment.segment.input.size()) / squares), 0.67 * expected);
}

TEST(FitEffects, HeldOutBlocksAreNotFitted) {
  const auto problem = problem_of(made_recording(
      made_motion_m, [](double t) { return spring_n(t) + 500.0 * std::sin(3.0 * t); }, 200.0));
  const FitOutcome fit = fit_effects(problem, {find_effect(specimen, "cubic_stiffness")}, false);
  const FitSegment& segment = problem.segments.back();
  const Eigen::VectorXd residual = segment.measured - segment.baseline;
  std::vector<double> cubes;
  for (const Motion& motion : segment.segment.input) cubes.push_back(std::pow(motion.displacement_m, 3));
  const Eigen::VectorXd cubed = segment.average(cubes);
  for (std::size_t b = 0; b + 1 < segment.block_begins.size(); ++b) {
    const Eigen::Index first = segment.block_begins[b];
    const Eigen::Index size = segment.block_begins[b + 1] - first;
    const auto x = cubed.segment(first, size);
    const auto r = residual.segment(first, size);
    const double stiffness = (cubed.dot(residual) - x.dot(r)) / (cubed.squaredNorm() - x.squaredNorm());
    const double squares = (r - stiffness * x).squaredNorm();
    // The ridges of 1e-9 that keep singular fits finite.
    EXPECT_NEAR(fit.segments.back().held_out_squares[b], squares, 1e-6 * squares) << b;
    EXPECT_GT(squares, 0.0);
  }
}

/// A stop that one pulse alone reaches, behind a gain and a delay: the command, and what follows it.
Recording stopped_once(double stop_m) {
  const auto demand_m = [](double t) {
    return 0.01 * std::sin(2.0 * std::numbers::pi * 0.9 * t) * (1.0 + 2.0 * std::exp(-std::pow(t - 6.4, 2)));
  };
  const auto measured_m = [&](double t) { return std::clamp(0.97 * demand_m(t - 0.0037), -stop_m, stop_m); };
  Recording recording = made_recording(measured_m, [](double) { return 0.0; });
  std::vector<double>& command = recording.dofs[0].of(Channel::command_displacement);
  for (std::size_t i = 0; i < command.size(); ++i) command[i] = demand_m(kSitePeriod_s * static_cast<double>(i));
  return recording;
}

TEST(FitEffects, LimitThatOneBlockAloneTellsStaysWhenThatIsLeftOut) {
  // Without the pulse the stop may be anywhere above the rest of the motion, and nothing there moves it, though a
  // search does not end in the optimum to the last digit. With one of gain and delay missing, the other blocks pull at
  // what is fitted.
  for (const double stop_m : {0.0251, 0.0263, 0.0271}) {
    for (const char* const beside : {"gain", "delay"}) {
      const auto problem = make_problem(made_model(), {segments_of(stopped_once(stop_m), 0, 0).front()});
      const FitOutcome fit = fit_effects(
          problem, {find_effect(transfer_system, "stroke_limit"), find_effect(transfer_system, beside)}, false);
      const FitOutcome other = fit_effects(problem, {find_effect(transfer_system, beside)}, false);
      const SegmentResult& result = fit.segments[0];
      // What the other parameter loses by a block of twelve.
      EXPECT_NEAR(result.held_out_mean_square(problem.segments[0]) / result.mean_square, 1.0, 0.01)
          << stop_m << ' ' << beside;
      EXPECT_LT(result.mean_square, 0.95 * other.segments[0].mean_square) << "control: the stop matters";
    }
  }
}

TEST(FitEffects, RandomStretchesAreNotDetected) {
  const auto problem = problem_of(made_recording(made_motion_m, spring_n));
  const FitOutcome nothing = fit_nothing(problem, false);
  for (const char* name : {"stiffness_error", "viscous_damping", "cubic_stiffness", "coulomb_friction"}) {
    const FitOutcome fit = fit_effects(problem, {find_effect(specimen, name)}, false);
    const FitSegment& segment = problem.segments.back();
    // Held out, a parameter that noise has drawn makes the residual larger by about 1 / N, not smaller.
    EXPECT_GT(fit.segments.back().held_out_mean_square(segment),
              0.995 * nothing.segments.back().held_out_mean_square(segment))
        << name;
  }
}

/// A step of the search needs the prediction where it goes, and one more per searched parameter for the slopes there.
TEST(FitEffects, PredictsOncePerPointAndSlope) {
  // Neither effect is the other's: the cost is uneven and the search makes all of its steps.
  double follows_m = 0.0;
  const Recording recording = made_recording(
      [&](double t) { return follows_m = std::clamp(follows_m, made_motion_m(t) - 0.002, made_motion_m(t) + 0.002); },
      spring_n);
  std::size_t predictions = 0;
  SiteModel model = made_model();
  model.make_transfer_system = [&](double, double) {
    ++predictions;
    return std::make_unique<Ideal>();
  };
  const auto problem = make_problem(model, segments_of(recording, 0, 0));
  predictions = 0;
  const FitOutcome fit = fit_effects(problem, {find_effect(transfer_system, "stiction")}, false);
  constexpr std::size_t kSearched = 2;
  constexpr std::size_t kSteps = 3 * tuning::kStepsPerParameter.front();  // as for three parameters
  // The last terms: the start and the end of each refinement; the solution, and its slopes for the intervals.
  EXPECT_LE(predictions,
            tuning::kStarts[kSearched] + tuning::kRefinedStarts * ((kSteps + 1) * (1 + kSearched) + 2) + kSearched + 2);
  EXPECT_GT(fit.effects[0].values[0], 0.0);
}

}  // namespace
}  // namespace hybridtest
