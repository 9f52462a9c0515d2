#include "diagnosis/diagnose.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "compensation/polynomial_displacement.hpp"
#include "diagnosis/verdict/where.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

namespace hybridtest {
namespace {

using report::Verdict;

double spring_n(double time_s) { return kMadeStiffness_n_per_m * made_motion_m(time_s); }

DiagnoseSettings one_thread() {
  DiagnoseSettings settings;
  settings.threads = 1;
  return settings;
}

Diagnosis diagnosis_of(const Recording& recording) { return diagnose(made_model(), {&recording, 1}, one_thread()); }

bool has_cause(const Diagnosis& diagnosis, std::string_view interface, std::string_view effect) {
  return std::ranges::any_of(diagnosis.report.ranking, [&](const report::RankedCause& cause) {
    return cause.is_cause && cause.interface == interface && cause.effect == effect;
  });
}

TEST(Diagnose, FindsNothingWhenModelAndRecordingAgree) {
  const Diagnosis diagnosis = diagnosis_of(made_recording(made_motion_m, spring_n));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::none);
  EXPECT_TRUE(diagnosis.causes.empty());
}

TEST(Diagnose, NamesViscousForceAtSpecimen) {
  const auto velocity = [](double t) { return (made_motion_m(t + 1e-5) - made_motion_m(t - 1e-5)) / 2e-5; };
  const Diagnosis diagnosis =
      diagnosis_of(made_recording(made_motion_m, [&](double t) { return spring_n(t) + 3.0e4 * velocity(t); }));
  ASSERT_FALSE(diagnosis.report.where.empty());
  EXPECT_EQ(diagnosis.report.where.front().interface, "specimen");
  EXPECT_GT(diagnosis.report.where.front().share, 0.95);
  EXPECT_TRUE(has_cause(diagnosis, "specimen", "viscous_damping"));
  EXPECT_GT(diagnosis.report.interface_shrink->explainable_fraction.value(), 0.99);
}

/// The force by differences over the whole past (Grünwald and Letnikov), at a quarter of the sample period.
TEST(Diagnose, NamesFractionalDampingAndItsOrder) {
  constexpr double kOrder = 0.4;
  constexpr double kStiffness_at_1_hz = 3.0e5;
  constexpr double kStep_s = kSitePeriod_s / 4.0;
  std::vector<double> past_m;
  std::vector<double> weights{1.0};
  const auto derivative = [&](double time_s) {
    const auto count = static_cast<std::size_t>(std::lround(time_s / kStep_s)) + 1;
    while (past_m.size() < count) past_m.push_back(made_motion_m(kStep_s * static_cast<double>(past_m.size())));
    while (weights.size() < count) {
      weights.push_back(weights.back() * (1.0 - (kOrder + 1.0) / static_cast<double>(weights.size())));
    }
    const double sum = std::inner_product(weights.begin(), weights.begin() + static_cast<std::ptrdiff_t>(count),
                                          past_m.rend() - static_cast<std::ptrdiff_t>(count), 0.0);
    return sum / std::pow(kStep_s, kOrder);
  };
  const double scale = kStiffness_at_1_hz / std::pow(2.0 * std::numbers::pi, kOrder);
  const Diagnosis diagnosis =
      diagnosis_of(made_recording(made_motion_m, [&](double t) { return spring_n(t) + scale * derivative(t); }));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
  ASSERT_TRUE(has_cause(diagnosis, "specimen", "fractional_damping"));
  const auto& parameters = diagnosis.report.ranking.front().parameters;
  // The differences are late by kOrder * kStep_s / 2, 1.4 mrad at 2.3 Hz: of a quarter turn that is 0.001.
  EXPECT_NEAR(parameters[1].value, kOrder, 0.01);
  EXPECT_NEAR(parameters[0].value, kStiffness_at_1_hz, 0.03 * kStiffness_at_1_hz);
}

TEST(Diagnose, NamesCoarseConverterBesideBias) {
  Recording recording = made_recording(made_motion_m, [](double t) { return spring_n(t) + 900.0; });
  double largest = 0.0;
  for (const double force_n : recording.dofs[0].of(Channel::measured_force)) {
    largest = std::max(largest, std::abs(force_n));
  }
  const double step_n = 0.05 * largest;
  for (double& force_n : recording.dofs[0].of(Channel::measured_force)) {
    force_n = step_n * std::round(force_n / step_n);
  }
  const Diagnosis diagnosis = diagnosis_of(recording);
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
  EXPECT_TRUE(has_cause(diagnosis, "force_sensor", "quantization"));
  EXPECT_TRUE(has_cause(diagnosis, "force_sensor", "bias"));
  EXPECT_EQ(diagnosis.report.where.front().interface, "force_sensor");
  ASSERT_EQ(diagnosis.causes.size(), 2U);
  EXPECT_NEAR(diagnosis.causes.back().values[0], step_n, 1e-3 * step_n) << "coarsened last";
}

TEST(Diagnose, ReturnsCandidateSetForAnElasticSpecimen) {
  // Of a linear spring a load cell that reads a tenth too much and a spring that is a tenth stiffer are the same.
  const Diagnosis diagnosis = diagnosis_of(made_recording(made_motion_m, [](double t) { return 1.1 * spring_n(t); }));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::set);
  EXPECT_TRUE(has_cause(diagnosis, "specimen", "stiffness_error"));
  EXPECT_TRUE(has_cause(diagnosis, "force_sensor", "gain"));
  EXPECT_FALSE(diagnosis.report.next_experiment.empty());
}

