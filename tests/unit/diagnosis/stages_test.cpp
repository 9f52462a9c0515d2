#include "diagnosis/verdict/stages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "diagnosis/identification/segment.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

/// What a recording that was held out tells of several causes.
namespace hybridtest {
namespace {

using enum EffectInterface;
using testing::ElementsAre;

const EffectType* const kWithTime = find_effect(specimen, "stiffness_degradation_with_time");
const EffectType* const kWithPath = find_effect(specimen, "stiffness_degradation");
const EffectType* const kDamping = find_effect(specimen, "viscous_damping");

/// A spring that loses 30 % of its stiffness in 12 s, in proportion to time, beside a damper; the motion is `reach`
/// times the made one. With its path it loses as much of the stiffness less.
std::vector<Segment> softened(double reach, double damping_n_s_per_m, bool with_path = false) {
  const auto moved_m = [=](double t) { return reach * made_motion_m(t); };
  const double lost_per_s = (with_path ? reach : 1.0) / 40.0;
  const Recording recording = made_recording(moved_m, [&](double t) {
    return (1.0 - lost_per_s * t) * kMadeStiffness_n_per_m * moved_m(t) +
           damping_n_s_per_m * reach * made_velocity_m_per_s(t);
  });
  std::vector<Segment> segments = segments_of(recording, 0, 0);
  std::erase_if(segments, [](const Segment& segment) { return segment.to != Channel::measured_force; });
  return segments;
}

/// A softening with time and another effect were found in one recording, and what else was looked at. What stays of
/// them beside another recording.
std::vector<const EffectType*> kept_with(const EffectType* other, const std::vector<Segment>& fitted,
                                         const std::vector<Segment>& held_out,
                                         const std::vector<const EffectType*>& looked_at = {}) {
  const SiteModel model = made_model();
  Stage stage{.problem = make_problem(model, fitted), .selection = {}, .judgement = {}};
  Selection& selection = stage.selection;
  selection.baseline = fit_nothing(stage.problem, false);
  selection.by_numbers = selection.baseline;
  selection.library = {{.type = kWithTime, .fit = fit_effects(stage.problem, {kWithTime}, false)}};
  for (const EffectType* const type : looked_at) {
    selection.library.push_back({.type = type, .fit = fit_effects(stage.problem, {type}, false)});
  }
  selection.chosen = fit_effects(stage.problem, {kWithTime, other}, false);
  selection.chosen_probabilities = {0.9, 0.9};
  selection.shares = {0.5, 0.5};
  stage.judgement = judge(stage.problem, selection, {});
  std::vector<Stage> stages{stage};
  std::vector<std::string> notes;
  drop_what_does_not_carry_over(model, held_out, 1, {}, stages, notes);
  std::vector<const EffectType*> types;
  for (const EffectSetting& effect : stages.front().selection.chosen.effects) types.push_back(effect.type);
  return types;
}

/// The effects fall with the inverse of time and of path. A specimen that softens in proportion to time does not: the
/// path makes up for the difference where it was fitted.
TEST(CarryingOver, LeavesOutACauseThatMakesTheHeldOutGapLarger) {
  EXPECT_THAT(kept_with(kWithPath, softened(1.0, 0.0), softened(0.5, 0.0)), ElementsAre(kWithTime));
}

TEST(CarryingOver, KeepsACauseThatMakesTheHeldOutGapSmaller) {  // control
  EXPECT_THAT(kept_with(kDamping, softened(1.0, 2e4), softened(0.5, 2e4)), ElementsAre(kWithTime, kDamping));
}

/// Over one motion of even size time and path tell the same.
TEST(CarryingOver, TakesPathForTimeWhereLessMotionSoftensLess) {
  const std::vector<Segment> fitted = softened(1.0, 2e4, true);
  const std::vector<Segment> held_out = softened(0.1, 2e4, true);
  EXPECT_THAT(kept_with(kDamping, fitted, held_out, {kWithPath}), ElementsAre(kWithPath, kDamping));
  EXPECT_THAT(kept_with(kDamping, fitted, held_out), ElementsAre(kDamping)) << "control: nothing else was looked at";
}

const EffectType* const kContact = find_effect(specimen, "contact");
constexpr double kStop_m = 0.008;

/// A spring that is softer than the model's by a ratio, and a stop; the motion is `reach` times the made one.
std::vector<Segment> with_stop(double reach, double softer, double stop_n_per_m) {
  const auto moved_m = [=](double t) { return reach * made_motion_m(t); };
  const Recording recording = made_recording(moved_m, [&](double t) {
    return (1.0 - softer) * kMadeStiffness_n_per_m * moved_m(t) + stop_n_per_m * std::max(0.0, moved_m(t) - kStop_m);
  });
  std::vector<Segment> segments = segments_of(recording, 0, 0);
  std::erase_if(segments, [](const Segment& segment) { return segment.to != Channel::measured_force; });
  return segments;
}

/// The verdict of a contact and a corrected stiffness beside a held-out recording, and what was said of it.
report::Verdict verdict_beside(const std::vector<Segment>& held_out, std::vector<std::string>& notes) {
  const SiteModel model = made_model();
  Stage stage{
      .problem = make_problem(model, with_stop(1.0, 0.01, kMadeStiffness_n_per_m)), .selection = {}, .judgement = {}};
  Selection& selection = stage.selection;
  selection.baseline = fit_nothing(stage.problem, false);
  selection.by_numbers = selection.baseline;
  selection.library = {{.type = kContact, .fit = fit_effects(stage.problem, {kContact}, false)}};
  selection.chosen = fit_effects(stage.problem, {kContact, find_effect(specimen, ModelNumber::stiffness)}, false);
  selection.chosen_probabilities = {0.9, 0.9};
  selection.shares = {0.5, 0.5};
  stage.judgement = judge(stage.problem, selection, {});
  std::vector<Stage> stages{stage};
  drop_what_does_not_carry_over(model, held_out, 1, {}, stages, notes);
  return stages.front().judgement.verdict;
}

/// The spring of the held-out recording is softer by so much that its correction removes less than a part has to.
TEST(CarryingOver, CauseThatDoesNotActIsNotChecked) {
  std::vector<std::string> notes;
  EXPECT_EQ(verdict_beside(with_stop(0.25, 0.04, kMadeStiffness_n_per_m), notes), report::Verdict::partial);
  EXPECT_THAT(notes, ElementsAre(testing::HasSubstr("do not act in the held-out recordings")));
  notes.clear();
  EXPECT_EQ(verdict_beside(with_stop(1.0, 0.2, 0.0), notes), report::Verdict::unknown) << "control: it would act there";
}

}  // namespace
}  // namespace hybridtest
