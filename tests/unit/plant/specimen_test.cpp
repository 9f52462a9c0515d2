#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "mechanics/laws/bilinear.hpp"
#include "plant/site_model.hpp"
#include "tests/unit/plant/effect_bench.hpp"

/// Effects on the specimen against their closed forms.
namespace hybridtest {
namespace {

using testing::DoubleNear;
using testing::Pointwise;

constexpr double kPi = std::numbers::pi;
constexpr auto kSpecimen = EffectInterface::specimen;

double time_s(std::size_t sample) { return kBenchPeriod_s * static_cast<double>(sample); }

struct Formula {
  const char* name;
  std::vector<double> values;
  std::function<double(const Driver&, double)> force_n;
};

class AFormulaOfTheMotion : public testing::TestWithParam<Formula> {};

TEST_P(AFormulaOfTheMotion, IsAddedToTheBaseForce) {
  const auto& [name, values, force_n] = GetParam();
  const Driver driver = sine(0.01, 12.0);
  const auto effect = made(kSpecimen, name, values);
  const auto forces = response(*effect, driver, 600, [](const Motion&) { return 7.0; });
  for (std::size_t i = 0; i < forces.size(); ++i) ASSERT_NEAR(forces[i], 7.0 + force_n(driver, time_s(i)), 1e-9) << i;
}

std::vector<Formula> formulas() {
  return {
      Formula{"stiffness_error", {0.0, -3.0e5}, [](const Driver& d, double t) { return -3.0e5 * d.displacement_m(t); }},
      Formula{"viscous_damping", {2.0e4}, [](const Driver& d, double t) { return 2.0e4 * d.velocity_m_per_s(t); }},
      Formula{"inertia", {95.0}, [](const Driver& d, double t) { return 95.0 * d.acceleration_m_per_s2(t); }},
      Formula{
          "quadratic_damping",
          {3.0e5},
          [](const Driver& d, double t) { return 3.0e5 * d.velocity_m_per_s(t) * std::abs(d.velocity_m_per_s(t)); }},
      Formula{"nonlinear_viscous_damping",
              {4.0e4, 0.35, 0.0},
              [](const Driver& d, double t) {
                const double velocity = d.velocity_m_per_s(t);
                return 4.0e4 * std::copysign(std::pow(std::abs(velocity), 0.35), velocity);
              }},
      Formula{"cubic_stiffness",
              {2.0e9},
              [](const Driver& d, double t) { return 2.0e9 * std::pow(d.displacement_m(t), 3); }},
      Formula{"contact",
              {4.0e5, 0.004, 0.0, 1.0},
              [](const Driver& d, double t) { return 4.0e5 * std::max(0.0, d.displacement_m(t) - 0.004); }},
      Formula{"contact",
              {4.0e5, -0.004, 0.0, 1.0},
              [](const Driver& d, double t) { return 4.0e5 * std::min(0.0, d.displacement_m(t) + 0.004); }},
      Formula{"contact",
              {4.0e5, 0.004, 0.5, 1.25},
              [](const Driver& d, double t) {
                const double x = d.displacement_m(t);
                return 4.0e5 * std::max(0.0, x - 0.004) + 2.0e5 * std::min(0.0, x + 0.005);
              }},
      Formula{"contact",
              {4.0e5, -0.004, 0.5, 1.25},
              [](const Driver& d, double t) {
                const double x = d.displacement_m(t);
                return 4.0e5 * std::min(0.0, x + 0.004) + 2.0e5 * std::max(0.0, x - 0.005);
              }},
      Formula{"geometric_stiffness", {5.0e4, 0.05}, [](const Driver& d, double t) {
                return -5.0e4 * std::tan(std::asin(d.displacement_m(t) / 0.05));
              }}};
}

INSTANTIATE_TEST_SUITE_P(Specimen, AFormulaOfTheMotion, testing::ValuesIn(formulas()), [](const auto& instance) {
  return std::string{instance.param.name} + "_" + std::to_string(instance.index);
});

TEST(StribeckFriction, DecreasesFromStaticToSlidingValue) {
  const auto sliding_at = [](double velocity_m_per_s) {
    const auto effect = made(kSpecimen, "stribeck_friction", {100.0, 0.5, 0.02, 1e-6, 0.0});
    const Driver ramp{[=](double t) { return velocity_m_per_s * t; }, [=](double) { return velocity_m_per_s; },
                      [](double) { return 0.0; }};
    return response(*effect, ramp, 50).back();
  };
  EXPECT_NEAR(sliding_at(1.0), 100.0, 1e-9);
  EXPECT_NEAR(sliding_at(0.02), 100.0 + 50.0 * std::exp(-1.0), 1e-9);
  EXPECT_NEAR(sliding_at(-0.002), -(100.0 + 50.0 * std::exp(-0.01)), 1e-9);
}

TEST(VelocityStrengtheningFriction, GrowsFromSlowToFastValue) {
  const auto sliding_at = [](double slow_ratio, double velocity_m_per_s) {
    const auto effect = made(kSpecimen, "velocity_strengthening_friction", {100.0, slow_ratio, 50.0, 1e-6});
    const Driver ramp{[=](double t) { return velocity_m_per_s * t; }, [=](double) { return velocity_m_per_s; },
                      [](double) { return 0.0; }};
    return response(*effect, ramp, 50).back();
  };
  EXPECT_NEAR(sliding_at(0.4, 1.0), 100.0, 1e-9);
  EXPECT_NEAR(sliding_at(0.4, 0.02), 100.0 * (1.0 - 0.6 * std::exp(-1.0)), 1e-9);
  EXPECT_NEAR(sliding_at(0.0, -0.002), -100.0 * (1.0 - std::exp(-0.1)), 1e-9);
}

TEST(Yielding, DissipatesBilinearEnergyPerCycle) {
  constexpr double kStiffness_n_per_m = 1.0e6;
  constexpr double kYield_n = 4.0e3;
  constexpr double kAmplitude_m = 0.01;
  const auto effect = made(kSpecimen, "yielding", {kYield_n, kStiffness_n_per_m, 100.0});
  const Driver driver = sine(kAmplitude_m, 2.0 * kPi);
  const auto forces =
      response(*effect, driver, 3001, [](const Motion& motion) { return kStiffness_n_per_m * motion.displacement_m; });
  // Elastoplastic loop: 4 Fy (A - xy). The second branch's R = R0 (1 - 0.925 xi / (0.15 + xi)) rounds it: the law's
  // own difference, a tenth of the loop.
  const double expected_j = 4.0 * kYield_n * (kAmplitude_m - kYield_n / kStiffness_n_per_m);
  EXPECT_NEAR(work_j(forces, driver, 1000, 2000), expected_j, 0.1 * expected_j);
  EXPECT_NEAR(forces[3], kStiffness_n_per_m * driver.displacement_m(time_s(3)), 1e-9);  // nothing lost yet
}

TEST(StrengthAsymmetry, MovesTheStrengthsApartAndKeepsTheStiffness) {
  // k d = 1 kN beside Fy = 4 kN: yields at 5 kN and at -3 kN. Quarters of the yield displacement, and back.
  const auto effect = made(kSpecimen, "strength_asymmetry", {0.001});
  Bilinear law{{.stiffness_n_per_m = 1.0e6, .yield_force_n = 4.0e3, .hardening_ratio = 0.0}};
  const auto forces = along(*effect, {0.0, 0.002, 0.005, 0.008, 0.006, 0.0, -0.004, -0.002}, [&](const Motion& motion) {
    const double force_n = law.trial(motion.displacement_m, motion.velocity_m_per_s);
    law.commit();
    return force_n;
  });
  const std::vector<double> by_hand_n{0.0, 2.0e3, 5.0e3, 5.0e3, 3.0e3, -3.0e3, -3.0e3, -1.0e3};
  EXPECT_THAT(forces, Pointwise(DoubleNear(1e-9), by_hand_n));
}

TEST(StrengthAsymmetry, LeavesASpringAsItIs) {
  const auto effect = made(kSpecimen, "strength_asymmetry", {0.001});
  // Also where the first sample is not at zero.
  const auto forces = along(*effect, {0.003, 0.004, -0.002}, [](const Motion& m) { return 1.0e6 * m.displacement_m; });
  EXPECT_THAT(forces, Pointwise(DoubleNear(1e-9), std::vector<double>{3.0e3, 4.0e3, -2.0e3}));
}

TEST(BoucWenHysteresis, LoadingIsExponential) {
  // n = 1: z = 1 - exp(-x / xy) from rest.
  const auto effect = made(kSpecimen, "bouc_wen_hysteresis", {250.0, 0.002, 1.0, 0.5});
  std::vector<double> path;
  for (int i = 0; i <= 100; ++i) path.push_back(1e-4 * i);
  const auto forces = along(*effect, path);
  for (std::size_t i = 0; i < path.size(); ++i) {
    ASSERT_NEAR(forces[i], 250.0 * -std::expm1(-path[i] / 0.002), 250.0 * 6e-8);  // 0.05^4 / 100, see carried_along
  }
}

TEST(Pinching, RemovesItsShareOfForceNearZero) {
  const auto effect = made(kSpecimen, "pinching", {0.8, 0.002});
  const Driver driver = sine(0.01, 12.0);
  const auto forces = response(*effect, driver, 600, [](const Motion& m) { return 3.0e5 * m.displacement_m; });
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const double x = driver.displacement_m(time_s(i));
    ASSERT_NEAR(forces[i], 3.0e5 * x * (1.0 - 0.8 * std::exp(-x * x / 4.0e-6)), 1e-9) << i;
  }
}

TEST(Gap, PassesMotionBeyondTheGap) {
  const auto effect = made(kSpecimen, "gap", {0.004});
  const Driver driver = sine(0.01, 12.0);
  const auto forces = response(*effect, driver, 600, [](const Motion& m) { return 3.0e5 * m.displacement_m; });
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const double x = driver.displacement_m(time_s(i));
    ASSERT_NEAR(forces[i], 3.0e5 * std::copysign(std::max(0.0, std::abs(x) - 0.004), x), 1e-9) << i;
  }
}

