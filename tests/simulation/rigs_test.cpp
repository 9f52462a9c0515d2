#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include "tests/simulation/drawn_case.hpp"
#include "tests/simulation/invariants.hpp"
#include "tests/simulation/kept_simulation.hpp"
#include "tests/unit/recording/temporary_directory.hpp"

/// Whole tests with rigs that replace another rig: the response of the structure must stay the same.
namespace hybridtest {
namespace {

const std::string kHalfASecond = "time.duration_s=0.5";
const std::string kSite = "substructures[storey_1].rig=";

KeptSimulation simulated(const std::string& rig) {
  return keep_simulation(shipped_scenario("two_storey_one_site", {kPulse, kHalfASecond, kSite + rig}), {});
}

TEST(Replay, RecordedForcesRepeatTheTest) {
  const KeptSimulation original = keep_simulation(shipped_scenario("two_storey_one_site", {kPulse, kHalfASecond}), {});
  // As `hybridtest export` writes the site's table.
  const TemporaryDirectory directory;
  const KeptRows& control = original.table("storey_1", "control");
  {
    std::ofstream file{directory / "control.csv"};
    file.precision(std::numeric_limits<double>::max_digits10);
    file << "time_s,measured_displacement_m,measured_force_n\n";
    const auto time_s = control.column_values("time_s");
    const auto displacement_m = control.column_values("measured_displacement_m");
    const auto force_n = control.column_values("measured_force_n");
    for (std::size_t row = 0; row < time_s.size(); ++row) {
      file << time_s[row] << ',' << displacement_m[row] << ',' << force_n[row] << '\n';
    }
  }
  const KeptSimulation replayed = simulated("{type: replay, recording: " + (directory / "control.csv").string() + "}");
  EXPECT_EQ(replayed.result.coordinator.reason, StopReason::completed) << replayed.log();
  EXPECT_EQ(history_violated(replayed, original), Violations{});
}

TEST(Replay, ShortRecordEndsTestByInterlock) {
  const TemporaryDirectory directory;
  std::ofstream{directory / "short.csv"} << "time_s,measured_displacement_m,measured_force_n\n0,0,0\n0.1,0,0\n";
  const std::string file = (directory / "short.csv").string();
  const KeptSimulation ended = simulated("{type: replay, recording: " + file + "}");
  EXPECT_EQ(ended.result.coordinator.reason, StopReason::interlock) << ended.log();
  EXPECT_EQ(ended.count(EventCode::interlock_tripped, "storey_1", "rig_fault"), 1U) << ended.log();
  const KeptSimulation held = simulated("{type: replay, recording: " + file + ", at_end: hold}");
  EXPECT_EQ(held.result.coordinator.reason, StopReason::completed) << held.log();
}

TEST(Geometry, TwoHalfSpecimensEqualOneWhole) {
  const std::string begin =
      "{type: simulated, transfer_system: {type: second_order, natural_frequency_hz: 15.0, "
      "damping_ratio: 0.9, delay_s: 0.004}, ";
  const KeptSimulation one = simulated(
      begin + "specimen: {type: bilinear, stiffness_n_per_m: 4.0e6, yield_force_n: 40.0e3, hardening_ratio: 0.05}}");
  const std::string half = "{type: bilinear, stiffness_n_per_m: 2.0e6, yield_force_n: 20.0e3, hardening_ratio: 0.05}";
  const KeptSimulation two =
      simulated(begin + "specimen: [" + half + ", " + half + "], geometry: {type: linear, matrix: [[1.0], [1.0]]}}");
  const auto displacement_m = [](const KeptSimulation& simulation) {
    return simulation.table("coordinator", "steps").column_values("displacement_floor_1_m");
  };
  const std::vector<double> expected = displacement_m(one);
  const std::vector<double> found = displacement_m(two);
  ASSERT_EQ(found.size(), expected.size());
  ASSERT_LT(*std::ranges::min_element(expected), -1e-3);
  // The rounding of the pose's least squares, 1e-16 of a displacement of some millimetres, 500 steps long.
  for (std::size_t i = 0; i < found.size(); ++i) ASSERT_NEAR(found[i], expected[i], 1e-15) << i;
  EXPECT_EQ(two.table("storey_1", "rig_actuators").size(), two.table("storey_1", "control").size());
}

}  // namespace
}  // namespace hybridtest
