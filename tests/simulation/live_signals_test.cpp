// What live views and reports show of a whole test, against what was recorded and against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "runtime/live/derived_signals.hpp"
#include "tests/simulation/kept_simulation.hpp"

namespace hybridtest::live_signals_test {
namespace {

/// Histories by name and subject.
using Histories = std::map<std::string, std::vector<double>>;

Histories histories(DerivedSignals& signals, const KeptRows& rows) {
  Histories result;
  const std::size_t width = rows.layout().columns.size();
  std::vector<double> values(signals.names().size());
  for (std::size_t row = 0; row < rows.size(); ++row) {
    signals.read(rows.values().subspan(row * width, width), values);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const SignalName& name = signals.names()[i];
      result[name.name + (name.subject.empty() ? "" : " " + name.subject)].push_back(values[i]);
    }
  }
  return result;
}

double peak(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double value : values) {
    if (std::isfinite(value)) largest = std::max(largest, std::fabs(value));
  }
  return largest;
}

class LiveSignalsTest : public testing::Test {
 protected:
  /// Two storeys of which both are tested, as they ship, for some seconds.
  void simulate(const std::vector<std::string>& more = {}) {
    std::vector<std::string> overrides{"time.duration_s=8.0"};
    overrides.insert(overrides.end(), more.begin(), more.end());
    scenario_ = shipped_scenario("two_storey_two_sites", overrides);
    run_ = keep_simulation(scenario_, {});
    const KeptRows& steps = run_.table("coordinator", "steps");
    structure_ = histories(*structure_signals(scenario_, steps.layout()), steps);
  }
  [[nodiscard]] Histories site(std::size_t index, bool interlocks) const {
    const SubstructureScenario& substructure = scenario_.substructures[index];
    const KeptRows& control = run_.table(substructure.id, "control");
    return histories(
        interlocks ? *interlock_signals(substructure, control.layout()) : *site_signals(substructure, control.layout()),
        control);
  }

  Scenario scenario_;
  KeptSimulation run_;
  Histories structure_;
};

TEST_F(LiveSignalsTest, DriftsAndBaseShearFollowFromTheRecord) {
  simulate();
  const KeptRows& steps = run_.table("coordinator", "steps");
  const auto first = steps.column_values("displacement_floor_1_m");
  const auto second = steps.column_values("displacement_floor_2_m");
  const auto force_1 = steps.column_values("restoring_force_floor_1_n");
  const auto force_2 = steps.column_values("restoring_force_floor_2_n");
  ASSERT_GT(peak(second), 0.01);
  const auto& drift = structure_.at("drift second_storey_columns floor_2_relative_to_floor_1");
  for (std::size_t i = 0; i < first.size(); i += 97) {
    EXPECT_EQ(structure_.at("displacement floor_2")[i], second[i]);
    EXPECT_EQ(structure_.at("drift first_storey_columns floor_1")[i], first[i]);
    EXPECT_DOUBLE_EQ(drift[i], second[i] - first[i]);
    EXPECT_DOUBLE_EQ(structure_.at("base_shear")[i], force_1[i] + force_2[i]);
  }
}

TEST_F(LiveSignalsTest, EnergyBalancesToTheErrorOfTheStep) {
  simulate();
  const double input_j = peak(structure_.at("input_energy"));
  ASSERT_GT(input_j, 1e3);
  // Central differences of 1 ms: (omega dt)^2 / 12 with the second mode at 20.7 rad/s is 4e-5; predicted velocities and
  // forces of the sites that were measured with noise take the rest.
  EXPECT_LT(peak(structure_.at("energy_balance_error")), 2e-3 * input_j);
}

TEST_F(LiveSignalsTest, ControlForceThatIsNotTheOneFeltIsSeen) {
  simulate();
  KeptRows steps = run_.table("coordinator", "steps");
  const std::size_t column = steps.column("restoring_force_floor_1_n");
  for (std::size_t row = 0; row < steps.size(); ++row) steps.at(row, column) *= 1.05;
  const Histories wrong = histories(*structure_signals(scenario_, steps.layout()), steps);
  EXPECT_GT(peak(wrong.at("energy_balance_error")), 5.0 * peak(structure_.at("energy_balance_error")));
}

TEST_F(LiveSignalsTest, InterlocksAreAsNearAsTheSignalsSay) {
  simulate();
  const Histories interlocks = site(0, true);
  const Histories signals = site(0, false);
  const double measured_m = peak(signals.at("measured_displacement floor_1"));
  const double target_m = peak(signals.at("target_displacement floor_1"));
  EXPECT_DOUBLE_EQ(peak(interlocks.at("displacement")), std::max(measured_m, target_m));
  EXPECT_DOUBLE_EQ(peak(interlocks.at("force")), peak(signals.at("force floor_1")));
  const auto signals_of =
      interlock_signals(scenario_.substructures[0], run_.table("first_storey_columns", "control").layout());
  const auto displacement = std::ranges::find(signals_of->names(), "displacement", &SignalName::name);
  ASSERT_NE(displacement, signals_of->names().end());
  EXPECT_EQ(displacement->limit, scenario_.substructures[0].site.loop.limits.displacement_m);
  EXPECT_EQ(displacement->unit, "m");
}

TEST_F(LiveSignalsTest, TrippedInterlockWasAtItsLimit) {
  simulate({"substructures[0].limits.displacement_m=0.03"});
  ASSERT_EQ(run_.result.coordinator.reason, StopReason::interlock);
  EXPECT_GT(peak(site(0, true).at("displacement")), 0.03);
}

TEST_F(LiveSignalsTest, EstimatedDelayIsThatOfTheTransferSystem) {
  // Nothing makes up for it. At low frequency a second-order system lags by 2 zeta / omega_n, here 1.1 ms. The least
  // squares see the delay T as sin(omega T) / omega, less by (omega T)^2 / 6, 0.3 % in the second mode (20.7 rad/s).
  simulate(
      {"substructures[0].rig.transfer_system={type: second_order, natural_frequency_hz: 200.0, damping_ratio: 0.7, "
       "delay_s: 0.005}",
       "substructures[0].compensator={type: none}",
       "substructures[0].rig.sensors={displacement_noise_m: 0.0, force_noise_n: 0.0}"});
  const auto delays = site(0, false).at("estimated_delay floor_1");
  const double delay_s = 0.005 + 2.0 * 0.7 / (2.0 * std::numbers::pi * 200.0);
  EXPECT_NEAR(delays.back(), delay_s, 0.01 * delay_s);
}

TEST_F(LiveSignalsTest, NoDelayIsEstimatedFromNoiseBeforeTheMotion) {
  simulate();
  const Histories signals = site(0, false);
  const auto& delays = signals.at("estimated_delay floor_1");
  EXPECT_TRUE(std::isnan(delays[100])) << "the ground is still at rest";
  // 0.01 mm of noise over a thousandth of 1.5 m/s is 7 ms in one sample.
  EXPECT_LT(peak(delays), 0.007);
  EXPECT_GT(std::ranges::count_if(delays, [](double delay_s) { return std::isfinite(delay_s); }), 10000);
}

}  // namespace
}  // namespace hybridtest::live_signals_test