TEST(Diagnose, SeparatesSensorFromActuatorByForce) {
  // The transducer reads a tenth too much of a motion that is as commanded: the force knows.
  const Diagnosis diagnosis = diagnosis_of(made_recording([](double t) { return 1.1 * made_motion_m(t); }, spring_n));
  EXPECT_TRUE(has_cause(diagnosis, "displacement_sensor", "gain"));
  EXPECT_FALSE(has_cause(diagnosis, "transfer_system", "gain"));
  EXPECT_EQ(diagnosis.report.where.front().interface, "displacement_sensor");
  // Actuator and specimen are judged with the transducer's gain taken off, and are as modelled.
  for (const char* stage : {"transfer_system", "specimen"}) {
    const auto gap = std::ranges::find(diagnosis.report.where, stage, &report::InterfaceGap::interface);
    ASSERT_NE(gap, diagnosis.report.where.end()) << stage;
    EXPECT_TRUE(gap->is_judged) << stage;
    EXPECT_EQ(gap->share, 0.0) << stage;
    EXPECT_FALSE(gap->is_at_fault) << stage;
  }
}

/// The transducer reads half a millimetre too much, and the specimen meets a stop on either side.
TEST(Diagnose, WhatASensorDoesNotExplainOfTheForceIsTheSpecimens) {
  const auto share_of_specimen = [](double stop_n_per_m) {
    const auto force_n = [=](double t) {
      return spring_n(t) + stop_n_per_m * (made_motion_m(t) - std::clamp(made_motion_m(t), -0.012, 0.012));
    };
    const Recording recording = made_recording([](double t) { return made_motion_m(t) + 5e-4; }, force_n);
    const IdentificationProblem problem = make_problem(made_model(), segments_of(recording, 0, 0));
    const EffectType* const bias = find_effect(EffectInterface::displacement_sensor, "bias");
    const FitOutcome found = refit_effects(problem, {{bias, {0.0}}}, false);
    const auto where = locate(problem, fit_nothing(problem, false), found, 1);
    const auto gap = std::ranges::find(where, "specimen", &report::InterfaceGap::interface);
    return gap == where.end() ? 0.0 : gap->share;
  };
  EXPECT_GT(share_of_specimen(3.0 * kMadeStiffness_n_per_m), 0.5);
  EXPECT_EQ(share_of_specimen(0.0), 0.0);  // control: the force of a spring knows of the transducer
}

