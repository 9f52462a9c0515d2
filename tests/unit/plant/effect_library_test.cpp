#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "diagnosis/identification/search_table.hpp"
#include "plant/effects/effect_type.hpp"
#include "plant/effects/stage.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1e-3;

std::string label(const EffectType& type) {
  return std::string{name_of(type.interface)} + "." + std::string{type.name};
}

/// A value well inside the range of each parameter, so that the effect shows.
/// Three quarters up the search range; what may be left out is, but for the last one where all may.
std::vector<double> some_values(const EffectType& type) {
  const bool has_to_be_given =
      std::ranges::any_of(type.parameters, [](const EffectParameter& p) { return std::isnan(p.fallback); });
  std::vector<double> values;
  for (const EffectParameter& parameter : type.parameters) {
    const bool is_last = values.size() + 1 == type.parameters.size();
    const bool is_left_out = !std::isnan(parameter.fallback) && (has_to_be_given || !is_last);
    const SearchRange* const range = search_range(type, parameter);
    if (range == nullptr && std::isnan(parameter.fallback)) {
      values.push_back(1.0);  // comes from a recording: the nominal value of an input
    } else {
      values.push_back(is_left_out || range == nullptr ? parameter.fallback : 0.25 * range->low + 0.75 * range->high);
    }
  }
  return values;
}

std::vector<double> neutral_values(const EffectType& type) {
  std::vector<double> values = some_values(type);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isnan(type.parameters[i].neutral)) values[i] = type.parameters[i].neutral;
  }
  return values;
}

/// Output of a stage under a motion of order one. Its base is linear until it yields.
std::vector<double> driven(Effect& effect, double yields_at = std::numeric_limits<double>::infinity()) {
  std::vector<double> outputs;
  double force = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const double t = kPeriod_s * i;
    const Motion motion{.displacement_m = 1.1 * std::sin(3.0 * t) + 0.3 * std::sin(17.0 * t),
                        .velocity_m_per_s = 3.3 * std::cos(3.0 * t) + 5.1 * std::cos(17.0 * t),
                        .acceleration_m_per_s2 = -9.9 * std::sin(3.0 * t) - 86.7 * std::sin(17.0 * t)};
    const StageSample sample{.motion = motion, .time_s = t, .force_n = force};
    Motion given = motion;
    effect.before(sample, given);
    Motion of_base = given;
    effect.before_base(of_base);
    double output = std::clamp(of_base.displacement_m, -yields_at, yields_at);
    effect.after_base(output);
    effect.after(sample, given, output);
    force = motion.displacement_m + 0.05 * motion.velocity_m_per_s;  // of a specimen that dissipates energy
    outputs.push_back(output);
  }
  return outputs;
}

struct Unchanged final : Effect {
  void reset() noexcept override {}
};

TEST(EffectLibrary, DescribesEveryEffectOnce) {
  std::set<std::string> labels;
  EffectInterface previous = EffectInterface::network;
  for (const EffectType& type : effect_library()) {
    SCOPED_TRACE(label(type));
    EXPECT_TRUE(labels.insert(label(type)).second);
    EXPECT_GE(type.interface, previous);  // in the order of the interfaces
    previous = type.interface;
    EXPECT_FALSE(type.equation.empty());
    EXPECT_FALSE(type.source.empty());
    EXPECT_FALSE(type.parameters.empty());
    EXPECT_EQ(find_effect(type.interface, type.name), &type);
    EXPECT_EQ(type.make == nullptr, type.interface == EffectInterface::numerical_substructure);
  }
  EXPECT_EQ(find_effect(EffectInterface::specimen, "no_such_effect"), nullptr);
  EXPECT_EQ(find_effect(EffectInterface::network, "coulomb_friction"), nullptr);
}

struct InFamily {
  EffectInterface interface;
  std::string_view effect;
  EffectFamily family;
};

TEST(EffectLibrary, FamiliesFollowPhysicsAndNotTheName) {
  using enum EffectInterface;
  for (const InFamily& expected : {
           InFamily{network, "clock_drift", EffectFamily::arrival},       // wears nothing
           InFamily{network, "clock_offset", EffectFamily::arrival},      // follows no amplitude
           InFamily{network, "jitter", EffectFamily::arrival},            // likewise
           InFamily{network, "loss", EffectFamily::arrival},              // likewise
           InFamily{displacement_sensor, "drift", EffectFamily::offset},  // a zero that wanders
           InFamily{force_sensor, "drift", EffectFamily::offset},         // likewise
           InFamily{transfer_system, "compliance", EffectFamily::load},   // absent without a specimen
           InFamily{specimen, "stribeck_friction", EffectFamily::rate},   // falls with velocity
           InFamily{specimen, "velocity_strengthening_friction", EffectFamily::rate},
           InFamily{specimen, "geometric_stiffness", EffectFamily::scale},
           InFamily{specimen, "stiffness_degradation", EffectFamily::degradation},
           InFamily{specimen, "viscous_damping", EffectFamily::rate},
           InFamily{specimen, "coulomb_friction", EffectFamily::amplitude},
       }) {
    const EffectType* const type = find_effect(expected.interface, expected.effect);
    ASSERT_NE(type, nullptr) << expected.effect;
    EXPECT_EQ(type->traits.family, expected.family) << label(*type);
  }
}

TEST(EffectLibrary, RateArrivalAndMassNeedTime) {
  std::set<std::string> others;
  for (const EffectType& type : effect_library()) {
    const EffectFamily family = type.traits.family;
    const bool follows_time =
        family == EffectFamily::rate || family == EffectFamily::arrival || family == EffectFamily::mass;
    if (follows_time) {
      EXPECT_TRUE(type.traits.needs_time) << label(type);
    } else if (type.traits.needs_time) {
      others.insert(label(type));
    }
  }
  EXPECT_EQ(others, (std::set<std::string>{"displacement_sensor.drift", "force_sensor.drift", "specimen.fracture",
                                           "specimen.stiffness_degradation_with_time",
                                           "specimen.strength_degradation_with_time"}));
}

