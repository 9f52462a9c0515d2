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
#include "validation/studies/rths_benchmark/frame.hpp"
#include "validation/studies/rths_benchmark/recorded_run.hpp"

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
  // The integrator's frequencies are (w dt)^2 / 24 too high; the rest is the inertia of the specimen from differences.
  EXPECT_LT(at_1024_hz, 0.05);
  EXPECT_LT(at_2048_hz, 0.5 * at_1024_hz);
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

INSTANTIATE_TEST_SUITE_P(RthsScenarios, EachCase, testing::Values(1, 2, 3, 4),
                         [](const auto& number) { return "Case" + std::to_string(number.param); });

}  // namespace
}  // namespace hybridtest::rths