/// It moves a thousandth of its command, and not as commanded.
TEST(Diagnose, StuckActuatorIsFoundAtTheTransferSystem) {
  const auto creeps_m = [](double t) { return 6e-4 * (made_motion_m(t) + made_motion_m(0.55 * t)); };
  const Diagnosis diagnosis =
      diagnosis_of(made_recording(creeps_m, [&](double t) { return kMadeStiffness_n_per_m * creeps_m(t); }));
  ASSERT_FALSE(diagnosis.report.where.empty());
  EXPECT_TRUE(diagnosis.report.where.front().verdict == Verdict::unknown);
  EXPECT_EQ(diagnosis.report.where.front().interface, "transfer_system");
  EXPECT_GT(diagnosis.report.where.front().share, 0.99);
  EXPECT_FALSE(has_cause(diagnosis, "transfer_system", "gain"));
}

/// A force in which nothing but noise is seen says nothing of how well a cause does elsewhere.
TEST(Diagnose, JudgesCauseWhereThereIsAGap) {
  const auto read_m = [](double t) { return made_motion_m(t) + 0.002; };
  std::vector<Recording> recordings(2, made_recording(
                                           read_m, [](double) { return 0.0; }, 1.0));
  recordings[1].role = RecordingRole::held_out;
  SiteModel model = made_model();
  model.make_law = nullptr;
  model.effects.push_back({find_effect(EffectInterface::specimen, "inertia"), {1e-3}});
  const Diagnosis diagnosis = diagnose(model, recordings, one_thread());
  EXPECT_EQ(diagnosis.report.verdict, Verdict::named);
  EXPECT_TRUE(has_cause(diagnosis, "displacement_sensor", "bias"));
  EXPECT_GT(diagnosis.report.interface_shrink->variance_removed, 0.999);
}

/// What fits one recording and not the other explains neither; that the other one has no gap does not take the first
/// away.
TEST(Diagnose, ClearGapThatARecordingHeldOutDoesNotHaveIsUnknown) {
  const auto rubs_n = [](double t) { return spring_n(t) + std::copysign(5.0e3, made_velocity_m_per_s(t)); };
  std::vector<Recording> recordings{made_recording(made_motion_m, rubs_n), made_recording(made_motion_m, spring_n)};
  recordings[1].role = RecordingRole::held_out;
  const Diagnosis diagnosis = diagnose(made_model(), recordings, one_thread());
  EXPECT_EQ(diagnosis.report.verdict, Verdict::unknown);
  recordings[1] = recordings[0];  // control
  recordings[1].role = RecordingRole::held_out;
  EXPECT_TRUE(has_cause(diagnose(made_model(), recordings, one_thread()), "specimen", "coulomb_friction"));
}

/// 20 ms more than is believed: a first-order change of the command would be far off.
TEST(Diagnose, FindsActualCompensatorSetting) {
  const auto compensator = [](double delay_s) {
    return std::make_unique<PolynomialDisplacement>(PolynomialDisplacement::Parameters{.order = 2, .delay_s = delay_s},
                                                    kSitePeriod_s);
  };
  SiteModel model = made_model();
  model.make_compensator = [&](double, double delay_change_s) { return compensator(0.030 + delay_change_s); };
  model.compensator_delay = {.set_s = 0.030, .most_s = 1.0};
  Recording recording = made_recording(made_motion_m, spring_n);
  DofRecording& dof = recording.dofs[0];
  const auto real = compensator(0.050);
  for (const double command_m : dof.of(Channel::command_displacement)) {
    dof.of(Channel::target_displacement).push_back(command_m);
  }
  for (std::size_t i = 0; i < recording.samples; ++i) {
    dof.of(Channel::command_displacement)[i] = real->command({.target_m = dof.of(Channel::target_displacement)[i]});
    dof.of(Channel::measured_displacement)[i] = dof.of(Channel::command_displacement)[i];
    dof.of(Channel::measured_force)[i] = kMadeStiffness_n_per_m * dof.of(Channel::measured_displacement)[i];
  }
  const Diagnosis diagnosis = diagnose(model, {&recording, 1}, one_thread());
  ASSERT_TRUE(has_cause(diagnosis, "compensator", "setting_mismatch"));
  // Its points move by whole samples of 2 ms, in between the search is by derivatives.
  EXPECT_NEAR(diagnosis.causes[0].values[0], 0.020, 1e-5);
  // The real one's order was lower until its points lay in the record: a part that the setting does not explain, and
  // that stands above the floor of a recording without noise.
  EXPECT_EQ(diagnosis.report.verdict, Verdict::partial);
  EXPECT_GT(diagnosis.report.interface_shrink->variance_removed, 0.999);
}

