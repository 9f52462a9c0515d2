#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <ostream>
#include <string>
#include <vector>

#include "core/interface_vector.hpp"
#include "tests/support/shear_frame.hpp"
#include "tests/support/system_fixture.hpp"
#include "tests/support/tall_tower.hpp"

/// The same scenario gives the same bytes over DDS in several processes and simulated in one.
namespace hybridtest {
namespace {

struct Shipped {
  std::string scenario;
  std::vector<std::string> sites;
  std::vector<std::string> numerical;
};

void PrintTo(const Shipped& shipped, std::ostream* stream) { *stream << shipped.scenario; }

class SameBits : public SystemTest {
 protected:
  /// Bit for bit, so that NaN equals NaN and 0 does not equal -0.
  void expect_same_column(const std::string& participant, const std::string& table, const std::string& column) const {
    const std::vector<double> over_dds = recorded("run").column(participant, table, column);
    const std::vector<double> simulated = recorded("simulated").column(participant, table, column);
    ASSERT_EQ(over_dds.size(), simulated.size()) << participant << "/" << table;
    for (std::size_t row = 0; row < over_dds.size(); ++row) {
      ASSERT_EQ(std::memcmp(&over_dds[row], &simulated[row], sizeof(double)), 0)
          << participant << "/" << table << "/" << column << ", row " << row << ": " << over_dds[row] << " and "
          << simulated[row];
    }
  }