TEST(StiffnessDegradation, HalvesStiffnessAfterHalfLife) {
  const auto effect = made(kSpecimen, "stiffness_degradation", {4.0, 0.0});
  const auto forces =
      along(*effect, {0.0, 1.0, -1.0, 0.0, 1.0}, [](const Motion& m) { return 10.0 * m.displacement_m; });
  EXPECT_NEAR(forces[1], 10.0 / 1.25, 1e-12);
  EXPECT_NEAR(forces[4], 10.0 / 2.25, 1e-12);  // 5 m travelled
}

double elastic_n(const Motion& m) { return 10.0 * m.displacement_m; }
double plastic_n(const Motion& m) { return std::clamp(100.0 * m.displacement_m, -10.0, 10.0); }

TEST(StiffnessDegradation, FollowsTheLargestDisplacement) {
  const auto effect = made(kSpecimen, "stiffness_degradation_with_peak", {4.0, 0.0});
  const auto forces = along(*effect, {0.0, 1.0, -1.0, 0.5, 2.0, 1.0}, elastic_n);
  EXPECT_NEAR(forces[3], 5.0 / 1.25, 1e-12);
  EXPECT_NEAR(forces[4], 20.0 / 1.5, 1e-12);
  EXPECT_NEAR(forces[5], 10.0 / 1.5, 1e-12);
}

