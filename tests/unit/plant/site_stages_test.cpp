#include "plant/site_stages.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "compensation/polynomial_displacement.hpp"
#include "core/config_error.hpp"
#include "core/time.hpp"
#include "experimental_site/rigs/simulated_rig.hpp"
#include "mechanics/laws/elastic.hpp"
#include "plant/backward_differences.hpp"
#include "plant/specimens/law_specimen.hpp"
#include "plant/transfer_systems/delay.hpp"
#include "plant/transfer_systems/second_order.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1e-3;

EffectSetting setting(EffectInterface interface, std::string_view name, std::vector<double> values) {
  return {find_effect(interface, name), std::move(values)};
}

SiteModel delayed_spring() {
  SiteModel model;
  model.make_transfer_system = [](double period_s, double delay_change_s) {
    return std::make_unique<Delay>(from_seconds(0.004 + delay_change_s), from_seconds(period_s));
  };
  model.removable_delay_s = 0.004;
  model.make_law = [] { return std::make_unique<Elastic>(1.0e6); };
  return model;
}

StageSample command(double displacement_m) { return {.motion = {.displacement_m = displacement_m}}; }

TEST(SiteStages, NegativeDelayShortensTheModelDelay) {
  SiteModel model = delayed_spring();
  model.effects = {setting(EffectInterface::transfer_system, "delay", {-0.003})};
  TransferStage stage{model, kPeriod_s};
  EXPECT_EQ(stage.step(command(0.5)), 0.0);
  EXPECT_EQ(stage.step(command(0.7)), 0.5);
  model.effects = {setting(EffectInterface::transfer_system, "delay", {-0.005})};
  EXPECT_THROW((TransferStage{model, kPeriod_s}), ConfigError);
}

/// Of the textbook: w^2 / (s^2 + 2 z w s + w^2), late by a delay, at 3 Hz.
TEST(SiteStages, WrongBandwidthMovesThePolesAndNotTheDelay) {
  constexpr double kNatural_hz = 12.0;
  constexpr double kDamping = 0.7;
  constexpr double kDelay_s = 0.0055;
  SiteModel model = delayed_spring();
  model.removable_delay_s = kDelay_s;
  model.has_bandwidth = true;
  model.make_transfer_system = [](double period_s, double delay_change_s) {
    return std::make_unique<SecondOrder>(SecondOrder::Parameters{.natural_frequency_hz = kNatural_hz,
                                                                 .damping_ratio = kDamping,
                                                                 .delay = from_seconds(kDelay_s + delay_change_s)},
                                         from_seconds(period_s));
  };
  constexpr double kOmega = 2.0 * std::numbers::pi * 3.0;
  using namespace std::complex_literals;
  for (const double error : {-0.5, -0.1, 0.2, 1.0}) {
    model.effects = {setting(EffectInterface::transfer_system, "bandwidth_error", {error})};
    TransferStage stage{model, kPeriod_s};
    const double ratio = kOmega / (2.0 * std::numbers::pi * kNatural_hz * (1.0 + error));
    const std::complex<double> response =
        std::exp(-1i * kOmega * kDelay_s) / (1.0 - ratio * ratio + 2i * kDamping * ratio);
    for (int i = 0; i < 4000; ++i) {
      const double time_s = kPeriod_s * i;
      const double moved_m = stage.step(command(std::sin(kOmega * time_s)));
      if (i < 3000) continue;
      EXPECT_NEAR(moved_m, std::imag(response * std::exp(1i * kOmega * time_s)), 1e-4) << error;
    }
  }
  model.has_bandwidth = false;
  EXPECT_THROW((TransferStage{model, kPeriod_s}), ConfigError);
}

TEST(SiteStages, InverseReversesTheSensors) {
  SiteModel model = delayed_spring();
  model.effects = {setting(EffectInterface::displacement_sensor, "gain", {0.25}),
                   setting(EffectInterface::displacement_sensor, "bias", {0.002})};
  TransferStage stage{model, kPeriod_s};
  SensorInverse inverse{model, kPeriod_s};
  for (int i = 0; i < 20; ++i) {
    const double read_m = stage.step(command(0.001 * i));
    const Motion true_motion = inverse.step({.motion = {.displacement_m = read_m, .velocity_m_per_s = 1.25}});
    EXPECT_NEAR(read_m, 1.25 * stage.displacement_m() + 0.002, 1e-15);
    EXPECT_NEAR(true_motion.displacement_m, stage.displacement_m(), 1e-15);
    EXPECT_NEAR(true_motion.velocity_m_per_s, 1.0, 1e-15);
  }
}

