#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "core/config_error.hpp"
#include "recording/run_file_reader.hpp"
#include "tests/simulation/recorded_simulation.hpp"
#include "tests/unit/recording/temporary_directory.hpp"
#include "tests/unit/validation/studies/benchmark_motions.hpp"
#include "validation/studies/rths_benchmark/candidates.hpp"
#include "validation/studies/rths_benchmark/frame.hpp"
#include "validation/studies/rths_benchmark/recorded_run.hpp"
#include "validation/studies/rths_benchmark/virtual_run.hpp"

/// The scenarios of the benchmark, run in simulated time, against the structure without substructures.
namespace hybridtest::rths {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr double kToneHz = 2.0;
constexpr double kTonePeak = 1.0;  // [m/s2]
constexpr double kToneS = 6.0;

fs::path scenario_file(int case_number) {
  return fs::path{HYBRIDTEST_SOURCE_DIR} /
         ("launch/scenarios/rths_benchmark/case_" + std::to_string(case_number) + ".yaml");
}

double whole_mass_kg(int case_number) { return std::array{1000.0, 1100.0, 1300.0, 1000.0}.at(case_number - 1); }

std::string number(double value) { return std::to_string(value); }

/// A case under a tone instead of the motion, which is not part of this repository.
std::vector<std::string> under_a_tone(int case_number, double rate_hz) {
  const double whole_kg = whole_mass_kg(case_number);
  char influence[64];
  std::snprintf(influence, sizeof influence, "%.17g", whole_kg / (whole_kg - 29.13));
  char step[64];
  std::snprintf(step, sizeof step, "%.17g", 1.0 / rate_hz);
  return {"excitation={harmonic: {amplitude_m_per_s2: " + number(kTonePeak) + ", frequency_hz: " + number(kToneHz) +
              "}, influence: {floor_1: " + influence + ", floor_2: 1.0, floor_3: 1.0}}",
          "time={mode: lockstep, step_s: " + std::string{step} + ", duration_s: " + number(kToneS) + "}"};
}

/// No transfer system, and a specimen of the same mass, damping and stiffness.
std::vector<std::string> with_ideal_actuator(std::vector<std::string> overrides) {
  const std::string actuator = "substructures[actuator].";
  overrides.push_back(actuator +
                      "rig={type: simulated, transfer_system: {type: ideal}, specimen: {type: elastic, "
                      "stiffness_n_per_m: 1.190e6}, effects: [{interface: specimen, effect: inertia, mass_kg: 29.13}, "
                      "{interface: specimen, effect: viscous_damping, damping_n_s_per_m: 114.22}]}");
  overrides.push_back(actuator + "compensator={type: none}");
  overrides.push_back(actuator + "control_rate_hz=16384");
  return overrides;
}

GroundMotion tone() {
  constexpr double kDtS = 1.0 / 16384.0;
  GroundMotion motion{.dt_s = kDtS, .start_s = 0.0, .acceleration_m_per_s2 = {}};
  for (int i = 0; i <= static_cast<int>(kToneS / kDtS); ++i) {
    motion.acceleration_m_per_s2.push_back(kTonePeak * std::sin(2.0 * std::numbers::pi * kToneHz * kDtS * i));
  }
  return motion;
}

/// Runs a scenario into `directory`, as `hybridtest simulate` does.
void simulate_into(const fs::path& directory, int case_number, const std::vector<std::string>& overrides) {
  const Scenario scenario = read_scenario(scenario_file(case_number), overrides);
  prepare_run_directory(directory, scenario);
  RecordedSimulation simulation{scenario, directory, std::size_t{1} << 17U};
  ASSERT_EQ(simulation.run({}), StopReason::completed);
  ASSERT_EQ(simulation.dropped(), 0U);
}

class EachCase : public testing::TestWithParam<int> {
 protected:
  TemporaryDirectory directory_;
};

TEST_P(EachCase, CoordinatorAndFrameHoldAllButTheSpecimen) {
  const Scenario scenario = read_scenario(scenario_file(GetParam()), under_a_tone(GetParam(), 1024.0));
  Eigen::Matrix3d stiffness{scenario.structure.initial_stiffness_n_per_m};
  EXPECT_TRUE(Frame::of_case(GetParam())
                  .without({})
                  .equals(Eigen::Matrix3d{scenario.structure.mass_kg},
                          Eigen::Matrix3d{scenario.structure.damping_n_s_per_m},
                          stiffness - 1.190e6 * Eigen::Matrix3d{Eigen::Vector3d::UnitX().asDiagonal()}));
  const Eigen::VectorXd load = scenario.structure.mass_kg * scenario.excitation.records.at(0).influence;
  EXPECT_TRUE(load.isApprox(Eigen::VectorXd::Constant(3, whole_mass_kg(GetParam())), 1e-12)) << load;
}

TEST_P(EachCase, IdealActuatorGivesTheWholeStructure) {
  const Reference reference = make_reference(GetParam(), tone());
  const auto error_percent = [&](double rate_hz) {
    const fs::path run = directory_ / ("run_" + number(rate_hz));
    simulate_into(run, GetParam(), with_ideal_actuator(under_a_tone(GetParam(), rate_hz)));
    const RunFileReader coordinator{run_file(run, kCoordinatorId)};
    std::vector<double> found_m = coordinator.column("steps", "displacement_floor_3_m");
    Floors wanted_m = every(reference, static_cast<int>(kSampleRateHz / rate_hz));
    const std::size_t common = std::min(found_m.size(), wanted_m[2].size());
    EXPECT_GE(common, static_cast<std::size_t>(kToneS * rate_hz));
    found_m.resize(common);
    wanted_m[2].resize(common);
    return deviation_error_percent(found_m, wanted_m[2]);
  };
  const double at_1024_hz = error_percent(1024.0);
  const double at_2048_hz = error_percent(2048.0);
  std::printf("case %d: %.4f %% at 1024 Hz, %.4f %% at 2048 Hz\n", GetParam(), at_1024_hz, at_2048_hz);
  // The integrator's frequencies are (w dt)^2 / 24 too high; the rest is the inertia of the specimen from a motion that
  // is made of the steps, and of first order: it halves with the step, and the sum to a hundredth.
  EXPECT_LT(at_1024_hz, 0.05);
  EXPECT_NEAR(at_2048_hz / at_1024_hz, 0.5, 0.01);
}

TEST_P(EachCase, CompensatedActuatorStaysNearTheReference) {
  HYBRIDTEST_NEEDS_BENCHMARK_MOTIONS();
  const fs::path motion = benchmark_motions() / "rths_benchmark_elcentro.csv";
  simulate_into(directory_ / "run", GetParam(), {"excitation.ground_motion=" + motion.string()});
  const BenchmarkInputs inputs{benchmark_motions()};
  const RecordedRun run = read_recorded_run(directory_ / "run", inputs);
  std::printf("%s", recorded_markdown(std::vector{run}).c_str());
  EXPECT_EQ(run.case_number, GetParam());
  EXPECT_EQ(run.motion, 0U);
  EXPECT_EQ(run.samples_per_step, 4);
  EXPECT_TRUE(run.is_complete()) << run.steps << " of " << run.steps_wanted;
  EXPECT_EQ(run.bridged, 0U);
  EXPECT_LT(run.criteria.j(6), 1.0);
  EXPECT_LT(run.criteria.j(7), 1.0);
}

class RecordedRuns : public testing::Test {
 protected:
  void SetUp() override { HYBRIDTEST_NEEDS_BENCHMARK_MOTIONS(); }