TEST(StiffnessDegradation, FollowsTheCycles) {
  const auto effect = made(kSpecimen, "stiffness_degradation_with_cycles", {2.0, 0.0});
  const auto forces = along(*effect, {0.0, 1.0, -1.0, 1.0, -1.0, 1.0, 0.05, -0.05, 0.05}, elastic_n);
  EXPECT_NEAR(forces[1], 10.0, 1e-12);
  EXPECT_NEAR(forces[2], -10.0 / 1.25, 1e-12);  // half a cycle
  EXPECT_NEAR(forces[5], 10.0 / 2.0, 1e-12);    // two cycles
  EXPECT_NEAR(forces[8], 0.5 / 2.0, 1e-12);     // too small to count
}

TEST(StiffnessDegradation, FollowsTheTime) {
  const auto effect = made(kSpecimen, "stiffness_degradation_with_time", {4.0 * kBenchPeriod_s, 0.0});
  const auto forces = along(*effect, {1.0, 1.0, 1.0, 1.0, 1.0}, elastic_n);
  EXPECT_NEAR(forces[0], 10.0, 1e-12);
  EXPECT_NEAR(forces[4], 5.0, 1e-12);
}

TEST(StiffnessDegradation, LosesStrengthWithItsExponent) {
  const std::vector<double> path{0.0, 0.02, 2.0, 4.0};  // 100 N/m up to 10 N; at 4 m a half of the stiffness is left
  const auto at_end = [&](double exponent) {
    return along(*made(kSpecimen, "stiffness_degradation_with_peak", {4.0, exponent}), path, plastic_n);
  };
  EXPECT_NEAR(at_end(0.0).back(), 10.0, 1e-12);
  EXPECT_NEAR(at_end(0.5).back(), 10.0 * std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(at_end(1.0).back(), 5.0, 1e-12);
  for (const double exponent : {0.0, 0.5, 1.0}) EXPECT_NEAR(at_end(exponent)[1], 2.0 / 1.005, 1e-12) << exponent;
}

/// Stiffness under degradation with energy, over that without, after cycles of a base's force.
double stiffness_left(const std::function<double(const Motion&)>& base, double half_life_j) {
  const auto effect = made(kSpecimen, "stiffness_degradation_with_energy", {half_life_j, 0.0});
  const auto unchanged = made(kSpecimen, "stiffness_degradation_with_energy", {1e12, 0.0});
  const Driver driver = sine(0.5, 20.0);
  const double last = response(*effect, driver, 2500, base).back();
  return last / response(*unchanged, driver, 2500, base).back();
}

TEST(StiffnessDegradation, WithoutDissipationEnergyLeavesItAlone) {
  EXPECT_NEAR(stiffness_left(elastic_n, 1e-3), 1.0, 1e-9);
}

TEST(StrengthDegradation, FollowsTheDissipatedEnergy) {
  // A friction of 10 N: it turns at +-0.5 m and dissipates 20 J a cycle; zero force is met at each turn.
  double before_m = 0.0;
  const auto friction_n = [&](const Motion& m) {
    const double force_n = m.displacement_m == before_m ? 0.0 : std::copysign(10.0, m.displacement_m - before_m);
    before_m = m.displacement_m;
    return force_n;
  };
  const auto effect = made(kSpecimen, "strength_degradation_with_energy", {50.0});
  const auto forces = response(*effect, sine(0.5, 20.0), 2500, friction_n);
  // Strength over the path: ds/dE = -s / L with dE = s 10 N dx would give 1 / (1 + E0 / L) continuously; the effect
  // steps at each turn: s(n + 1) = exp(-(E(n) + s(n) 10 J) / L).
  double energy_j = 0.0;
  double left = 1.0;
  for (int turn = 0; turn <= 15; ++turn) {  // turns at (turn + 0.5) pi / 20 s
    const int middle = static_cast<int>(turn * std::numbers::pi / 20.0 / kBenchPeriod_s) + 5;
    EXPECT_NEAR(std::abs(forces[static_cast<std::size_t>(middle)]), 10.0 * left, 0.005 * 10.0) << turn;
    energy_j += left * 10.0 * (turn == 0 ? 0.5 : 1.0);
    left = std::exp(-energy_j / 50.0);
  }
}

TEST(StrengthDegradation, FollowsPeakCyclesAndTime) {
  const std::vector<double> path{1.0, -2.0, 1.0};
  const auto last = [&](std::string_view name, double decay) {
    return along(*made(kSpecimen, name, {decay}), path, plastic_n).back();
  };
  EXPECT_NEAR(last("strength_degradation_with_peak", 4.0), 10.0 * std::exp(-0.5), 1e-12);
  EXPECT_NEAR(last("strength_degradation_with_cycles", 4.0), 10.0 * std::exp(-0.25), 1e-12);
  EXPECT_NEAR(last("strength_degradation_with_time", 4.0 * kBenchPeriod_s), 10.0 * std::exp(-0.5), 1e-12);
}

TEST(StrengthDegradation, LosesAllStrengthWithoutInfinities) {
  const auto effect = made(kSpecimen, "strength_degradation", {1e-3});
  EXPECT_NEAR(along(*effect, {0.0, 5.0, -5.0}, plastic_n).back(), 0.0, 1e-9);
}

TEST(StiffnessError, ChangesStiffnessButNotStrength) {
  const auto effect = made(kSpecimen, "stiffness_error", {0.25, 0.0});
  const auto plastic = [](const Motion& m) { return std::clamp(10.0 * m.displacement_m, -8.0, 8.0); };
  const auto forces = along(*effect, {0.0, 0.1, 0.5, 1.0, -2.0}, plastic);
  const std::vector<double> expected{0.0, 1.25, 6.25, 8.0, -8.0};
  for (std::size_t i = 0; i < forces.size(); ++i) EXPECT_NEAR(forces[i], expected[i], 1e-12) << i;
}

TEST(StrengthError, ChangesStrengthButNotStiffness) {
  const auto effect = made(kSpecimen, "strength_error", {0.25});
  const auto plastic = [](const Motion& m) { return std::clamp(10.0 * m.displacement_m, -8.0, 8.0); };
  const auto forces = along(*effect, {0.0, 0.1, 0.9, 1.5, -2.0}, plastic);
  const std::vector<double> expected{0.0, 1.0, 9.0, 10.0, -10.0};
  for (std::size_t i = 0; i < forces.size(); ++i) EXPECT_NEAR(forces[i], expected[i], 1e-12) << i;
}

/// The same as a law with the hardening ratio b + e (1 - b), over loading, unloading and reversed yielding.
TEST(HardeningError, ChangesHardeningAlone) {
  const auto law_with = [](double hardening_ratio) {
    return Bilinear{{.stiffness_n_per_m = 1.0e6, .yield_force_n = 4.0e3, .hardening_ratio = hardening_ratio}};
  };
  const auto force_n = [](Bilinear& law, double displacement_m) {
    const double force = law.trial(displacement_m, 0.0);
    law.commit();
    return force;
  };
  for (const double error : {0.2, -0.1}) {
    Bilinear modelled = law_with(0.15);
    Bilinear real = law_with(0.15 + error * 0.85);
    const auto effect = made(kSpecimen, "hardening_error", {error});
    effect->follow_stiffness(modelled.initial_stiffness_n_per_m());
    const std::vector<double> path{0.0, 0.003, 0.01, 0.004, -0.009, -0.002, 0.012};
    const auto forces = along(*effect, path, [&](const Motion& m) { return force_n(modelled, m.displacement_m); });
    for (std::size_t i = 0; i < path.size(); ++i) EXPECT_NEAR(forces[i], force_n(real, path[i]), 1e-9) << error << i;
  }
}

/// Of a site the effect learns the stiffness of the law.
TEST(HardeningError, KnowsTheStiffnessOfTheLaw) {
  SiteModel model;
  model.make_law = [] {
    return std::make_unique<Bilinear>(
        Bilinear::Parameters{.stiffness_n_per_m = 1.0e6, .yield_force_n = 4.0e3, .hardening_ratio = 0.0});
  };
  model.effects = {{find_effect(kSpecimen, "hardening_error"), {0.25}}};
  StageEffects effects = effects_at(model, kSpecimen, kBenchPeriod_s);
  const std::unique_ptr<Law> law = law_of(model);
  const auto base = [&](const Motion& m) { return law->trial(m.displacement_m, 0.0); };
  EXPECT_NEAR(effects.step({.motion = {.displacement_m = 0.010}}, base), 0.75 * 4.0e3 + 0.25 * 1.0e6 * 0.010, 1e-9);
}

/// A stop beside a law whose numbers are wrong stands where it stands, before and behind them in the list.
TEST(StageEffects, WrongNumbersOfTheLawChangeNothingBesideIt) {
  const auto plastic = [](const Motion& m) { return std::clamp(10.0 * m.displacement_m, -8.0, 8.0); };
  for (const bool is_first : {true, false}) {
    std::vector<std::unique_ptr<Effect>> effects;
    effects.push_back(made(kSpecimen, "strength_error", {1.0}));
    effects.push_back(made(kSpecimen, "stiffness_error", {0.5, 0.0}));
    effects.insert(is_first ? effects.begin() : effects.end(), made(kSpecimen, "contact", {100.0, 0.3, 0.0, 1.0}));
    StageEffects stage{std::move(effects)};
    // 15 per metre up to 16; the stop adds 100 per metre from 0.3 m on.
    for (const auto& [x, expected] : {std::pair{0.2, 3.0}, std::pair{0.5, 7.5 + 20.0}, std::pair{2.0, 16.0 + 170.0}}) {
      EXPECT_NEAR(stage.step({.motion = {.displacement_m = x}}, plastic), expected, 1e-12) << x << is_first;
    }
  }
}

TEST(StrengthDegradation, ReducesStrengthButNotStiffness) {
  const double left = std::exp(-5.0 / 4.0);
  const auto of_strength = made(kSpecimen, "strength_degradation", {4.0});
  const auto plastic = [](const Motion& m) { return std::clamp(100.0 * m.displacement_m, -10.0, 10.0); };
  EXPECT_NEAR(along(*of_strength, {0.0, 1.0, -1.0, 0.0, 1.0}, plastic)[4], 10.0 * left, 1e-12);
  const auto of_stiffness = made(kSpecimen, "strength_degradation", {4.0});
  const auto elastic = [](const Motion& m) { return 100.0 * m.displacement_m; };
  EXPECT_NEAR(along(*of_stiffness, {0.0, 1.0, -1.0, 0.0, 1.0}, elastic)[4], 100.0, 1e-12);
}

TEST(SpecimenBacklash, FrictionHeldBacklashIsThePlayOperator) {
  const auto effect = made(kSpecimen, "backlash", {0.2, 1.0});
  const auto forces = along(*effect, {0.0, 0.05, 0.5, 0.45, 0.3, 0.2, 0.35, 0.5},
                            [](const Motion& m) { return 10.0 * m.displacement_m; });
  const std::vector<double> expected{0.0, 0.0, 4.0, 4.0, 4.0, 3.0, 3.0, 4.0};
  for (std::size_t i = 0; i < forces.size(); ++i) EXPECT_NEAR(forces[i], expected[i], 1e-12) << i;
}

TEST(SpecimenBacklash, FreeSpringBacklashIsAFixedGap) {
  const auto effect = made(kSpecimen, "backlash", {0.2, 0.0});
  const auto force = [](const Motion& m) { return 10.0 * m.displacement_m; };
  const Driver driver = sine(0.5, 2.0);
  const auto forces = response(*effect, driver, 5000, force);
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const double x = driver.displacement_m(time_s(i));
    // The flank is left a sample after the force is gone.
    ASSERT_NEAR(forces[i], std::copysign(std::max(0.0, 10.0 * (std::abs(x) - 0.1)), x), 10.0 * 1.001 * kBenchPeriod_s)
        << i;
  }
}

