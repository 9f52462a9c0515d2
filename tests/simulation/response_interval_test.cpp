#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "core/random.hpp"
#include "diagnosis/identification/effect_fit.hpp"
#include "diagnosis/identification/smoothing_choice.hpp"
#include "diagnosis/runs/rerun.hpp"
#include "diagnosis/runs/run_records.hpp"
#include "diagnosis/tuning.hpp"
#include "plant/effects/effect_type.hpp"
#include "tests/simulation/kept_simulation.hpp"
#include "tests/simulation/recorded_simulation.hpp"
#include "tests/unit/recording/temporary_directory.hpp"

/// Floor and intervals of the response of the whole test, in closed loop: noise of the site's sensors enters the
/// structure, and the completed model has the right form.
namespace hybridtest {
namespace {

using enum EffectInterface;

const std::string kActuator =
    "transfer_system: {type: second_order, natural_frequency_hz: 15.0, damping_ratio: 0.9, delay_s: 0.004}, ";
const std::string kSpringLaw = "specimen: {type: elastic, stiffness_n_per_m: 4.0e6}";
const std::string kYieldingLaw =
    "specimen: {type: bilinear, stiffness_n_per_m: 4.0e6, yield_force_n: 40.0e3, hardening_ratio: 0.05}";

/// A site that lacks one effect in its model.
struct Site {
  std::string specimen;
  std::vector<EffectSetting> missing;
  std::vector<EffectSetting> hidden{};  // likewise, and no cause names it
  double displacement_noise_m = 1.0e-5;
  double force_noise_n = 50.0;
  double force_coloured_noise_n = 0.0;
  double force_correlation_time_s = 0.01;
};

std::string in_words(const std::vector<EffectSetting>& effects) {
  std::string text;
  for (const EffectSetting& effect : effects) {
    text += fmt::format("{}{{interface: {}, effect: {}", text.empty() ? "" : ", ", name_of(effect.type->interface),
                        effect.type->name);
    for (std::size_t i = 0; i < effect.values.size(); ++i) {
      text += fmt::format(", {}: {}", effect.type->parameters[i].name, effect.values[i]);
    }
    text += "}";
  }
  return ", effects: [" + text + "]";
}

bool holds(const report::Interval& interval, double value) { return value >= interval.low && value <= interval.high; }

/// The nrmse of a quiet test and one with noise, from their recordings.
double difference(const std::filesystem::path& noisy, const std::filesystem::path& quiet) {
  const Scenario scenario = read_scenario(noisy / "scenario.yaml", {});
  return response_error(recorded_response(noisy, scenario), recorded_response(quiet, scenario)).nrmse;
}

class ResponseInterval : public testing::Test {
 protected:
  /// Runs the test with the real site.
  std::filesystem::path tested(const Site& site, std::uint64_t seed, double duration_s = 6.0) {
    std::vector<EffectSetting> effects = site.missing;
    effects.insert(effects.end(), site.hidden.begin(), site.hidden.end());
    const std::string rig = fmt::format(
        "substructures[storey_1].rig={{type: simulated, {}{}{}, sensors: {{displacement_noise_m: {}, "
        "force_noise_n: {}, force_coloured_noise_n: {}, force_correlation_time_s: {}, seed: {}}}}}",
        kActuator, site.specimen, in_words(effects), site.displacement_noise_m, site.force_noise_n,
        site.force_coloured_noise_n, site.force_correlation_time_s, seed);
    const Scenario scenario =
        shipped_scenario("two_storey_one_site", {rig, fmt::format("time.duration_s={}", duration_s),
                                                 "substructures[storey_1].limits.force_n=500.0e3",
                                                 "substructures[storey_1].limits.energy_error_ratio=100.0"});
    std::filesystem::path run = directory_ / std::to_string(runs_++);
    prepare_run_directory(run, scenario);
    RecordedSimulation simulation{scenario, run, std::size_t{1} << 14U};
    SimulationSettings settings;
    settings.seed = 1;
    EXPECT_EQ(simulation.run(settings), StopReason::completed);
    return run;
  }

  /// The user's model, without the effect.
  SiteModelFile model_of(const Site& site, const std::filesystem::path& run, const std::string& sensors = {}) {
    const std::filesystem::path file = directory_ / "model.yaml";
    std::ofstream{file} << "rig: {type: simulated, " << kActuator << site.specimen << sensors << "}\n";
    return read_model_for({&run, 1}, file, {});
  }

  static report::ResponseShrink response_with(const SiteDiagnosis& found, const SiteModelFile& model,
                                              const std::filesystem::path& run) {
    SiteDiagnosis diagnosis = found;
    add_response(diagnosis, model, run, {}, run / "scenario.yaml", {});
    EXPECT_TRUE(diagnosis.diagnosis.report.response_shrink.has_value()) << diagnosis.diagnosis.report.why_no_response;
    return diagnosis.diagnosis.report.response_shrink.value_or(report::ResponseShrink{});
  }

