// Formulas that a user suspects, tried by the diagnosis beside its library.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/config_error.hpp"
#include "diagnosis/page/diagnosis_json.hpp"
#include "diagnosis/page/wording.hpp"
#include "diagnosis/replay.hpp"
#include "diagnosis/runs/diagnose_site.hpp"
#include "scenario/catalogue/formula.hpp"
#include "tests/unit/diagnosis/answers.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

namespace hybridtest {
namespace {

using report::Verdict;
using testing::HasSubstr;

/// A damper whose oil gets thinner as it warms up, in its own way: from 20 to 60 °C and back within 5.3 s.
constexpr double kDamping_n_s_per_m = 1.0e5;
constexpr double kLoss_per_k = 0.03;
double temperature_c(double time_s) { return 40.0 - 20.0 * std::cos(2.0 * std::numbers::pi * time_s / 5.3); }
double heated_damper_n(double time_s) {
  return kDamping_n_s_per_m * std::exp(-kLoss_per_k * (temperature_c(time_s) - 20.0)) * made_velocity_m_per_s(time_s);
}

/// A damper that acts near the ends of the stroke only.
double end_damper_n(double time_s) {
  return 2.0e5 * std::pow(made_motion_m(time_s) / 0.02, 2) * made_velocity_m_per_s(time_s);
}

Recording recording_of(double (*added_force_n)(double), std::uint64_t seed = 3) {
  Recording recording = made_recording(
      made_motion_m, [&](double t) { return kMadeStiffness_n_per_m * made_motion_m(t) + added_force_n(t); }, 20.0,
      seed);
  std::vector<double> temperatures;
  for (std::size_t i = 0; i < recording.samples; ++i) {
    temperatures.push_back(temperature_c(kSitePeriod_s * static_cast<double>(i)));
  }
  recording.inputs.push_back({"temperature_c", temperatures});
  return recording;
}

const EffectType& heated_damper() {
  return formula_effect({.name = "heated_damper",
                         .added_force_n = "c_n_s_per_m * v * exp(-loss_per_k * (temperature_c - 20))",
                         .input = "temperature_c",
                         .numbers = {{.name = "c_n_s_per_m", .low = 0.0, .high = 1.0e6},
                                     {.name = "loss_per_k", .low = 0.0, .high = 0.2}}});
}

const EffectType& end_damper() {
  return formula_effect({.name = "end_damper",
                         .added_force_n = "c * x^2 * v",
                         .input = {},
                         .numbers = {{.name = "c", .low = -1.0e10, .high = 1.0e10}}});
}

SiteModel suspecting(const std::vector<const EffectType*>& formulas) {
  SiteModel model = made_model();
  model.suspected = formulas;
  return model;
}

void expect_inside(const report::ReportedParameter* parameter, double truth, double tolerance) {
  ASSERT_NE(parameter, nullptr);
  EXPECT_NEAR(parameter->value, truth, tolerance * truth);
}

/// The numbers come back within what the velocity from noisy readings leaves of doubt.
TEST(SuspectedFormula, IsNamedWithItsNumbers) {
  const Recording recording = recording_of(heated_damper_n);
  const Diagnosis diagnosis = diagnosis_of(suspecting({&heated_damper(), &end_damper()}), recording);
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named) << report::verdict_sentence(diagnosis.report);
  ASSERT_EQ(causes_of(diagnosis), std::vector<std::string>{"heated_damper:temperature_c"});
  const report::RankedCause& cause = diagnosis.report.ranking.front();
  expect_inside(find_parameter(cause, "c_n_s_per_m"), kDamping_n_s_per_m, 0.01);
  expect_inside(find_parameter(cause, "loss_per_k"), kLoss_per_k, 0.01);
  EXPECT_THAT(report::verdict_sentence(diagnosis.report), HasSubstr("heated damper"));
  EXPECT_THAT(diagnosis_json(diagnosis), HasSubstr("c_n_s_per_m * v * exp"));
  // The completed model replays the recording.
  SiteModel completed = made_model();
  add_effect(completed, diagnosis.causes.front());
  EXPECT_LT(replay(completed, recording, 0).back().nrmse, 0.002);
}

TEST(SuspectedFormula, ExplainsWhatTheLibraryDoesNot) {
  const Recording recording = recording_of(end_damper_n);
  const Diagnosis with = diagnosis_of(suspecting({&end_damper()}), recording);
  EXPECT_EQ(with.report.verdict, Verdict::named) << report::verdict_sentence(with.report);
  ASSERT_EQ(causes_of(with), std::vector<std::string>{"end_damper"});
  expect_inside(find_parameter(with.report.ranking.front(), "c"), 2.0e5 / std::pow(0.02, 2), 0.01);
  // The control: without the formula it is told otherwise, and more is left.
  const Diagnosis without = diagnosis_of(made_model(), recording);
  ASSERT_TRUE(with.report.interface_shrink.has_value());
  ASSERT_TRUE(without.report.interface_shrink.has_value());
  EXPECT_GT(without.report.interface_shrink->nrmse_after, 2.0 * with.report.interface_shrink->nrmse_after)
      << report::verdict_sentence(without.report);
}

/// The control: a formula that has nothing to do with the force changes no answer.
TEST(SuspectedFormula, IsNotNamedForAnotherEffect) {
  for (const std::uint64_t seed : {3U, 4U, 5U, 6U}) {
    const Recording recording = recording_of([](double t) { return 3.0e4 * made_velocity_m_per_s(t); }, seed);
    const Diagnosis with = diagnosis_of(suspecting({&heated_damper(), &end_damper()}), recording);
    const Diagnosis without = diagnosis_of(made_model(), recording);
    EXPECT_EQ(with.report.verdict, without.report.verdict);
    EXPECT_EQ(causes_of(with), causes_of(without));
    EXPECT_EQ(causes_of(with), std::vector<std::string>{"viscous_damping"});
  }
}

/// Where it has no value, another one is looked for: here below the lowest displacement it would be the root of a
/// negative number.
TEST(SuspectedFormula, IsFoundThoughItHasNoValueEverywhereInItsRange) {
  const auto added_n = [](double t) { return 2.0e5 * std::sqrt(made_motion_m(t) + 0.05); };
  const EffectType& root = formula_effect(
      {.name = "root",
       .added_force_n = "k * sqrt(x + start_m)",
       .input = {},
       .numbers = {{.name = "k", .low = 0.0, .high = 1.0e6}, {.name = "start_m", .low = -0.1, .high = 0.1}}});
  const Diagnosis diagnosis = diagnosis_of(suspecting({&root}), recording_of(added_n));
  ASSERT_EQ(causes_of(diagnosis), std::vector<std::string>{"root"}) << report::verdict_sentence(diagnosis.report);
  expect_inside(find_parameter(diagnosis.report.ranking.front(), "start_m"), 0.05, 0.02);
}

/// A range that ends short of the truth is said to be too short.
TEST(SuspectedFormula, AtTheEndOfItsRangeIsNoCertainCause) {
  const EffectType& weak = formula_effect({.name = "end_damper",
                                           .added_force_n = "c * x^2 * v",
                                           .input = {},
                                           .numbers = {{.name = "c", .low = 0.0, .high = 3.0e8}}});
  const Diagnosis diagnosis = diagnosis_of(suspecting({&weak}), recording_of(end_damper_n));
  EXPECT_THAT(causes_of(diagnosis), testing::Contains("end_damper"));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::partial);
  EXPECT_THAT(diagnosis.report.notes, testing::Contains(HasSubstr("limit of its search range")));
}