TEST(SpecimenBacklash, FrictionDamperBacklashMovesWithReversal) {
  const auto friction = made(kSpecimen, "coulomb_friction", {100.0, 0.0, 0.01, 0.0});
  const auto backlash = made(kSpecimen, "backlash", {0.1, 0.0});
  std::vector<double> forces;
  for (int i = 0; i <= 80; ++i) {
    const double x = i <= 40 ? 0.005 * i : 0.2 - 0.005 * (i - 40);
    const StageSample sample{.motion = {.displacement_m = x}, .time_s = 0.0};
    Motion motion = sample.motion;
    backlash->before(sample, motion);
    double force_n = 0.0;
    friction->after(sample, motion, force_n);
    backlash->after(sample, motion, force_n);
    forces.push_back(force_n);
  }
  EXPECT_NEAR(forces[40], 100.0, 1e-9);   // slides
  EXPECT_NEAR(forces[41], 50.0, 1e-9);    // unloads over the pre-sliding displacement
  EXPECT_NEAR(forces[50], 0.0, 1e-9);     // in the clearance
  EXPECT_NEAR(forces[62], 0.0, 1e-9);     // 0.11 m after the reversal still
  EXPECT_NEAR(forces[64], -100.0, 1e-9);  // 0.12 m after it slides back
}