  /// As the right model of the site leaves it in 24 tests, over the floor of the first.
  double left_over_floor(const Site& site) {
    constexpr int kSeeds = 24;
    Site quiet = site;
    quiet.force_noise_n = quiet.force_coloured_noise_n = quiet.displacement_noise_m = 0.0;
    const std::filesystem::path without = tested(quiet, 1);
    const std::filesystem::path first = tested(site, 101);
    SiteDiagnosis right;
    right.diagnosis.causes = site.missing;
    const report::ResponseShrink response = response_with(right, model_of(site, first), first);
    EXPECT_NEAR(response.nrmse_after, difference(first, without), 1e-9);
    double squares = 0.0;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      squares += std::pow(difference(tested(site, 100 + seed), without), 2) / kSeeds;
    }
    return std::sqrt(squares) / response.floor_nrmse.value();
  }

  TemporaryDirectory directory_;
  int runs_ = 0;
};

const Site kSpring{kSpringLaw, {{find_effect(specimen, "viscous_damping"), {20.0e3}}}};
const Site kYields{kYieldingLaw, {{find_effect(specimen, "viscous_damping"), {20.0e3}}}};
const Site kRubs{kSpringLaw, {{find_effect(specimen, "coulomb_friction"), {6000.0, 0.0, 5.0e-4, 0.0}}}};
const Site kRubsAndYields{kYieldingLaw, {{find_effect(specimen, "coulomb_friction"), {6000.0, 0.0, 1.0e-5, 0.0}}}};

std::string name_of_site(const Site& site) {
  return std::string{site.missing[0].type->name} + (site.specimen == kYieldingLaw ? "_beside_yielding" : "");
}

/// At the control rate, 1024 Hz, neighbouring readings are correlated by 0.9.
const double kNineTenths_s = -1.0 / (1024.0 * std::log(0.9));

TEST_F(ResponseInterval, FloorIsWhatTheRightModelLeaves) {
  for (const Site& site : {kSpring, kYields, kRubs, kRubsAndYields}) {
    const double ratio = left_over_floor(site);
    // Noise moves a specimen that yields for good: one number for each test, of which 24 are known to 14 %, as well as
    // the floor of 39. Three deviations of both are a half; over 40 tests the ratios came out at 0.94 to 1.14.
    EXPECT_GT(ratio, 0.7) << site.specimen << in_words(site.missing);
    EXPECT_LT(ratio, 1.4) << site.specimen << in_words(site.missing);
    RecordProperty(name_of_site(site), std::to_string(ratio));
  }
}

TEST_F(ResponseInterval, FloorHoldsColouredNoiseOfTheLoadCell) {
  for (Site site : {kSpring, kYields, kRubs, kRubsAndYields}) {
    site.force_coloured_noise_n = std::exchange(site.force_noise_n, 0.0);
    site.force_correlation_time_s = kNineTenths_s;
    const double ratio = left_over_floor(site);
    // As above. With a floor of white noise alone they were 22.7, 26.8, 24.1 and 1.14.
    EXPECT_GT(ratio, 0.7) << site.specimen << in_words(site.missing);
    EXPECT_LT(ratio, 1.4) << site.specimen << in_words(site.missing);
    RecordProperty(name_of_site(site), std::to_string(ratio));
  }
}

TEST_F(ResponseInterval, FloorOfASpringIsProportionalToTheNoise) {
  Site noisier = kSpring;
  noisier.force_noise_n *= 10.0;
  const auto floor_of = [&](const Site& site) {
    SiteDiagnosis right;
    right.diagnosis.causes = site.missing;
    const std::filesystem::path run = tested(site, 1);
    return response_with(right, model_of(site, run), run).floor_nrmse.value();
  };
  // The noise of 6000 samples is known to a hundredth.
  EXPECT_NEAR(floor_of(noisier) / floor_of(kSpring), 10.0, 0.3);
}

TEST_F(ResponseInterval, NoiseOfTheModelIsNotCounted) {
  const std::filesystem::path run = tested(kRubs, 1, 3.0);
  SiteDiagnosis right;
  right.diagnosis.causes = kRubs.missing;
  const SiteModelFile silent = model_of(kRubs, run);
  const report::ResponseShrink response = response_with(right, silent, run);
  const SiteModelFile loud = model_of(kRubs, run, ", sensors: {force_noise_n: 2.0e3, seed: 1}");
  EXPECT_EQ(loud.dofs.front().noise.force_noise_n, 2.0e3) << "control";
  const report::ResponseShrink beside_loud = response_with(right, loud, run);
  EXPECT_EQ(beside_loud.nrmse_after, response.nrmse_after);
  EXPECT_EQ(beside_loud.floor_nrmse, response.floor_nrmse);
}

TEST_F(ResponseInterval, WrongParameterWithoutDoubtMissesThePeak) {
  const std::filesystem::path run = tested(kRubs, 1);
  SiteDiagnosis wrong;
  wrong.diagnosis.causes = kRubs.missing;
  wrong.diagnosis.causes[0].values[0] *= 1.1;
  const report::ResponseShrink response = response_with(wrong, model_of(kRubs, run), run);
  for (const report::PredictedNumber& peak : response.peaks) {
    EXPECT_FALSE(holds(peak.ci95, peak.recorded)) << peak.of;
    EXPECT_TRUE(holds(peak.ci95, peak.predicted)) << peak.of;
  }
  EXPECT_TRUE(holds(response.peak_error_after_ci95.value(), response.peak_error_after)) << "what is unknown comes back";
  EXPECT_GT(response.unknown_share.value(), 0.001);
  EXPECT_TRUE(holds(response.ci95.value(), response.variance_removed)) << "what is unknown comes back";
  // Known no better than that.
  wrong.diagnosis.doubts = {Eigen::Vector3d{600.0 * 600.0, 0.0, 0.0}.asDiagonal()};
  for (const report::PredictedNumber& peak : response_with(wrong, model_of(kRubs, run), run).peaks) {
    EXPECT_TRUE(holds(peak.ci95, peak.recorded)) << "control: " << peak.of;
  }
}

/// What a diagnosis finds that knows the effects: fitted to the recording of the site, with their intervals.
SiteDiagnosis fitted_with(const SiteModelFile& model, const std::filesystem::path& run,
                          const std::vector<EffectSetting>& effects) {
  const Recording recording = read_recording(run, RecordingRole::fit);
  const SiteModel& dof = model.dofs.front();
  IdentificationProblem problem =
      judged_at(make_problem(dof, modelled_segments(dof, recording, 0, 0)), Channel::measured_force);
  settle_noise(problem, refit_effects(problem, effects, false));
  const FitOutcome fit = refit_effects(problem, effects, false);
  SiteDiagnosis found;
  found.diagnosis.causes = fit.effects;
  found.diagnosis.doubts = {covariance_for_draws(fit)};
  return found;
}

/// Counts how often intervals hold what they are intervals of.
struct Coverage {
  int held = 0;
  int all = 0;
  void add(const report::Interval& interval, double value) {
    held += holds(interval, value) ? 1 : 0;
    ++all;
  }
  [[nodiscard]] double share() const { return held / static_cast<double>(all); }
};

/// The size of the effect and the noise are drawn. In 20 of 40 the stiffness is off besides, which a diagnosis
/// corrects; in 16 a cubic stiffness of up to the size of the noise is hidden.
Site drawn_site(std::uint64_t draw) {
  Random random{41, draw};
  Site site = std::vector<Site>{kSpring, kYields, kRubs, kRubsAndYields}[draw % 4];
  site.missing[0].values[0] *= random.uniform(0.5, 2.0);
  const double noise = std::pow(10.0, random.uniform(-0.5, 1.0));
  site.force_noise_n *= noise;
  site.displacement_noise_m *= noise;
  const double off = random.uniform(-0.05, 0.05);
  if (draw / 4 % 2 == 1) {
    const bool yields = site.specimen == kYieldingLaw;
    site.missing.push_back(
        {find_effect(specimen, "stiffness_error"), {yields ? off : 0.0, yields ? 0.0 : off * 4.0e6}});
  }
  // At 5 cm, about the largest displacement of these tests.
  const double as_noise_n_per_m3 = site.force_noise_n / std::pow(0.05, 3);
  if (draw / 8 % 2 == 1) {
    site.hidden = {{find_effect(specimen, "cubic_stiffness"), {random.uniform(0.0, 1.0) * as_noise_n_per_m3}}};
  }
  return site;
}

/// Parameters from one recording; intervals of another test of the same site.
TEST_F(ResponseInterval, HoldsAHeldOutTestInNineOfTenDraws) {
  constexpr std::uint64_t kDraws = 40;
  Coverage peaks;
  Coverage energy;
  Coverage removed;
  Coverage left;
  Coverage peak_error;
  Coverage energy_error;
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    const Site site = drawn_site(draw);
    const std::filesystem::path run = tested(site, 2 * draw + 1);
    const std::filesystem::path again = tested(site, 2 * draw + 2);
    const SiteModelFile model = model_of(site, run);
    const report::ResponseShrink response = response_with(fitted_with(model, run, site.missing), model, again);
    for (const report::PredictedNumber& peak : response.peaks) peaks.add(peak.ci95, peak.recorded);
    energy.add(response.energy_taken.value().ci95, response.energy_taken.value().recorded);
    removed.add(response.ci95.value(), response.variance_removed);
    left.add(response.nrmse_after_ci95.value(), response.nrmse_after);
    peak_error.add(response.peak_error_after_ci95.value(), response.peak_error_after);
    energy_error.add(response.energy_error_after_ci95.value(), response.energy_error_after.value());
  }
  // 95 % in the long run, or more: of 40, one and a half deviations below are 0.90. More is no error: the draws allow
  // for a misfit that most of these sites do not have.
  for (const auto& [what, coverage] : {std::pair{"peaks", peaks},
                                       {"energy", energy},
                                       {"removed", removed},
                                       {"left", left},
                                       {"peak_error", peak_error},
                                       {"energy_error", energy_error}}) {
    EXPECT_GE(coverage.share(), 0.9) << what;
    RecordProperty(what, std::to_string(coverage.share()));
  }
}

}  // namespace
}  // namespace hybridtest