TEST(SuspectedFormula, ThatNeedsTimeIsNotTriedWithoutTime) {
  Recording recording = recording_of([](double) { return 0.0; });
  recording.is_quasi_static = true;
  const Diagnosis diagnosis = diagnosis_of(suspecting({&end_damper()}), recording);
  EXPECT_THAT(diagnosis.report.notes, testing::Contains(HasSubstr("because they need time: end_damper")));
}

TEST(SuspectedFormula, NeedsItsInputInARecording) {
  SiteModelFile model;
  model.dofs = {suspecting({&heated_damper()})};
  Recording recording = recording_of(heated_damper_n);
  EXPECT_NO_THROW(require_match(model, {&recording, 1}));
  recording.inputs.clear();
  try {
    require_match(model, {&recording, 1});
    FAIL() << "was accepted";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no recording has a column input_temperature_c"));
  }
}

TEST(SuspectedFormula, HasAnotherNameThanOneOfTheModel) {
  SiteModelFile model;
  model.dofs = {suspecting({&end_damper()})};
  model.dofs[0].effects.push_back({&end_damper(), {1.0}});
  const Recording recording = recording_of(end_damper_n);
  EXPECT_THROW(require_match(model, {&recording, 1}), ConfigError);
}

}  // namespace
}  // namespace hybridtest