/// A force that comes back with the place: no effect has such waves.
TEST(Diagnose, SaysUnknownWhenNoEffectFits) {
  const Diagnosis diagnosis = diagnosis_of(made_recording(
      made_motion_m, [](double t) { return spring_n(t) + 2000.0 * std::sin(made_motion_m(t) / 0.002); }));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::unknown);
  EXPECT_TRUE(diagnosis.causes.empty());
  ASSERT_EQ(diagnosis.report.where.front().interface, "specimen");
  const std::optional<report::Recurrence>& seen = diagnosis.report.where.front().recurrence;
  ASSERT_TRUE(seen);
  EXPECT_TRUE(seen->follows_motion);
  // Straight between 12 knots over the stroke, the best function by least squares removes 0.84.
  EXPECT_NEAR(seen->removed_by_function, 0.84, 0.02);
  EXPECT_THAT(diagnosis.report.next_experiment, testing::StartsWith("Slow cycles"));
}

/// Like hum, it does not follow from the motion: no model could reproduce it.
TEST(Diagnose, DisturbanceApartFromTheMotionIsNone) {
  const Diagnosis diagnosis = diagnosis_of(
      made_recording(made_motion_m, [](double t) { return spring_n(t) + 2000.0 * std::sin(40.0 * t + std::sin(t)); }));
  EXPECT_EQ(diagnosis.report.verdict, Verdict::none);
}

TEST(Diagnose, ForceAloneIsNotSufficient) {
  Recording recording = made_recording(made_motion_m, spring_n);
  recording.dofs[0].of(Channel::command_displacement).clear();
  recording.dofs[0].of(Channel::measured_displacement).clear();
  EXPECT_EQ(diagnosis_of(recording).report.verdict, Verdict::not_excited);
}

TEST(Diagnose, ReportsProgressOfEveryStage) {
  const Recording recording = made_recording(made_motion_m, [](double t) {
    const double step_m = made_motion_m(t + 1e-4) - made_motion_m(t);
    // The echo is left: what is searched last is searched, too.
    const double echo_n = t > 0.3 ? 0.03 * spring_n(t - 0.3) : 0.0;
    return 1.2 * spring_n(t) + (step_m > 0.0 ? 3000.0 : -3000.0) + 2.0e4 * step_m / 1e-4 + echo_n;
  });
  for (const std::size_t threads : {1U, 2U}) {
    std::vector<ProgressReport> reports;
    DiagnoseSettings settings;
    settings.threads = threads;
    settings.progress = PartProgress{[&](const ProgressReport& report) { reports.push_back(report); }};
    EXPECT_GT(diagnose(made_model(), {&recording, 1}, settings).causes.size(), 1U);
    ASSERT_FALSE(reports.empty());
    EXPECT_EQ(reports.front().share, 0.0);
    EXPECT_LE(reports.back().share, 1.0);
    EXPECT_TRUE(std::ranges::is_sorted(reports, {}, &ProgressReport::share));
    std::vector<std::string_view> stages;
    for (const ProgressReport& report : reports) {
      EXPECT_LE(report.done, report.all) << report.stage;
      if (std::ranges::find(stages, report.stage) == stages.end()) stages.push_back(report.stage);
    }
    EXPECT_THAT(stages, testing::ElementsAre("recordings examined", "effects fitted one by one",
                                             "effects fitted at the full rate", "further effects screened",
                                             "effects searched together", "effects fitted together at the full rate",
                                             "laws of isolators and dampers", "combinations of the causes",
                                             "effects compared with the causes", "curves computed"));
  }
}