TEST(Relaxation, HasMaxwellComplexStiffness) {
  constexpr double kTime_s = 0.05;
  const auto effect = made(kSpecimen, "relaxation", {1.0e5, kTime_s});
  const auto at_rest = along(*effect, std::vector<double>(200, 0.01));
  for (std::size_t i = 0; i < at_rest.size(); ++i) {
    ASSERT_NEAR(at_rest[i], at_rest[0] * std::exp(-time_s(i) / kTime_s), 1e-9);
  }
  // In phase with the displacement: k (omega T)^2 / (1 + (omega T)^2); with the velocity: k T / (1 + (omega T)^2).
  constexpr double kOmega = 20.0;  // omega T = 1
  effect->reset();
  const Driver driver = sine(0.01, kOmega);
  const auto forces = response(*effect, driver, 2000);
  for (std::size_t i = 1000; i < forces.size(); ++i) {
    const double expected =
        0.5 * 1.0e5 * (driver.displacement_m(time_s(i)) + driver.velocity_m_per_s(time_s(i)) / kOmega);
    ASSERT_NEAR(forces[i], expected, 1e3 * 4e-5);  // straight lines: (omega dt)^2 / 12 of the amplitude
  }
}

/// A damper on a brace that is held after a sudden motion: with y = f / c and m = 1 / n, y' = -y^m / d, which has the
/// solution y^(1 - m) = y0^(1 - m) + (m - 1) t / d; exponential for n = 1.
TEST(BracedDamper, RelaxesAsItsEquationSays) {
  constexpr double kStretch_m = 0.004;
  constexpr double kHeld_m = 0.002;
  for (const double exponent : {0.4, 1.0, 1.8}) {
    const auto effect = made(kSpecimen, "nonlinear_viscous_damping", {3.0e4, exponent, kStretch_m});
    const auto forces = along(*effect, std::vector<double>(400, kHeld_m));
    const double m = 1.0 / exponent;
    // The first sample stretches the brace as it goes: what is left then is where the solution begins.
    const double start = forces.front() / 3.0e4;
    EXPECT_GT(start, 0.0);
    for (std::size_t i = 0; i < forces.size(); i += 20) {
      const double t = time_s(i);
      const double power = std::pow(start, 1.0 - m) + (m - 1.0) * t / kStretch_m;  // for n > 1 negative at rest
      const double expected =
          exponent == 1.0 ? start * std::exp(-t / kStretch_m) : std::pow(std::max(0.0, power), 1.0 / (1.0 - m));
      // Second order: 0.04 of the cube of a sample over the time constant, a quarter, in each sample, while the force
      // decays: 0.001 at most for n = 1, and twice that for other powers.
      ASSERT_NEAR(forces[i] / 3.0e4, expected, 0.002 * start) << exponent << ' ' << i;
    }
  }
}