TEST(SiteStages, WithoutLawOnlyEffectsGiveForce) {
  SiteModel model = delayed_spring();
  model.make_law = nullptr;
  model.effects = {setting(EffectInterface::specimen, "inertia", {95.0}),
                   setting(EffectInterface::force_sensor, "bias", {3.0})};
  SpecimenStage stage{model, kPeriod_s};
  EXPECT_DOUBLE_EQ(stage.step({.motion = {.acceleration_m_per_s2 = 2.0}}), 193.0);
  EXPECT_DOUBLE_EQ(stage.force_n(), 190.0);
}

TEST(SiteStages, StagesTogetherEqualTheRig) {
  SiteModel model = delayed_spring();
  model.effects = {setting(EffectInterface::transfer_system, "bandwidth", {0.004, 0.25}),
                   setting(EffectInterface::displacement_sensor, "gain", {0.1}),
                   setting(EffectInterface::specimen, "viscous_damping", {2.0e3}),
                   setting(EffectInterface::specimen, "coulomb_friction", {500.0, 0.1, 1e-4, 0.0}),
                   setting(EffectInterface::force_sensor, "gain", {-0.02})};
  std::vector<std::unique_ptr<TransferSystem>> transfer_systems;
  transfer_systems.push_back(model.make_transfer_system(kPeriod_s, 0.0));
  std::vector<std::unique_ptr<Law>> laws;
  laws.push_back(model.make_law());
  std::vector<SimulatedRig::Effects> effects;
  effects.push_back(SimulatedRig::effects_of(model, kPeriod_s));
  SimulatedRig rig{std::move(transfer_systems),
                   std::make_unique<LawSpecimen>(std::move(laws)),
                   {},
                   from_seconds(kPeriod_s),
                   std::move(effects)};
  rig.connect();
  rig.arm();
  TransferStage transfer{model, kPeriod_s};
  SpecimenStage specimen{model, kPeriod_s};
  RigFeedback feedback{.displacement_m = SiteVector::Zero(1), .force_n = SiteVector::Zero(1)};
  BackwardDifferences differences{kPeriod_s};
  for (int i = 0; i < 500; ++i) {
    ActuatorCommand asked;
    asked.time_s = kPeriod_s * i;
    asked.displacement_m = SiteVector::Constant(1, 0.02 * std::sin(0.03 * i));
    ASSERT_EQ(rig.exchange(asked, feedback), RigStatus::healthy);
    EXPECT_EQ(feedback.displacement_m[0], transfer.step(command(asked.displacement_m[0])));
    const Motion motion = differences.moved_to(transfer.displacement_m());
    EXPECT_EQ(feedback.force_n[0], specimen.step({.motion = motion, .time_s = asked.time_s}));
  }
}

TEST(SiteStages, CompensatorIsThatOfTheModel) {
  SiteModel model = delayed_spring();
  model.make_compensator = [](double period_s, double delay_change_s) {
    return std::make_unique<PolynomialDisplacement>(
        PolynomialDisplacement::Parameters{.order = 1, .delay_s = 0.002 + delay_change_s}, period_s);
  };
  CompensatorStage stage{model, kPeriod_s};
  double commanded_m = 0.0;
  for (int i = 0; i < 10; ++i) commanded_m = stage.step(command(0.001 * i));
  EXPECT_NEAR(commanded_m, 0.011, 1e-15);  // 2 ms ahead on a ramp of 1 mm per sample
}

/// Of a wave, on which a first-order change of the command would not be the other setting's.
TEST(SiteStages, ChangedCompensatorSettingIsApplied) {
  const auto compensated = [](double delay_s, double mismatch_s) {
    SiteModel model = delayed_spring();
    model.make_compensator = [delay_s](double period_s, double delay_change_s) {
      return std::make_unique<PolynomialDisplacement>(
          PolynomialDisplacement::Parameters{.order = 2, .delay_s = delay_s + delay_change_s}, period_s);
    };
    model.compensator_delay = {.set_s = delay_s, .most_s = 1.0};
    model.effects = {{find_effect(EffectInterface::compensator, "setting_mismatch"), {mismatch_s}}};
    CompensatorStage stage{model, kPeriod_s};
    std::vector<double> command_m;
    for (int i = 0; i < 200; ++i) command_m.push_back(stage.step(command(0.02 * std::sin(0.3 * i))));
    return command_m;
  };
  EXPECT_EQ(compensated(0.008, 0.004), compensated(0.012, 0.0));
  EXPECT_EQ(compensated(0.008, -0.008), compensated(0.0, 0.0));
  EXPECT_NE(compensated(0.008, 0.004), compensated(0.008, 0.0));
  EXPECT_THROW(compensated(0.008, -0.009), ConfigError);
  EXPECT_THROW(compensated(0.008, 0.993), ConfigError);
}

}  // namespace
}  // namespace hybridtest
