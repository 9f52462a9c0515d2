#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "core/random.hpp"
#include "experimental_site/effects/effect_type.hpp"
#include "experimental_site/effects/stage.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1e-3;

std::string label(const EffectType& type) {
  return std::string{name_of(type.interface)} + "." + std::string{type.name};
}

/// A value well inside the range of each parameter, so that the effect shows.
std::vector<double> some_values(const EffectType& type) {
  std::vector<double> values;
  for (const EffectParameter& parameter : type.parameters) {
    values.push_back(std::isnan(parameter.fallback) ? 0.5 * (parameter.search_low + parameter.search_high) +
                                                          0.25 * (parameter.search_high - parameter.search_low)
                                                    : parameter.fallback);
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

/// Output of the stage under random, smooth motion of order one around a linear base.
std::vector<double> driven(Effect& effect, std::uint64_t seed) {
  Random random{seed};
  std::vector<double> outputs;
  Motion motion;
  double force = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const Motion before = motion;
    motion.acceleration_m_per_s2 += kPeriod_s * (50.0 * 20.0 * random.normal() - 20.0 * motion.acceleration_m_per_s2 -
                                                 400.0 * motion.velocity_m_per_s - 4000.0 * motion.displacement_m);
    motion.velocity_m_per_s = before.velocity_m_per_s + kPeriod_s * motion.acceleration_m_per_s2;
    motion.displacement_m = before.displacement_m + kPeriod_s * motion.velocity_m_per_s;
    const StageSample sample{.time_s = kPeriod_s * i, .motion = motion, .force_n = force};
    Motion given = motion;
    effect.before(sample, given);
    double output = 2.0 * given.displacement_m;
    effect.after(sample, given, output);
    force = 2.0 * motion.displacement_m;
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
  }
  EXPECT_EQ(find_effect(EffectInterface::specimen, "no_such_effect"), nullptr);
  EXPECT_EQ(find_effect(EffectInterface::network, "coulomb_friction"), nullptr);
}

TEST(EffectLibrary, ParametersHaveSoundRanges) {
  for (const EffectType& type : effect_library()) {
    std::set<std::string_view> names;
    for (const EffectParameter& parameter : type.parameters) {
      SCOPED_TRACE(label(type) + "." + std::string{parameter.name});
      EXPECT_TRUE(names.insert(parameter.name).second);
      EXPECT_LT(parameter.low, parameter.high);
      EXPECT_LE(parameter.search_low, parameter.search_high);
      EXPECT_FALSE(parameter.what.empty());
      if (!std::isnan(parameter.neutral)) {
        EXPECT_GE(parameter.neutral, parameter.low);
        EXPECT_LE(parameter.neutral, parameter.high);
      }
      EXPECT_FALSE(parameter.search_low == parameter.search_high && std::isnan(parameter.fallback));
      if (!std::isnan(parameter.fallback)) {
        EXPECT_GE(parameter.fallback, parameter.low);
        EXPECT_LE(parameter.fallback, parameter.high);
      }
    }
  }
}

class EveryEffect : public testing::TestWithParam<const EffectType*> {};

TEST_P(EveryEffect, IsAbsentAtItsNeutralValue) {
  const EffectType& type = *GetParam();
  if (type.make == nullptr) GTEST_SKIP() << "acts in the coordinator";
  Unchanged none;
  const auto effect = type.make(neutral_values(type), kPeriod_s);
  const std::vector<double> expected = driven(none, 3);
  const std::vector<double> outputs = driven(*effect, 3);
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    ASSERT_NEAR(outputs[i], expected[i], 1e-12 * (1.0 + std::abs(expected[i]))) << i;  // rounding
  }
}

TEST_P(EveryEffect, ShowsAwayFromItsNeutralValue) {
  const EffectType& type = *GetParam();
  if (type.make == nullptr) GTEST_SKIP() << "acts in the coordinator";
  Unchanged none;
  const auto effect = type.make(some_values(type), kPeriod_s);
  EXPECT_NE(driven(*effect, 3), driven(none, 3));
}

TEST_P(EveryEffect, BeginsAnewAfterReset) {
  const EffectType& type = *GetParam();
  if (type.make == nullptr) GTEST_SKIP() << "acts in the coordinator";
  const auto effect = type.make(some_values(type), kPeriod_s);
  const std::vector<double> first = driven(*effect, 3);
  effect->reset();
  EXPECT_EQ(driven(*effect, 3), first);
}

TEST_P(EveryEffect, IsProportionalToItsLinearParameters) {
  const EffectType& type = *GetParam();
  if (type.make == nullptr) GTEST_SKIP() << "acts in the coordinator";
  Unchanged none;
  const std::vector<double> base = driven(none, 5);
  const std::vector<double> values = some_values(type);
  const std::vector<double> once = driven(*type.make(values, kPeriod_s), 5);
  for (std::size_t p = 0; p < values.size(); ++p) {
    const EffectParameter& parameter = type.parameters[p];
    if (!parameter.is_linear) continue;
    std::vector<double> doubled = values;
    doubled[p] *= 2.0;
    const std::vector<double> twice = driven(*type.make(doubled, kPeriod_s), 5);
    for (std::size_t i = 0; i < base.size(); ++i) {
      const double change = once[i] - base[i];
      ASSERT_NEAR(twice[i] - base[i], 2.0 * change, 1e-11 * (1.0 + std::abs(base[i]) + std::abs(change)))
          << parameter.name << " at " << i;
    }
  }
}

std::vector<const EffectType*> all_types() {
  std::vector<const EffectType*> types;
  for (const EffectType& type : effect_library()) types.push_back(&type);
  return types;
}

INSTANTIATE_TEST_SUITE_P(Library, EveryEffect, testing::ValuesIn(all_types()), [](const auto& instance) {
  return std::string{name_of(instance.param->interface)} + "_" + std::string{instance.param->name};
});

}  // namespace
}  // namespace hybridtest
