#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "mechanics/laws/bilinear.hpp"
#include "tests/simulation/kept_simulation.hpp"
#include "tests/support/reference_history.hpp"

/// Tests whose integrator iterates: the substructures are tried, and taken back, through the protocol.
namespace hybridtest {
namespace {

using std::chrono::microseconds;

Scenario iterated(const std::vector<std::string>& overrides = {}) {
  return read_scenario(
      std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "tests" / "system" / "scenarios" / "two_storey_iterated.yaml",
      overrides);
}

std::vector<double> floor_m(const KeptSimulation& run, int floor) {
  return run.table("coordinator", "steps").column_values("displacement_floor_" + std::to_string(floor) + "_m");
}

TEST(Iterated, AgreesWithOpenSeesWithinTheErrorOfItsOrder) {
  const ReferenceHistory reference = read_reference(committed_reference("two_storey_bilinear"));
  const KeptSimulation run = keep_simulation(iterated(), {});
  ASSERT_EQ(run.result.coordinator.reason, StopReason::completed) << run.log();
  for (const int floor : {1, 2}) {
    const std::vector<double> found_m = floor_m(run, floor);
    ASSERT_EQ(compared_samples(reference, found_m.size()), 3100U);
    const double share = largest_share(reference.displacement_m[static_cast<std::size_t>(floor - 1)], found_m);
    RecordProperty("share_of_peak_floor_" + std::to_string(floor), std::to_string(share));
    EXPECT_LT(share, 1.2e-4) << "measured 1.0e-4: twice the error of central differences";
  }
}

TEST(Iterated, EqualsTheIntegratorInProcess) {
  const Scenario scenario = iterated({"time.duration_s=8"});
  const std::vector<double> over_protocol_m = floor_m(keep_simulation(scenario, {}), 1);
  Bilinear columns{{.stiffness_n_per_m = 4.0e6, .yield_force_n = 40.0e3, .hardening_ratio = 0.05}};
  const auto force_n = [&](const MotionState& command) -> Eigen::VectorXd {
    const Eigen::VectorXd& u = command.displacement_m;
    const double lower_n = columns.trial(u[0], command.velocity_m_per_s[0]);
    const double upper_n = 3.0e6 * (u[1] - u[0]);
    return Eigen::Vector2d{lower_n - upper_n, upper_n};
  };
  const auto integrator = scenario.make_integrator();
  for (std::size_t step = 0; step < over_protocol_m.size(); ++step) {
    complete_step(*integrator, force_n,
                  scenario.structure.load_per_ground_acceleration_kg() *
                      scenario.excitation.records.front().acceleration_m_per_s2[step]);
    columns.commit();
    ASSERT_EQ(integrator->completed().displacement_m[0], over_protocol_m[step]) << "step " << step;
  }
}

TEST(Iterated, NetworkFaultsDoNotChangeABit) {
  const Scenario scenario = iterated({"time.duration_s=3"});
  const KeptSimulation sound = keep_simulation(scenario, {});
  ASSERT_EQ(sound.result.coordinator.reason, StopReason::completed) << sound.log();
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    SimulationSettings settings;
    settings.seed = seed;
    settings.network.latency = microseconds{500};
    settings.network.jitter = microseconds{3000};
    settings.network.reordering = 0.1;
    settings.network.loss = 0.02;
    settings.network.duplication = 0.3;
    const KeptSimulation faulty = keep_simulation(scenario, settings);
    ASSERT_EQ(faulty.result.coordinator.reason, StopReason::completed) << faulty.log();
    EXPECT_GT(faulty.result.network.lost, 50U);
    EXPECT_GT(faulty.result.network.duplicated, 500U);
    EXPECT_GT(faulty.result.network.reordered, 50U);
    for (const char* column :
         {"displacement_floor_1_m", "velocity_floor_2_m_per_s", "restoring_force_floor_1_n", "iterations"}) {
      EXPECT_EQ(faulty.table("coordinator", "steps").column_values(column),
                sound.table("coordinator", "steps").column_values(column))
          << column;
    }
    EXPECT_EQ(faulty.table("storey_1", "steps").column_values("force_floor_1_n"),
              sound.table("storey_1", "steps").column_values("force_floor_1_n"));
  }
}

TEST(Iterated, RecordsItsIterations) {
  const KeptSimulation run = keep_simulation(iterated({"time.duration_s=8"}), {});
  ASSERT_EQ(run.result.coordinator.reason, StopReason::completed);
  const std::vector<double> iterations = run.table("coordinator", "steps").column_values("iterations");
  ASSERT_EQ(iterations.size(), 8001U);
  EXPECT_EQ(iterations.front(), 0.0) << "the initial displacement is given";
  EXPECT_GE(*std::min_element(iterations.begin() + 1, iterations.end()), 1.0);
  EXPECT_LE(std::ranges::max(iterations), 6.0);
  EXPECT_EQ(run.table("storey_1", "steps").size(), 8001U) << "trials are no steps";
  // An exchange for each trial and one for the final displacement, of two substructures.
  const double exchanges = 2.0 * (8001.0 + std::accumulate(iterations.begin(), iterations.end(), 0.0));
  EXPECT_EQ(static_cast<double>(run.table("coordinator", "exchanges").size()), exchanges);
  EXPECT_EQ(std::ranges::max(run.table("coordinator", "exchanges").column_values("iteration")),
            std::ranges::max(iterations));
}

TEST(Iterated, StepWithoutEquilibriumEndsTheTest) {
  const KeptSimulation run = keep_simulation(
      iterated({"time.duration_s=8", "integrator={type: implicit_newmark, iterations_max: 1, tolerance_m: 1.0e-15}"}),
      {});
  EXPECT_EQ(run.result.coordinator.reason, StopReason::no_equilibrium);
  EXPECT_THAT(run.log(), testing::HasSubstr("no equilibrium after 1 trials"));
}

TEST(Iterated, DamperAndYieldingIsolatorConverge) {
  const Scenario scenario = read_scenario(
      std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "tests" / "system" / "scenarios" / "isolated_in_one.yaml",
      {"integrator={type: implicit_newmark}"});
  const KeptSimulation run = keep_simulation(scenario, {});
  ASSERT_EQ(run.result.coordinator.reason, StopReason::completed) << run.log();
  const ReferenceHistory reference = read_reference(committed_reference("isolated_with_dampers"));
  const auto& floors = scenario.structure.degrees_of_freedom;
  for (std::size_t floor = 0; floor < floors.size(); ++floor) {
    const double share =
        largest_share(reference.displacement_m[floor],
                      run.table("coordinator", "steps").column_values("displacement_" + floors[floor] + "_m"));
    RecordProperty(floors[floor] + "_share_of_peak", std::to_string(share));
    EXPECT_LT(share, 0.6e-4) << floors[floor] << ": measured 0.46e-4";
  }
}

}  // namespace
}  // namespace hybridtest
