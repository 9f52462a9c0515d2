#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "mechanics/structure/vibration_modes.hpp"
#include "tests/simulation/kept_simulation.hpp"

/// A space frame as OpenSees writes it, with rotations that have no mass, shaken in two directions.
namespace hybridtest {
namespace {

std::filesystem::path folder() {
  return std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "tests" / "reference" / "frame_3d";
}

/// The substructure is next to nothing: 1 N/m at a floor of 10 MN/m.
Scenario frame(const std::vector<std::string>& overrides) {
  return read_scenario(folder() / "frame_3d.yaml", overrides);
}

const std::array<std::string, 4> kDofs{"300.x", "300.y", "321.x", "321.y"};

/// Time, then the displacements of kDofs, every 0.05 s.
std::vector<std::array<double, 5>> reference() {
  std::ifstream file{folder() / "history.csv"};
  std::string line;
  std::getline(file, line);
  std::vector<std::array<double, 5>> rows;
  while (std::getline(file, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words{line};
    std::array<double, 5> row{};
    for (double& value : row) words >> value;
    rows.push_back(row);
  }
  return rows;
}

/// Largest distance at any of kDofs, as a share of its peak.
double worst_share_of_peak(const Scenario& scenario) {
  const KeptSimulation kept = keep_simulation(scenario, SimulationSettings{});
  EXPECT_EQ(kept.result.coordinator.reason, StopReason::completed);
  const std::vector<std::array<double, 5>> expected = reference();
  EXPECT_EQ(expected.size(), 200U);
  const auto every = static_cast<std::size_t>(std::lround(0.05 / scenario.time.step_s));
  double worst = 0.0;
  for (std::size_t k = 0; k < kDofs.size(); ++k) {
    const std::vector<double> found_m =
        kept.table("coordinator", "steps").column_values("displacement_" + kDofs[k] + "_m");
    double peak = 0.0;
    double distance = 0.0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      peak = std::max(peak, std::abs(expected[i][k + 1]));
      distance = std::max(distance, std::abs(found_m.at((i + 1) * every) - expected[i][k + 1]));
    }
    EXPECT_GT(peak, 0.04) << kDofs[k];
    worst = std::max(worst, distance / peak);
  }
  return worst;
}

TEST(SpaceFrame, HasTheFrequenciesOfTheProgramThatMadeIt) {
  const Scenario scenario = frame({});
  EXPECT_EQ(scenario.dofs.size(), 36U) << "108, of which 72 have no mass";
  const VibrationModes modes = vibration_modes(scenario.structure);
  // `eigen` of OpenSees [rad2/s2]; its matrices have 11 digits.
  const std::array<double, 6> eigenvalues{103.19930403, 116.92263005, 146.95028918,
                                          1221.3366323, 1322.8038014, 1355.1928700};
  for (std::size_t i = 0; i < eigenvalues.size(); ++i) {
    const double found = modes.frequency_rad_per_s[static_cast<Eigen::Index>(i)];
    EXPECT_NEAR(found * found / eigenvalues[i], 1.0, 1e-6) << i;
  }
}

TEST(SpaceFrame, MovesAsOpenSeesInBothDirectionsAtOnce) {
  // Measured 0.5e-4 of the peak. The period error (w dt)^2/24 of 0.5 ms, at 2 Hz over 10 s, gives 0.2e-3 of a radian;
  // the reference at 0.1 ms differs by 0.02e-4 from its own limit.
  EXPECT_LT(worst_share_of_peak(frame({"time.step_s=0.0005"})), 1e-4);
}

TEST(SpaceFrame, ErrorIsOfSecondOrder) {
  const double coarse = worst_share_of_peak(frame({"time.step_s=0.002"}));
  const double fine = worst_share_of_peak(frame({"time.step_s=0.001"}));
  EXPECT_NEAR(coarse / fine, 4.0, 0.5);
}

TEST(SpaceFrame, ControlOneDirectionAloneIsFarOff) {
  EXPECT_GT(worst_share_of_peak(frame({"excitation={ground_motion: x.txt, unit: m_per_s2, dt_s: 0.01, direction: x}"})),
            0.5);
}

}  // namespace
}  // namespace hybridtest