/// Held still, the force becomes smaller than any number that is told from zero, and stays one.
TEST(BracedDamper, HasNoForceWhenHeldForLong) {
  for (const double exponent : {0.4, 1.0, 1.8}) {
    const auto effect = made(kSpecimen, "nonlinear_viscous_damping", {3.0e4, exponent, 1e-5});
    const auto forces = along(*effect, std::vector<double>(20000, 0.002));
    EXPECT_GT(forces.front(), 0.0) << exponent;
    // By the solution above, from a sudden motion on.
    const double expected_n = exponent < 1.0 ? 3.0e4 * std::pow(1.5 * time_s(20000) / 1e-5, -1.0 / 1.5) : 0.0;
    EXPECT_NEAR(forces.back(), expected_n, 0.01) << exponent;  // of 3e4 N; NaN is near nothing
  }
}

/// On a brace that hardly gives way it is the damper by itself, but for the time of half a sample.
TEST(BracedDamper, IsTheDamperOnARigidBrace) {
  const Driver driver = sine(0.01, 12.0);
  const auto braced = response(*made(kSpecimen, "nonlinear_viscous_damping", {3.0e4, 0.5, 1e-7}), driver, 600);
  const auto rigid = response(*made(kSpecimen, "nonlinear_viscous_damping", {3.0e4, 0.5, 0.0}), driver, 600);
  double squares = 0.0;
  double all = 0.0;
  for (std::size_t i = 1; i < rigid.size(); ++i) {
    squares += std::pow(braced[i] - rigid[i], 2);
    all += rigid[i] * rigid[i];
  }
  // The velocity over a sample is that of its middle: half a millisecond, at 12 rad/s, and more at each reversal.
  EXPECT_LT(std::sqrt(squares / all), 0.02);
}