TEST(PartProgress, SharesOfPartsLieInTheWhole) {
  double share = -1.0;
  const PartProgress whole{[&](const ProgressReport& report) { share = report.share; }};
  whole.part(0.2, 0.6).round(1, 2).report("fits", 1, 4);
  EXPECT_DOUBLE_EQ(share, 0.45);
  whole.part(0.2, 0.6).report("fits", 0, 0);  // nothing to do is done
  EXPECT_DOUBLE_EQ(share, 0.6);
  PartProgress{}.round(0, 2).report("fits", 1, 1);  // to nobody
  EXPECT_DOUBLE_EQ(share, 0.6);
}

TEST(PartProgress, ShareStaysWhereASearchStartsAgain) {
  ProgressReport last;
  const PartProgress whole{[&](const ProgressReport& report) { last = report; }};
  whole.report("fits", 3, 4);
  whole.report("fits", 1, 4);
  EXPECT_EQ(last.done, 1U);
  EXPECT_EQ(last.share, 0.75);
  whole.report("fits", 4, 4);
  EXPECT_EQ(last.share, 1.0);
}

TEST(PartProgress, RepeatsReportAfterASecondOfSilence) {
  Instant now{};
  std::vector<ProgressReport> reports;
  const PartProgress whole{[&](const ProgressReport& report) { reports.push_back(report); }, [&] { return now; }};
  whole.alive();  // nothing to repeat yet
  now += std::chrono::seconds{5};
  whole.alive();
  EXPECT_TRUE(reports.empty());
  const PartProgress part = whole.part(0.5, 1.0);
  part.report("fits", 1, 2);
  for (int i = 0; i < 100; ++i) {  // ten seconds of predictions
    now += std::chrono::milliseconds{100};
    part.alive();
  }
  ASSERT_EQ(reports.size(), 11U);
  for (std::size_t i = 0; i < reports.size(); ++i) {
    EXPECT_EQ(reports[i].stage, "fits");
    EXPECT_EQ(reports[i].share, 0.75);
    EXPECT_EQ(reports[i].predictions, 2 + 10 * i);
  }
}

/// With a clock that goes on by a tenth of a second with every prediction, whatever a fit does in between.
TEST(Diagnose, IsNeverSilentForTwoSeconds) {
  const Recording recording = made_recording(made_motion_m, [](double t) { return 1.2 * spring_n(t); });
  std::atomic<int> reads = 0;
  const auto now = [&] { return Instant{} + std::chrono::milliseconds{100 * ++reads}; };
  Instant last{};
  Duration longest{};
  bool is_repeated = false;
  DiagnoseSettings settings;
  settings.progress = PartProgress{[&, shown = ProgressReport{}](const ProgressReport& report) mutable {
                                     const Instant at = Instant{} + std::chrono::milliseconds{100 * reads};
                                     longest = std::max(longest, Duration{at - last});
                                     last = at;
                                     is_repeated =
                                         is_repeated || (report.stage == shown.stage && report.done == shown.done &&
                                                         report.predictions > shown.predictions);
                                     shown = report;
                                   },
                                   now};
  EXPECT_FALSE(diagnose(made_model(), {&recording, 1}, settings).causes.empty());
  EXPECT_GT(reads, 1000);
  EXPECT_TRUE(is_repeated);
  EXPECT_LE(longest, std::chrono::seconds{2});
}

}  // namespace
}  // namespace hybridtest
