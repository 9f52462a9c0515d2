#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/interface_vector.hpp"
#include "tests/simulation/kept_simulation.hpp"
#include "tests/support/tall_tower.hpp"
#include "tests/unit/recording/temporary_directory.hpp"

/// Numerical substructures with more interface degrees of freedom than a site may have.
namespace hybridtest {
namespace {

using namespace test::tall_tower;

/// Of an undamped tower under a ground acceleration that is linear between the steps, by its modes in closed form: each
/// is an oscillator, stepped exactly. Modes of a uniform shear building: sin((2 j - 1) pi i / (2 n + 1)).
class Modes {
 public:
  explicit Modes(int floors) : floors_{floors}, states_(static_cast<std::size_t>(floors)) {}

  void step(double from, double to, double dt) {
    for (int j = 1; j <= floors_; ++j) {
      State& state = states_[static_cast<std::size_t>(j - 1)];
      const double w = frequency(j);
      const double p = -participation(j);
      const double slope = p * (to - from) / dt;
      // u = c cos wt + s sin wt + (p from)/w2 + slope t / w2
      const double offset = p * from / (w * w);
      const double ramp = slope / (w * w);
      const double c = state.u - offset;
      const double s = (state.v - ramp) / w;
      state.u = c * std::cos(w * dt) + s * std::sin(w * dt) + offset + ramp * dt;
      state.v = -c * w * std::sin(w * dt) + s * w * std::cos(w * dt) + ramp;
    }
  }
  [[nodiscard]] double displacement_m(int floor) const {
    double sum = 0.0;
    for (int j = 1; j <= floors_; ++j) sum += states_[static_cast<std::size_t>(j - 1)].u * shape(j, floor);
    return sum;
  }

 private:
  struct State {
    double u = 0.0;
    double v = 0.0;
  };
  [[nodiscard]] double angle(int j) const { return (2 * j - 1) * std::numbers::pi / (2 * floors_ + 1); }
  [[nodiscard]] double frequency(int j) const {
    return 2.0 * std::sqrt(kStorey_n_per_m / kMass_kg) * std::sin(0.5 * angle(j));
  }
  [[nodiscard]] double shape(int j, int floor) const { return std::sin(angle(j) * floor); }
  [[nodiscard]] double participation(int j) const {
    double along = 0.0;
    double square = 0.0;
    for (int floor = 1; floor <= floors_; ++floor) {
      along += shape(j, floor);
      square += shape(j, floor) * shape(j, floor);
    }
    return along / square;
  }

  int floors_;
  std::vector<State> states_;
};

/// The tower with its columns in a substructure of `floors` interface degrees of freedom.
Scenario tower(const TemporaryDirectory& directory, int floors, const std::string& step_s) {
  write_structure(directory.path(), floors);
  return read_scenario(write_scenario(directory.path(), "nothing", floors), {"time.step_s=" + step_s});
}

double worst_share_of_peak(const Scenario& scenario, int floors) {
  const KeptSimulation kept = keep_simulation(scenario, SimulationSettings{});
  EXPECT_EQ(kept.result.coordinator.reason, StopReason::completed);
  const std::vector<double> found_m =
      kept.table("coordinator", "steps").column_values("displacement_floor_" + std::to_string(floors / 4) + "_m");
  EXPECT_EQ(found_m.size(), static_cast<std::size_t>(scenario.time.last_step) + 1);
  const std::vector<double>& ground_m_per_s2 = scenario.excitation.records.front().acceleration_m_per_s2;
  Modes modes{floors};
  double worst = 0.0;
  double peak = 0.0;
  for (std::size_t i = 0; i < found_m.size(); ++i) {
    const double expected_m = modes.displacement_m(floors / 4);
    peak = std::max(peak, std::abs(expected_m));
    worst = std::max(worst, std::abs(found_m[i] - expected_m));
    if (i + 1 < found_m.size()) {
      modes.step(ground_m_per_s2[i], ground_m_per_s2[i + 1], scenario.time.step_s);
    }
  }
  EXPECT_GT(peak, 1e-3);
  return worst / peak;
}

TEST(WideInterface, TowerMovesAsItsModes) {
  constexpr int kFloors = 80;
  const TemporaryDirectory directory;
  const double at_1_ms = worst_share_of_peak(tower(directory, kFloors, "0.001"), kFloors);
  const double at_half_ms = worst_share_of_peak(tower(directory, kFloors, "0.0005"), kFloors);
  EXPECT_LT(at_half_ms, 5e-4);
  EXPECT_NEAR(at_1_ms / at_half_ms, 4.0, 0.4) << "second order: " << at_1_ms << " and " << at_half_ms;
}

TEST(WideInterface, LargestRecordsWhatTheCoordinatorRecords) {
  const TemporaryDirectory directory;
  const Scenario scenario = tower(directory, kMaxInterfaceDofs, "0.002");
  ASSERT_EQ(scenario.substructures.front().interface.size(), kMaxInterfaceDofs);
  SimulationSettings settings;
  const KeptSimulation kept =
      keep_simulation(scenario, settings, [](const CoordinatorReport& report) { return report.completed_steps > 50; });
  const std::vector<double> from_columns = kept.table("columns", "steps").column_values("displacement_floor_1_m");
  const std::vector<double> from_coordinator =
      kept.table("coordinator", "steps").column_values("displacement_floor_1_m");
  ASSERT_GT(from_columns.size(), 40U);
  for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(from_columns[i], from_coordinator[i]) << i;
  EXPECT_NE(from_columns[39], 0.0);
}

}  // namespace
}  // namespace hybridtest