/// Size and phase of a power law of the frequency, and its answer to a ramp, at several orders.
TEST(FractionalDamping, HasComplexStiffnessAndRampOfAPowerLaw) {
  for (const double order : {0.1, 0.35, 0.5, 0.65}) {
    const auto effect = made(kSpecimen, "fractional_damping", {1.0e5, order});
    std::vector<double> ramp_m;
    for (std::size_t i = 0; i <= 5000; ++i) ramp_m.push_back(0.01 * time_s(i));
    const auto on_ramp = along(*effect, ramp_m);
    for (std::size_t i = 200; i < on_ramp.size(); ++i) {
      const double expected_n =
          1.0e5 * 0.01 * std::pow(2.0 * kPi, -order) * std::pow(time_s(i), 1.0 - order) / std::tgamma(2.0 - order);
      ASSERT_NEAR(on_ramp[i] / expected_n, 1.0, 4e-4) << order;  // two fading springs a decade
    }
    for (const double frequency_hz : {1.0, 3.0}) {
      effect->reset();
      const auto forces = response(*effect, sine(0.01, 2.0 * kPi * frequency_hz), 20000);
      for (std::size_t i = 18000; i < forces.size(); ++i) {
        const double turn = 2.0 * kPi * frequency_hz * time_s(i);
        const double expected_n = 1.0e3 * std::pow(frequency_hz, order) * std::sin(turn + 0.5 * kPi * order);
        // The same, and half a sample of the share of a dashpot.
        ASSERT_NEAR(forces[i], expected_n, 1.0e3 * std::pow(frequency_hz, order) * 2e-3) << order;
      }
    }
  }
}

TEST(Fracture, RemovesItsShareFromItsTimeOn) {
  const auto effect = made(kSpecimen, "fracture", {0.4, 0.05});
  const auto forces = response(*effect, sine(1.0, 1.0), 100, [](const Motion&) { return 10.0; });
  EXPECT_EQ(forces[50], 10.0);
  EXPECT_NEAR(forces[51], 6.0, 1e-9);
  EXPECT_NEAR(forces[99], 6.0, 1e-9);
}

}  // namespace
}  // namespace hybridtest