  void expect_same_table(const std::string& participant, const std::string& table,
                         const std::vector<std::string>& but_for = {}) const {
    const RunFileReader file = recorded("run").open(participant);
    for (const TableLayout& layout : file.tables()) {
      if (layout.name != table) continue;
      for (const Column& column : layout.columns) {
        if (std::ranges::find(but_for, column.name) != but_for.end()) continue;
        expect_same_column(participant, table, column.name);
      }
    }
    EXPECT_GT(file.row_count(table), 0U) << participant << "/" << table;
  }
};

class Determinism : public SameBits, public ::testing::WithParamInterface<Shipped> {};

TEST_P(Determinism, RunAndSimulateGiveTheSameBits) {
  const std::filesystem::path scenario = shipped_scenario(GetParam().scenario);
  StartedProgram run = start_run(scenario, "run", {"--set", "time.duration_s=4"});
  StartedProgram simulated = start_simulate(scenario, "simulated", {"--set", "time.duration_s=4"});
  ASSERT_THAT(run.wait(), ::testing::Optional(kExitCompleted)) << run.standard_error();
  ASSERT_THAT(simulated.wait(), ::testing::Optional(kExitCompleted)) << simulated.standard_error();

  EXPECT_EQ(recorded("run").last_step("coordinator"), 4000.0);
  expect_same_table("coordinator", "steps", {"wall_time_s"});
  for (const std::string& site : GetParam().sites) {
    expect_same_table(site, "steps");
    expect_same_table(site, "control");
  }
  for (const std::string& numerical : GetParam().numerical) expect_same_table(numerical, "steps");
}

/// That its motion is right, MatrixStructure shows under simulated time.
TEST_F(SameBits, FrameOfTenThousandRunsAsItIsSimulated) {
  const std::filesystem::path scenario = test::shear_frame::write_files(directory());
  StartedProgram run = start_run(scenario, "run", {"--set", "time.duration_s=0.3"});
  StartedProgram simulated = start_simulate(scenario, "simulated", {"--set", "time.duration_s=0.3"});
  ASSERT_THAT(run.wait(), ::testing::Optional(kExitCompleted)) << run.standard_error();
  ASSERT_THAT(simulated.wait(), ::testing::Optional(kExitCompleted)) << simulated.standard_error();
  EXPECT_EQ(recorded("run").last_step("coordinator"), 300.0);
  expect_same_table("coordinator", "steps", {"wall_time_s"});
  for (const char* site : {"first", "second"}) expect_same_table(site, "control");
}

/// That such a tower moves right, WideInterface shows under simulated time. A command has 49 kB here.
TEST_F(SameBits, WidestInterfaceRunsAsItIsSimulated) {
  test::tall_tower::write_structure(directory(), kMaxInterfaceDofs);
  const std::filesystem::path scenario = test::tall_tower::write_scenario(directory(), "nothing", kMaxInterfaceDofs);
  StartedProgram run = start_run(scenario, "run", {});
  StartedProgram simulated = start_simulate(scenario, "simulated", {});
  ASSERT_THAT(run.wait(), ::testing::Optional(kExitCompleted)) << run.standard_error();
  ASSERT_THAT(simulated.wait(), ::testing::Optional(kExitCompleted)) << simulated.standard_error();
  EXPECT_EQ(recorded("run").last_step("coordinator"), 500.0);
  expect_same_table("coordinator", "steps", {"wall_time_s"});
  expect_same_table("columns", "steps");
}

/// The site without dynamics of its own. That the motion is right, tests/simulation/reference_test.cpp shows.
TEST_F(SameBits, ThreeSubstructuresMoveAsOneInProcess) {
  StartedProgram run = start_run(
      shipped_scenario("isolated_with_dampers"), "run",
      {"--set", "substructures[isolators].rig.transfer_system={type: ideal}", "--set",
       "substructures[isolators].rig.sensors={}", "--set", "substructures[isolators].compensator={type: none}", "--set",
       "substructures[isolators].control_rate_hz=1000"});
  StartedProgram simulated = start_simulate(system_scenario("isolated_in_one"), "simulated", {});
  ASSERT_THAT(run.wait(), ::testing::Optional(kExitCompleted)) << run.standard_error();
  ASSERT_THAT(simulated.wait(), ::testing::Optional(kExitCompleted)) << simulated.standard_error();
  EXPECT_EQ(recorded("run").last_step("coordinator"), 31000.0);
  expect_same_table("coordinator", "steps", {"wall_time_s"});
}

/// Two ground motions, a force and a release from a pulled specimen. That the motion is right, tests/simulation shows.
TEST_F(SameBits, EveryExcitationRunsAsItIsSimulated) {
  const std::filesystem::path scenario = shipped_scenario("two_storey_one_site");
  const std::vector<std::string> settings{
      "--set", "time.duration_s=1.5", "--set",
      "excitation={records: [{ground_motion: ground_motions/design_ec8_c.AT2, scale_to: {peak_g: 0.2}, baseline: "
      "linear}, "
      "{sweep: {amplitude_g: 0.02, from_hz: 1.0, to_hz: 4.0, duration_s: 0.5}, influence: {floor_2: 1.0}}], "
      "forces: [{harmonic: {amplitude_n: 500.0, frequency_hz: 2.0}, dof: floor_1}], "
      "free_vibration: {displacement_m: {floor_1: 0.005, floor_2: 0.01}, ramp_s: 0.6, hold_s: 0.4}}"};
  StartedProgram run = start_run(scenario, "run", settings);
  StartedProgram simulated = start_simulate(scenario, "simulated", settings);
  ASSERT_THAT(run.wait(), ::testing::Optional(kExitCompleted)) << run.standard_error();
  ASSERT_THAT(simulated.wait(), ::testing::Optional(kExitCompleted)) << simulated.standard_error();
  const auto floor_m = recorded("run").column("coordinator", "steps", "displacement_floor_2_m");
  ASSERT_EQ(floor_m.size(), 1501U);
  EXPECT_EQ(floor_m.front(), 0.0);
  EXPECT_EQ(floor_m[1000], 0.01);
  EXPECT_NE(floor_m.back(), 0.01) << "released";
  expect_same_table("coordinator", "steps", {"wall_time_s"});
  expect_same_table("coordinator", "ground_motions");
  expect_same_table("coordinator", "response_spectra");
  expect_same_table("storey_1", "control");
}

TEST_P(Determinism, ControlSensorSeedChangesTheRecords) {
  // Shows that the comparison can fail: noise is part of what is compared.
  const std::filesystem::path scenario = shipped_scenario(GetParam().scenario);
  StartedProgram one = start_simulate(scenario, "run", {"--set", "time.duration_s=1"});
  StartedProgram other = start_simulate(
      scenario, "simulated",
      {"--set", "time.duration_s=1", "--set", "substructures[" + GetParam().sites.front() + "].rig.sensors.seed=99"});
  ASSERT_THAT(one.wait(), ::testing::Optional(kExitCompleted)) << one.standard_error();
  ASSERT_THAT(other.wait(), ::testing::Optional(kExitCompleted)) << other.standard_error();
  const std::string column = recorded("run").open("coordinator").tables().front().columns.at(4).name;
  EXPECT_NE(recorded("run").column("coordinator", "steps", column),
            recorded("simulated").column("coordinator", "steps", column));
}

INSTANTIATE_TEST_SUITE_P(
    Shipped, Determinism,
    ::testing::Values(Shipped{"two_storey_one_site", {"storey_1"}, {"storey_2"}},
                      Shipped{"two_storey_two_sites", {"first_storey_columns", "second_storey_columns"}, {}},
                      Shipped{"three_storey_base_isolated", {"isolators"}, {"superstructure"}},
                      Shipped{"isolated_with_dampers", {"isolators"}, {"superstructure", "dampers"}}),
    [](const auto& instance) { return instance.param.scenario; });

}  // namespace
}  // namespace hybridtest
