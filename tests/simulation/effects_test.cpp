#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/text/scalar.hpp"
#include "diagnosis/identification/search_table.hpp"
#include "plant/effects/effect_type.hpp"
#include "tests/simulation/kept_simulation.hpp"

/// Every effect of the library switched on in a scenario by name.
namespace hybridtest {
namespace {

constexpr const char* kRig = "substructures[storey_1].rig.effects=";

/// The first seconds of a building whose first storey is a site with a lagging actuator.
KeptSimulation shaken(const std::vector<std::string>& overrides) {
  std::vector<std::string> all{
      "time={mode: lockstep, step_s: 0.001, duration_s: 4.0}", "substructures[storey_1].rig.sensors={}",
      "substructures[storey_1].limits={displacement_m: 0.5, velocity_m_per_s: 5.0, force_n: 1.0e7}"};
  all.insert(all.end(), overrides.begin(), overrides.end());
  return keep_simulation(shipped_scenario("two_storey_one_site", all), {});
}

const KeptSimulation& without() {
  static const KeptSimulation plain = shaken({});
  return plain;
}

/// In units of this building: peak displacement some 0.05 m, force 1e5 N, 4 s long.
double scale_of(const SearchRange& range) {
  switch (range.scale) {
    case ParameterScale::displacement_m: return 0.02;
    case ParameterScale::velocity_m_per_s: return 0.1;
    case ParameterScale::force_n: return 2.0e4;
    case ParameterScale::stiffness_n_per_m: return 1.0e6;
    case ParameterScale::damping_n_s_per_m: return 2.0e5;
    case ParameterScale::mass_kg: return 2.0e3;
    case ParameterScale::duration_s: return 4.0;
    case ParameterScale::damping_n_s2_per_m2: return 1.0e5;
    case ParameterScale::stiffness_n_per_m3: return 1.0e9;
    case ParameterScale::compliance_m_per_n: return 1.0e-7;
    case ParameterScale::energy_j: return 400.0;
    case ParameterScale::per_m: return 50.0;
    case ParameterScale::s_per_m: return 10.0;
    case ParameterScale::one:
    case ParameterScale::time_s: return 1.0;
  }
  return 1.0;
}

std::string written(const EffectType& type) {
  std::string text = "[{interface: " + std::string{name_of(type.interface)} + ", effect: " + std::string{type.name};
  // Parameters with a default keep it, unless the default switches the effect off.
  const bool has_to_be_given =
      std::ranges::any_of(type.parameters, [](const EffectParameter& p) { return std::isnan(p.fallback); });
  for (const EffectParameter& parameter : type.parameters) {
    if (has_to_be_given && !std::isnan(parameter.fallback)) continue;
    const SearchRange* const range = search_range(type, parameter);
    if (range == nullptr) continue;
    const double share = range->low + 0.55 * (range->high - range->low);
    const double value = std::clamp(scale_of(*range) * share, parameter.low, parameter.high);
    text += ", " + std::string{parameter.name} + ": " + written_number(value);
  }
  if (type.traits.takes_input) text += ", input: current_a, nominal_input: 0.05";
  return text + "}]";
}

class SwitchedOn : public testing::TestWithParam<const EffectType*> {};

TEST_P(SwitchedOn, ChangesTheResponse) {
  const EffectType& type = *GetParam();
  const bool is_numerical = type.interface == EffectInterface::numerical_substructure;
  const std::string effects = written(type);
  const KeptSimulation with = shaken({(is_numerical ? "effects=" : kRig) + effects});
  EXPECT_NE(with.digest(), without().digest()) << effects;
}

std::vector<const EffectType*> all_types() {
  std::vector<const EffectType*> types;
  for (const EffectType& type : effect_library()) types.push_back(&type);
  return types;
}

INSTANTIATE_TEST_SUITE_P(Library, SwitchedOn, testing::ValuesIn(all_types()), [](const auto& instance) {
  return std::string{name_of(instance.param->interface)} + "_" + std::string{instance.param->name};
});

TEST(Effects, AnEmptyListIsBitIdenticalToNone) {
  EXPECT_EQ(shaken({std::string{kRig} + "[]"}).digest(), without().digest());
}

TEST(Effects, NeutralValueIsBitIdenticalToNone) {
  EXPECT_EQ(shaken({std::string{kRig} + "[{interface: transfer_system, effect: delay, delay_s: 0.0}, "
                                        "{interface: specimen, effect: stiffness_error, stiffness_n_per_m: 0.0}]"})
                .digest(),
            without().digest());
}

std::vector<double> floor_1_m(const KeptSimulation& run) {
  return run.table("coordinator", "steps").column_values("displacement_floor_1_m");
}

double peak(const std::vector<double>& values) {
  double highest = 0.0;
  for (const double value : values) highest = std::max(highest, std::abs(value));
  return highest;
}

void expect_alike(const KeptSimulation& a, const KeptSimulation& b) {
  const auto left = floor_1_m(a);
  const auto right = floor_1_m(b);
  ASSERT_EQ(left.size(), right.size());
  EXPECT_NE(left, floor_1_m(without()));  // control
  // Products in another order; the loop keeps the rounding of 4000 steps small beside the 1e-2 m.
  for (std::size_t i = 0; i < left.size(); ++i) ASSERT_NEAR(left[i], right[i], 1e-10) << "step " << i;
}

TEST(Effects, WrongNumberEqualsScenarioWithThatNumber) {
  const std::string linear = "substructures[storey_1].rig.specimen={type: elastic, stiffness_n_per_m: 4.0e6}";
  const std::string undamped = "structure.damping={type: none}";
  expect_alike(shaken({linear, std::string{kRig} +
                                   "[{interface: specimen, effect: stiffness_error, stiffness_n_per_m: -4.0e5}]"}),
               shaken({"substructures[storey_1].rig.specimen={type: elastic, stiffness_n_per_m: 3.6e6}"}));
  expect_alike(
      shaken({undamped, "effects=[{interface: numerical_substructure, effect: mass_error, mass_error_ratio: 0.25}]"}),
      shaken({undamped, "structure.mass_kg={floor_1: 25.0e3, floor_2: 25.0e3}"}));
  expect_alike(
      shaken({undamped,
              "effects=[{interface: numerical_substructure, effect: stiffness_error, stiffness_error_ratio: 0.25}]"}),
      shaken({undamped, "substructures[storey_2].model={type: elastic, stiffness_n_per_m: 3.75e6}"}));
  expect_alike(
      shaken({"effects=[{interface: numerical_substructure, effect: damping_error, damping_error_ratio: 1.5}]"}),
      shaken({"structure.damping={type: rayleigh, ratio: 0.05, modes: [1, 2]}"}));
  expect_alike(shaken({std::string{kRig} + "[{interface: transfer_system, effect: delay, delay_s: 0.003}]"}),
               shaken({"substructures[storey_1].rig.transfer_system={type: second_order, natural_frequency_hz: 15.0, "
                       "damping_ratio: 0.9, delay_s: 0.007}"}));
  expect_alike(shaken({std::string{kRig} + "[{interface: transfer_system, effect: delay, delay_s: -0.003}]"}),
               shaken({"substructures[storey_1].rig.transfer_system={type: second_order, natural_frequency_hz: 15.0, "
                       "damping_ratio: 0.9, delay_s: 0.001}"}));
}

TEST(Effects, ServoHydraulicActuatorCompletesTheTest) {
  const KeptSimulation run = shaken(
      {"substructures[storey_1].rig.transfer_system={type: servo_hydraulic, piston_area_m2: 1.0e-2, "
       "supply_pressure_pa: 21.0e6, rated_flow_m3_per_s: 1.0e-2, stroke_m: 0.15, oil_volume_m3: 3.0e-3, "
       "leakage_m3_per_s_pa: 1.0e-11, moving_mass_kg: 200.0, damping_n_s_per_m: 5.0e3, valve_frequency_hz: 80.0, "
       "proportional_gain_per_m: 40.0, load_stiffness_n_per_m: 4.0e6}"});
  EXPECT_EQ(run.result.coordinator.reason, StopReason::completed);
  EXPECT_NE(run.digest(), without().digest());
  const KeptRows& control = run.table("storey_1", "control");
  const auto commanded_m = control.column_values("command_displacement_m");
  const auto measured_m = control.column_values("measured_displacement_m");
  std::vector<double> error_m;
  for (std::size_t i = 0; i < commanded_m.size(); ++i) error_m.push_back(commanded_m[i] - measured_m[i]);
  // The loop of Kp Qr / A = 40 rad/s follows 1.3 Hz with an error of about omega / 40 = a fifth.
  EXPECT_LT(peak(error_m), 0.6 * peak(commanded_m));
  EXPECT_GT(peak(measured_m), 0.5 * peak(commanded_m));
}

TEST(Effects, FrictionDampsAndYieldingLimits) {
  const auto force_n = [](const KeptSimulation& run) {
    return run.table("storey_1", "control").column_values("measured_force_n");
  };
  EXPECT_LT(peak(floor_1_m(shaken(
                {std::string{kRig} + "[{interface: specimen, effect: viscous_damping, damping_n_s_per_m: 2.0e5}]"}))),
            0.8 * peak(floor_1_m(without())));
  EXPECT_LT(peak(floor_1_m(shaken(
                {std::string{kRig} + "[{interface: specimen, effect: coulomb_friction, friction_force_n: 1.0e4}]"}))),
            0.8 * peak(floor_1_m(without())));
  const double half_n = 0.5 * peak(force_n(without()));
  EXPECT_EQ(peak(force_n(shaken({std::string{kRig} + "[{interface: force_sensor, effect: saturation, limit_n: " +
                                 written_number(half_n) + "}]"}))),
            half_n);
}

}  // namespace
}  // namespace hybridtest
