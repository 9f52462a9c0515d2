#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <ostream>
#include <string>
#include <tuple>
#include <vector>

#include "coordinator/excitation/read_ground_motion.hpp"
#include "core/random.hpp"
#include "diagnosis/intake/intake.hpp"
#include "diagnosis/runs/diagnose_site.hpp"
#include "diagnosis/runs/run_records.hpp"
#include "tests/simulation/kept_simulation.hpp"
#include "tests/simulation/recorded_simulation.hpp"
#include "tests/unit/recording/temporary_directory.hpp"

/// The specimen that is tested most: steel that yields, in the shipped two-storey building. The user takes it for a
/// spring, or for stronger than it is. What changes nothing in it changes nothing in the answer.
namespace hybridtest {
namespace {

constexpr double kStiffness_n_per_m = 4.0e6;
constexpr double kStrength_n = 40.0e3;
constexpr double kHardeningRatio = 0.05;
/// Of this test; with the whole motion, of 31 s, as in TheWholeTest.
constexpr double kDuration_s = 10.0;

/// How the same test was recorded, and what its user takes the stiffness for.
struct Recorded {
  std::string name;
  double metre = 1.0;  // of this test in metres of the plain one
  double newton = 1.0;
  double sign = 1.0;
  std::size_t every = 1;  // of the samples, one is kept
  double begins_s = 0.0;
  bool is_repeated = false;  // the ground motion comes a second time
  bool is_whole = false;     // the ground motion to its end
  double secants = 0.0;      // the user's stiffness, in secants to the largest displacement; 0: the real one
  int dofs = 1;              // the others are a spring that the model has
  std::size_t dof = 0;       // the archetype's place among them
  double stretched = 1.0;    // time stamps of a slow test, over those of this one; motion and force only
  bool has_steps = false;    // in the place of time stamps; likewise

  [[nodiscard]] bool is_slow() const noexcept { return stretched != 1.0 || has_steps; }
  friend void PrintTo(const Recorded& how, std::ostream* out) { *out << how.name; }
};

/// What the user believes, and what is to be found.
struct Belief {
  std::string name;
  std::string law;
  std::string_view effect;

  friend void PrintTo(const Belief& belief, std::ostream* out) { *out << belief.name; }
};

const Belief kElastic{"Elastic", "{{type: elastic, stiffness_n_per_m: {stiffness}}}", "yielding"};
const Belief kTooStrong{
    "TooStrong", "{{type: bilinear, stiffness_n_per_m: {stiffness}, yield_force_n: {strength}, hardening_ratio: 0.05}}",
    "strength_error"};

const std::vector<Recorded> kRecorded{
    {.name = "Plain"},
    {.name = "StrongerInSi", .newton = 100.0},
    {.name = "WeakerInSi", .newton = 0.01},
    {.name = "LongerInSi", .metre = 10.0},
    {.name = "ShorterAndWeakerInSi", .metre = 0.1, .newton = 1e-3},
    {.name = "OtherSign", .sign = -1.0},
    {.name = "HalfTheRate", .every = 2},
    {.name = "Twice", .is_repeated = true},
    {.name = "SinceTheEpoch", .begins_s = 1.7e9},
    {.name = "FirstOfTwoDofs", .dofs = 2},
    {.name = "SecondOfTwoDofs", .dofs = 2, .dof = 1},
    {.name = "PseudoTimeTwice", .stretched = 2.0},
    {.name = "PseudoTimeFortyTimes", .stretched = 40.0},
    {.name = "Steps", .has_steps = true},
};

const std::vector<Recorded> kBelieved{
    {.name = "ATenthOfTheSecant", .secants = 0.1},
    {.name = "TheSecant", .secants = 1.0},
    {.name = "ThreeSecants", .secants = 3.0},
    {.name = "TenSecants", .secants = 10.0},
};

class Archetype : public testing::TestWithParam<std::tuple<Belief, Recorded>> {
 protected:
  /// What the site recorded of the shipped test.
  [[nodiscard]] Recording tested(const Recorded& how) {
    std::vector<std::string> overrides;
    if (!how.is_whole) overrides.push_back(fmt::format("time.duration_s={}", (how.is_repeated ? 2 : 1) * kDuration_s));
    if (how.is_repeated) {
      overrides.push_back("excitation={ground_motion: " + repeated_motion().string() + ", scale: 1.0}");
    }
    const Scenario scenario = shipped_scenario("two_storey_one_site", overrides);
    prepare_run_directory(directory_ / "run", scenario);
    RecordedSimulation simulation{scenario, directory_ / "run", std::size_t{1} << 14U};
    SimulationSettings settings;
    settings.seed = 1;
    EXPECT_EQ(simulation.run(settings), StopReason::completed);
    return read_recording(directory_ / "run", RecordingRole::fit);
  }

