#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "diagnosis/identification/search_table.hpp"
#include "experimental_site/rigs/simulated_rig.hpp"
#include "mechanics/laws/elastic.hpp"
#include "plant/specimens/law_specimen.hpp"
#include "plant/transfer_systems/servo_hydraulic.hpp"
#include "scenario/catalogue/formula.hpp"
#include "tests/realtime/forbidden_calls.hpp"

/// A simulated rig runs in the same control path as a laboratory: its exchange follows the same rules with any effects.
/// forbidden_calls_test.cpp holds the controls of the guard.
namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1e-3;

EffectSetting some_setting(const EffectType& type) {
  EffectSetting setting{.type = &type, .values = {}};
  for (const EffectParameter& parameter : type.parameters) {
    const bool has_to_be_given = std::isnan(parameter.fallback);
    const SearchRange* const range = search_range(type, parameter);
    // The nominal value of an input comes from a recording.
    const double searched = range == nullptr ? 1.0 : 0.5 * (range->low + range->high);
    setting.values.push_back(has_to_be_given ? searched : parameter.fallback);
  }
  return setting;
}

std::unique_ptr<SimulatedRig> rig_with(std::vector<EffectSetting> effects) {
  SiteModel model;
  model.effects = std::move(effects);
  std::vector<std::unique_ptr<TransferSystem>> transfer_systems;
  transfer_systems.push_back(
      std::make_unique<ServoHydraulic>(ServoHydraulic::Parameters{.piston_area_m2 = 3.0e-3,
                                                                  .supply_pressure_pa = 21.0e6,
                                                                  .rated_flow_m3_per_s = 1.5e-3,
                                                                  .stroke_m = 0.1,
                                                                  .oil_volume_m3 = 1.0e-3,
                                                                  .moving_mass_kg = 50.0,
                                                                  .valve_frequency_hz = 60.0,
                                                                  .proportional_gain_per_m = 60.0,
                                                                  .load_stiffness_n_per_m = 1.0},
                                       from_seconds(kPeriod_s)));
  std::vector<std::unique_ptr<Law>> laws;
  laws.push_back(std::make_unique<Elastic>(1.0));
  std::vector<SimulatedRig::Effects> of_actuators;
  of_actuators.push_back(SimulatedRig::effects_of(model, kPeriod_s));
  return std::make_unique<SimulatedRig>(std::move(transfer_systems), std::make_unique<LawSpecimen>(std::move(laws)),
                                        SensorNoise{.displacement_noise_m = 1e-5, .force_noise_n = 1.0},
                                        from_seconds(kPeriod_s), std::move(of_actuators));
}

ForbiddenCalls calls_of(SimulatedRig& rig) {
  rig.connect();
  rig.arm();
  RigFeedback feedback{.displacement_m = SiteVector::Zero(1), .force_n = SiteVector::Zero(1)};
  ActuatorCommand command;
  command.displacement_m = SiteVector::Zero(1);
  int faults = 0;
  ForbiddenCalls calls;
  {
    const ForbiddenCallCount count;
    for (int i = 0; i < 2000; ++i) {
      command.time_s = kPeriod_s * i;
      command.displacement_m[0] = 0.05 * std::sin(0.01 * i);
      if (rig.exchange(command, feedback) != RigStatus::healthy) ++faults;
    }
    rig.stop_motion();
    calls = count.calls();
  }
  EXPECT_EQ(faults, 0);
  EXPECT_NE(feedback.displacement_m[0], 0.0);  // control: it did its work
  return calls;
}

class EffectsPath : public testing::Test {
 protected:
  void SetUp() override {
    if (!can_count_forbidden_calls()) GTEST_SKIP() << "a sanitizer has these functions for itself";
  }
};

TEST_F(EffectsPath, EffectMakesNoForbiddenCall) {
  for (const EffectType& type : effect_library()) {
    if (type.make == nullptr) continue;  // acts where the coordinator starts
    const auto rig = rig_with({some_setting(type)});
    EXPECT_EQ(calls_of(*rig), ForbiddenCalls{}) << name_of(type.interface) << " " << type.name;
  }
}

TEST_F(EffectsPath, FormulaMakesNoForbiddenCall) {
  const EffectType& type =
      formula_effect({.name = "made",
                      .added_force_n = "k * x + c * tanh(v / 0.1)^2 * (path > 0.1 ? F : peak + energy + cycles + t)",
                      .input = {},
                      .numbers = {{.name = "k"}, {.name = "c"}}});
  const auto rig = rig_with({{.type = &type, .values = {3.0, 0.5}}});
  EXPECT_EQ(calls_of(*rig), ForbiddenCalls{});
}

}  // namespace
}  // namespace hybridtest