  /// Five seconds, in which every motion has begun.
  [[nodiscard]] fs::path run(int case_number, const std::string& motion, const std::vector<std::string>& more = {}) {
    std::vector<std::string> overrides{
        "excitation.ground_motion=" + (benchmark_motions() / ("rths_benchmark_" + motion + ".csv")).string(),
        "time.duration_s=5.0"};
    overrides.insert(overrides.end(), more.begin(), more.end());
    fs::path directory = directory_ / ("run_" + std::to_string(runs_++));
    simulate_into(directory, case_number, overrides);
    return directory;
  }
  [[nodiscard]] std::string refusal(const fs::path& directory) const {
    try {
      static_cast<void>(read_recorded_run(directory, inputs()));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }
  [[nodiscard]] static const BenchmarkInputs& inputs() {
    static const BenchmarkInputs kept{benchmark_motions()};
    return kept;
  }

 private:
  TemporaryDirectory directory_;
  int runs_ = 0;
};

TEST_F(RecordedRuns, CaseMotionAndRateAreFound) {
  const RecordedRun found =
      read_recorded_run(run(3, "kobe", {"time.step_s=4.8828125e-4", "time.duration_s=5.0"}), inputs());
  EXPECT_EQ(found.case_number, 3);
  EXPECT_EQ(found.motion, 1U);
  EXPECT_EQ(found.rate_hz(), 2048.0);
  EXPECT_EQ(found.steps, 10241U);
  EXPECT_TRUE(std::isnan(found.lateness_us_p99)) << "the control loop had no thread of its own";
}

TEST_F(RecordedRuns, CriteriaAreThoseOfTheRecordedColumns) {
  const fs::path directory = run(1, "elcentro");
  const RunFileReader site{run_file(directory, "actuator")};
  const std::vector<double> target_m = site.column("steps", "target_displacement_m");
  const std::vector<double> measured_m = site.column("steps", "measured_displacement_m");
  ASSERT_EQ(target_m.size(), 5121U);
  double target_mean = 0.0, error_mean = 0.0, target_square = 0.0, error_square = 0.0;
  for (std::size_t i = 0; i < target_m.size(); ++i) {
    target_mean += target_m[i] / 5121.0;
    error_mean += (measured_m[i] - target_m[i]) / 5121.0;
  }
  for (std::size_t i = 0; i < target_m.size(); ++i) {
    target_square += std::pow(target_m[i] - target_mean, 2);
    error_square += std::pow(measured_m[i] - target_m[i] - error_mean, 2);
  }
  const RecordedRun found = read_recorded_run(directory, inputs());
  EXPECT_NEAR(found.criteria.j(2), 100.0 * std::sqrt(error_square / target_square), 1e-6 * found.criteria.j(2));
}

TEST_F(RecordedRuns, OtherTestsAreRefused) {
  EXPECT_THAT(refusal(run(1, "elcentro", {"structure.mass_kg.floor_2=1001.0"})), HasSubstr("those of no case"));
  EXPECT_THAT(refusal(run(1, "elcentro", {"excitation.scale=0.5"})), HasSubstr("none of the benchmark's times 0.4"));
  EXPECT_THAT(refusal(run(1, "elcentro", {"time.duration_s=0.015625"})), HasSubstr("none of the benchmark's times 0.4"))
      << "before it begins";
  EXPECT_THAT(refusal(run(1, "elcentro", {"time.step_s=0.001", "time.duration_s=5.0"})),
              HasSubstr("not a whole number of samples"));
}

TEST_F(RecordedRuns, TablesHoldTheFiguresOfEachRun) {
  const std::vector<RecordedRun> runs{read_recorded_run(run(2, "morgan"), inputs())};
  EXPECT_THAT(recorded_markdown(runs), HasSubstr("| 2, morgan, 1024 Hz | "));
  const std::string csv = recorded_csv(runs);
  EXPECT_THAT(csv, HasSubstr(",2,morgan,1024,"));
  const std::string head = csv.substr(0, csv.find('\n'));
  const std::string row = csv.substr(csv.find('\n'));
  EXPECT_EQ(std::ranges::count(head, ','), std::ranges::count(row, ','));
}

TEST_F(RecordedRuns, StudyAtItsOwnRateIsTheStudysRun) {
  const Candidate ours = chosen_candidates({std::string{kOurs}}).front();
  const Reference& reference = inputs().reference(1, 0);
  const TestResult study = run_virtual_test(
      {.case_number = 1, .motion = inputs().motion(0), .reference = reference, .plant = {}, .noise_seed = 1},
      *ours.make_path(), *ours.make_force_compensator());
  EXPECT_EQ(run_in_process(inputs(), 1, 0, 1, reference.samples()).values, study.criteria.values);
}

INSTANTIATE_TEST_SUITE_P(RthsScenarios, EachCase, testing::Values(1, 2, 3, 4),
                         [](const auto& number) { return "Case" + std::to_string(number.param); });

}  // namespace
}  // namespace hybridtest::rths
