#include "plant/effects/recorded_input.hpp"

#include <gtest/gtest.h>

#include <array>

#include "mechanics/laws/elastic.hpp"
#include "plant/site_model.hpp"
#include "plant/site_stages.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1e-3;

const EffectType& of_current(std::string_view name) {
  return with_input(*find_effect(EffectInterface::specimen, name), "current_a");
}

/// A spring of 100 N/m and one effect, beside which temperature and current are recorded.
SiteModel model_with(const EffectSetting& effect) {
  SiteModel model;
  model.make_law = [] { return std::make_unique<Elastic>(100.0); };
  model.effects = {effect};
  model.inputs = {"temperature_c", "current_a"};
  return model;
}

constexpr std::array kInputs{20.0, 3.0};
constexpr Motion kMotion{.displacement_m = 0.5, .velocity_m_per_s = 2.0};

TEST(ForceWithInput, ScalesTheForceByTheInputBeyondReference) {
  SpecimenStage stage{model_with({&of_current("force_with_input"), {0.25, 1.0, 0.0}}), kPeriod_s};
  EXPECT_EQ(stage.step({.motion = kMotion, .inputs = kInputs.data()}), 50.0 * (1.0 + 0.25 * 2.0));
}

TEST(FrictionWithInput, SlidesAtAForceThatGrowsWithTheInput) {
  SpecimenStage stage{model_with({&of_current("friction_with_input"), {10.0, 1.0, 1e-3, 0.0}}), kPeriod_s};
  // Sticks over 1 m: half of it is half of the force.
  EXPECT_NEAR(stage.step({.motion = kMotion, .inputs = kInputs.data()}), 50.0 + 10.0 * (3.0 - 1e-3) * 0.5, 1e-12);
}

TEST(DampingWithInput, DashpotGrowsWithTheInput) {
  SpecimenStage stage{model_with({&of_current("damping_with_input"), {10.0, 1.0, 0.0}}), kPeriod_s};
  EXPECT_EQ(stage.step({.motion = kMotion, .inputs = kInputs.data()}), 50.0 + 10.0 * 2.0 * 2.0);
}

TEST(DampingWithInput, TakesItsNominalValueWhereNoneIsRecorded) {
  const EffectSetting effect{&of_current("damping_with_input"), {10.0, 1.0, 6.0}};
  SiteModel model = model_with(effect);
  SpecimenStage no_sample{model, kPeriod_s};
  EXPECT_EQ(no_sample.step({.motion = kMotion}), 50.0 + 10.0 * 5.0 * 2.0);
  model.inputs = {"temperature_c"};
  SpecimenStage other_input{model, kPeriod_s};
  EXPECT_EQ(other_input.step({.motion = kMotion, .inputs = kInputs.data()}), 50.0 + 10.0 * 5.0 * 2.0);
}

TEST(InputName, IsPlain) {
  EXPECT_TRUE(is_input_name("current_a"));
  EXPECT_TRUE(is_input_name("t2"));
  for (const std::string_view name : {"", "2t", "_a", "Current", "a b", "a:b"})
    EXPECT_FALSE(is_input_name(name)) << name;
}

}  // namespace
}  // namespace hybridtest
