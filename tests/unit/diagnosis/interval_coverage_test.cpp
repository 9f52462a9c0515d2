#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "diagnosis/identification/effect_fit.hpp"
#include "tests/unit/diagnosis/made_noise.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

namespace hybridtest {
namespace {

using enum EffectInterface;

constexpr std::size_t kSamples = 2000;
constexpr double kPeriod_s = 0.004;

struct CoverageCase {
  EffectInterface interface;
  std::string_view effect;
  std::vector<double> values;  // the true ones
  double noise;                // [N] or [m]
  double correlation;          // of neighbouring samples of the noise
};

/// A recording of what the model with these effects predicts, and noise.
Recording recorded(const CoverageCase& one, const EffectSetting& truth, std::uint64_t draw) {
  Recording recording;
  recording.sample_period_s = kPeriod_s;
  recording.samples = kSamples;
  recording.dofs.resize(1);
  const bool is_force = one.interface == specimen;
  const Channel in = is_force ? Channel::measured_displacement : Channel::command_displacement;
  const Channel out = is_force ? Channel::measured_force : Channel::measured_displacement;
  for (std::size_t i = 0; i < kSamples; ++i) {
    recording.dofs[0].of(in).push_back(made_motion_m(kPeriod_s * static_cast<double>(i)));
  }
  recording.dofs[0].of(out).assign(kSamples, 0.0);
  std::vector<double> output =
      predict(made_model(), modelled_segments(made_model(), recording, 0, 0).front(), {&truth, 1});
  const std::vector<double> noise = made_noise({.correlation = one.correlation}, kSamples, one.noise, kPeriod_s, draw);
  for (std::size_t i = 0; i < kSamples; ++i) output[i] += noise[i];
  recording.dofs[0].of(out) = std::move(output);
  return recording;
}

TEST(IntervalCoverage, HoldsTheTruthIn95PercentOfDraws) {
  constexpr int kDraws = 100;
  const std::array cases{
      CoverageCase{specimen, "coulomb_friction", {5000.0, 0.0, 5e-4}, 800.0, 0.9},
      CoverageCase{specimen, "yielding", {1e4, 1e6, 20.0}, 800.0, 0.9},
      CoverageCase{transfer_system, "delay", {0.013}, 2e-4, 0.9},
      CoverageCase{transfer_system, "bandwidth", {0.012, 0.2}, 2e-4, 0.9},
  };
  double held = 0.0;
  double all = 0.0;
  for (const CoverageCase& one : cases) {
    const EffectSetting truth{.type = find_effect(one.interface, one.effect), .values = one.values};
    double of_case = 0.0;
    for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
      const Recording recording = recorded(one, truth, draw);
      const auto problem = make_problem(made_model(), modelled_segments(made_model(), recording, 0, 0));
      const ParameterEstimate first = refit_effects(problem, {truth}, false).parameters[0][0];
      of_case += std::abs(first.value - one.values[0]) <= half_width_95(first) ? 1.0 : 0.0;
    }
    // Of 100 draws three deviations are 6.5 %.
    EXPECT_NEAR(of_case / kDraws, 0.95, 0.065) << one.effect;
    held += of_case;
    all += kDraws;
  }
  // Of 400 two deviations are 2.2 %.
  EXPECT_NEAR(held / all, 0.95, 0.022);
  RecordProperty("coverage", std::to_string(held / all));
}

TEST(IntervalCoverage, QuantileIsStudents) {
  const auto quantile = [](double freedom) {
    return half_width_95({.value = 0.0, .standard_error = 1.0, .freedom = freedom});
  };
  EXPECT_NEAR(quantile(4.0), 2.776, 0.01);  // tables
  EXPECT_NEAR(quantile(11.0), 2.201, 0.002);
  EXPECT_NEAR(half_width_95({.standard_error = 1.0}), 1.96, 1e-9);
}

}  // namespace
}  // namespace hybridtest