  /// The first seconds of the shipped ground motion, twice.
  [[nodiscard]] std::filesystem::path repeated_motion() {
    const GroundMotion motion = read_ground_motion(std::filesystem::path{HYBRIDTEST_SOURCE_DIR} /
                                                   "launch/scenarios/ground_motions/design_ec8_c.AT2");
    const auto first = static_cast<std::size_t>(kDuration_s / motion.dt_s);
    std::filesystem::path file = directory_ / "twice.txt";
    std::ofstream out{file};
    out << "time_s acceleration_m_per_s2\n";
    for (std::size_t i = 0; i < 2 * first; ++i) {
      out << fmt::format("{:.3f} {:.9f}\n", motion.dt_s * static_cast<double>(i),
                         motion.acceleration_m_per_s2[i % first]);
    }
    return file;
  }

  TemporaryDirectory directory_;
};

/// The same recording as a file of another laboratory.
Recording as_recorded(const Recording& plain, const Recorded& how) {
  std::string text = how.has_steps ? "step" : "time_s";
  std::vector<Channel> channels;
  for (std::size_t i = 0; i < kChannels; ++i) {
    const auto channel = static_cast<Channel>(i);
    if (!plain.dofs[0].has(channel)) continue;
    // Of a slow test motion and force are recorded.
    if (how.is_slow() && channel < Channel::measured_displacement) continue;
    channels.push_back(channel);
  }
  for (int dof = 0; dof < how.dofs; ++dof) {
    for (const Channel channel : channels) {
      text += fmt::format(",{}{}", column_name(channel), how.dofs == 1 ? "" : fmt::format("_{}", dof + 1));
    }
  }
  text += "\n";
  Random random{3};
  for (std::size_t i = 0; i < plain.samples; i += how.every) {
    text += how.has_steps
                ? std::to_string(i + 1)
                : fmt::format("{:.9f}", how.begins_s + how.stretched * plain.sample_period_s * static_cast<double>(i));
    for (std::size_t dof = 0; dof < static_cast<std::size_t>(how.dofs); ++dof) {
      for (const Channel channel : channels) {
        double value = plain.dofs[0].of(channel)[i];
        const bool is_force = channel == Channel::measured_force;
        if (dof != how.dof && is_force) {
          value = kStiffness_n_per_m * plain.dofs[0].of(Channel::measured_displacement)[i] + 50.0 * random.normal();
        }
        text += fmt::format(",{}", how.sign * (is_force ? how.newton : how.metre) * value);
      }
    }
    text += "\n";
  }
  Intake intake = read_csv_recording(text, "recorded.csv");
  EXPECT_TRUE(intake.recording.has_value()) << intake.findings.front().text("recorded.csv");
  return intake.recording.value();
}

double largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

/// The user's model, of as many degrees of freedom as were recorded.
SiteModelFile believed(const Belief& belief, const Recorded& how, const Recording& recording,
                       const std::filesystem::path& file) {
  const double unit = how.newton / how.metre;
  double stiffness_n_per_m = kStiffness_n_per_m * unit;
  if (how.secants > 0.0) {
    const DofRecording& dof = recording.dofs[how.dof];
    stiffness_n_per_m =
        how.secants * largest(dof.of(Channel::measured_force)) / largest(dof.of(Channel::measured_displacement));
  }
  const auto law_of_dof = [&](std::size_t dof) {
    return dof == how.dof ? fmt::format(fmt::runtime(belief.law), fmt::arg("stiffness", stiffness_n_per_m),
                                        fmt::arg("strength", 1.25 * kStrength_n * how.newton))
                          : fmt::format("{{type: elastic, stiffness_n_per_m: {}}}", kStiffness_n_per_m * unit);
  };
  const std::string actuator = "{type: second_order, natural_frequency_hz: 15.0, damping_ratio: 0.9, delay_s: 0.004}";
  const std::string compensator = "{type: polynomial_displacement, order: 3, delay_s: 0.023}";
  std::string laws;
  std::string actuators;
  std::string compensators;
  for (std::size_t dof = 0; dof < static_cast<std::size_t>(how.dofs); ++dof) {
    const std::string comma = dof == 0 ? "" : ", ";
    laws += comma + law_of_dof(dof);
    actuators += comma + actuator;
    compensators += comma + compensator;
  }
  std::ofstream{file} << "compensator: [" << compensators << "]\nrig: {type: simulated, transfer_system: [" << actuators
                      << "], specimen: [" << laws << "]}\n";
  return read_site_model(file);
}

void expect_within(const report::RankedCause& cause, std::string_view name, double value) {
  const auto found = std::ranges::find(cause.parameters, name, &report::ReportedParameter::name);
  ASSERT_NE(found, cause.parameters.end()) << name;
  EXPECT_NEAR(found->value, value, 0.01 * std::abs(value)) << name;
}

TEST_P(Archetype, HasOneCause) {
  const auto& [belief, how] = GetParam();
  const Recording recording = as_recorded(tested(how), how);
  const SiteModelFile model = believed(belief, how, recording, directory_ / "model.yaml");
  DiagnoseSettings settings;
  settings.threads = 2;
  const SiteDiagnosis answer = diagnose_site(model, {&recording, 1}, settings);
  SCOPED_TRACE(summary_of(answer));
  const report::DiagnosisReport& report = answer.diagnosis.report;
  EXPECT_EQ(answer.dof, how.dof);
  EXPECT_EQ(report.verdict, report::Verdict::named);
  EXPECT_EQ(std::ranges::count_if(report.ranking, &report::RankedCause::is_cause), 1);
  ASSERT_FALSE(report.ranking.empty());
  const report::RankedCause& cause = report.ranking.front();
  EXPECT_EQ(cause.interface, "specimen");
  EXPECT_EQ(cause.effect, belief.effect);
  if (belief.effect == "yielding") {
    expect_within(cause, "stiffness_n_per_m", kStiffness_n_per_m * how.newton / how.metre);
    expect_within(cause, "yield_force_n", kStrength_n * how.newton);
    expect_within(cause, "hardening_ratio", kHardeningRatio);
  } else {
    expect_within(cause, "strength_error_ratio", -0.2);
  }
}

std::string name_of_case(const testing::TestParamInfo<std::tuple<Belief, Recorded>>& info) {
  return std::get<0>(info.param).name + std::get<1>(info.param).name;
}

INSTANTIATE_TEST_SUITE_P(Recorded, Archetype,
                         testing::Combine(testing::Values(kElastic, kTooStrong), testing::ValuesIn(kRecorded)),
                         name_of_case);

INSTANTIATE_TEST_SUITE_P(Believed, Archetype, testing::Combine(testing::Values(kElastic), testing::ValuesIn(kBelieved)),
                         name_of_case);

INSTANTIATE_TEST_SUITE_P(Whole, Archetype,
                         testing::Combine(testing::Values(kElastic, kTooStrong),
                                          testing::Values(Recorded{.name = "WholeTest", .is_whole = true})),
                         name_of_case);

}  // namespace
}  // namespace hybridtest