TEST(EffectLibrary, FindsEffectsByWhatTheyCorrectOrLeave) {
  using enum EffectInterface;
  EXPECT_EQ(find_effect(specimen, ModelNumber::stiffness)->name, "stiffness_error");
  EXPECT_EQ(find_effect(force_sensor, ModelNumber::offset)->name, "bias");
  EXPECT_EQ(find_effect(network, DigitTrace::loss)->name, "loss");
  EXPECT_EQ(find_effect(network, DigitTrace::lateness)->name, "jitter");
  EXPECT_EQ(find_effect(displacement_sensor, DigitTrace::rounding)->name, "quantization");
  EXPECT_EQ(find_effect(specimen, ModelNumber::none), nullptr);
  EXPECT_EQ(find_effect(specimen, DigitTrace::none), nullptr);
  EXPECT_EQ(find_effect(compensator, ModelNumber::offset), nullptr);
}

TEST(EffectLibrary, ParametersHaveValidRanges) {
  for (const EffectType& type : effect_library()) {
    std::set<std::string_view> names;
    for (const EffectParameter& parameter : type.parameters) {
      SCOPED_TRACE(label(type) + "." + std::string{parameter.name});
      EXPECT_TRUE(names.insert(parameter.name).second);
      EXPECT_LT(parameter.low, parameter.high);
      EXPECT_FALSE(parameter.what.empty());
      if (!std::isnan(parameter.neutral)) {
        EXPECT_GE(parameter.neutral, parameter.low);
        EXPECT_LE(parameter.neutral, parameter.high);
      }
      if (!std::isnan(parameter.fallback)) {
        EXPECT_GE(parameter.fallback, parameter.low);
        EXPECT_LE(parameter.fallback, parameter.high);
      }
    }
  }
}

TEST(EffectLibrary, EachInputMakesATypeOfItsOwn) {
  const EffectType& type = *find_effect(EffectInterface::specimen, "friction_with_input");
  const EffectType& current = with_input(type, "current_a");
  EXPECT_EQ(&with_input(type, std::string{"current_a"}), &current);
  EXPECT_NE(&with_input(type, "temperature_c"), &current);
  EXPECT_NE(&with_input(*find_effect(EffectInterface::specimen, "damping_with_input"), "current_a"), &current);
  EXPECT_EQ(current.input, "current_a");
  EXPECT_EQ(current.name, type.name);
  EXPECT_EQ(type.input, "");
}

class EveryEffect : public testing::TestWithParam<const EffectType*> {};

TEST_P(EveryEffect, IsAbsentAtItsNeutralValue) {
  const EffectType& type = *GetParam();
  Unchanged none;
  const auto effect = type.make(neutral_values(type), kPeriod_s);
  const std::vector<double> expected = driven(none);
  const std::vector<double> outputs = driven(*effect);
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    // Where the end of the range is neutral, 1e12, a path of 50 m still shows in the eleventh digit.
    ASSERT_NEAR(outputs[i], expected[i], 1e-10) << i;
  }
}

TEST_P(EveryEffect, ChangesTheSignalAwayFromNeutral) {
  const EffectType& type = *GetParam();
  Unchanged none;
  const auto effect = type.make(some_values(type), kPeriod_s);
  // A strength changes nothing of a base that does not yield.
  const double yields_at = effect->is_of_base() ? 0.7 : std::numeric_limits<double>::infinity();
  EXPECT_NE(driven(*effect, yields_at), driven(none, yields_at));
}

TEST_P(EveryEffect, ResetRestoresInitialState) {
  const EffectType& type = *GetParam();
  const auto effect = type.make(some_values(type), kPeriod_s);
  const std::vector<double> first = driven(*effect);
  effect->reset();
  EXPECT_EQ(driven(*effect), first);
}

TEST_P(EveryEffect, IsProportionalToItsLinearParameters) {
  const EffectType& type = *GetParam();
  Unchanged none;
  const std::vector<double> base = driven(none);
  const std::vector<double> values = some_values(type);
  const std::vector<double> once = driven(*type.make(values, kPeriod_s));
  for (std::size_t p = 0; p < values.size(); ++p) {
    const EffectParameter& parameter = type.parameters[p];
    if (!parameter.is_linear) continue;
    std::vector<double> doubled = values;
    doubled[p] *= 2.0;
    const std::vector<double> twice = driven(*type.make(doubled, kPeriod_s));
    for (std::size_t i = 0; i < base.size(); ++i) {
      const double change = once[i] - base[i];
      ASSERT_NEAR(twice[i] - base[i], 2.0 * change, 1e-11 * (1.0 + std::abs(base[i]) + std::abs(change)))
          << parameter.name << " at " << i;
    }
  }
}

/// But those that act in the coordinator, and the one that is a number with which the transfer system is made.
std::vector<const EffectType*> all_types() {
  std::vector<const EffectType*> types;
  for (const EffectType& type : effect_library()) {
    if (type.make != nullptr && type.traits.number != ModelNumber::bandwidth) types.push_back(&type);
  }
  return types;
}

INSTANTIATE_TEST_SUITE_P(Library, EveryEffect, testing::ValuesIn(all_types()), [](const auto& instance) {
  return std::string{name_of(instance.param->interface)} + "_" + std::string{instance.param->name};
});

}  // namespace
}  // namespace hybridtest
