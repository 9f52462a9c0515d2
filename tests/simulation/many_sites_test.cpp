#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "tests/simulation/kept_simulation.hpp"
#include "tests/unit/recording/temporary_directory.hpp"
#include "transport/simulated/site_latencies.hpp"

/// Tests with as many sites as the protocol allows, and with more.
namespace hybridtest {
namespace {

constexpr int kManySitesSteps = 60;
constexpr Duration kLatency = std::chrono::milliseconds{10};

constexpr double kManySitesStep_s = 0.001;
constexpr double kStoreyMass_kg = 20.0e3;
constexpr double kStoreyStiffness_n_per_m = 4.0e6;
constexpr std::string_view kShaken = "{forces: [{harmonic: {amplitude_n: 1.0e3, frequency_hz: 5.0}, dof: floor_1}]}";

/// A shear building, each storey a substructure.
Scenario storeys(int count, const std::filesystem::path& file, int steps = kManySitesSteps,
                 std::string_view excitation = kShaken) {
  std::ofstream text{file};
  text << "schema: hybridtest/1\nname: storeys\ntime: {mode: lockstep, step_s: 0.001, duration_s: "
       << steps * kManySitesStep_s << "}\nexcitation: " << excitation << "\n"
       << "structure:\n  degrees_of_freedom: [";
  for (int i = 1; i <= count; ++i) text << (i == 1 ? "" : ", ") << "floor_" << i;
  text << "]\n  mass_kg: {";
  for (int i = 1; i <= count; ++i) text << (i == 1 ? "" : ", ") << "floor_" << i << ": 20.0e3";
  text << "}\n  damping: {type: none}\nintegrator: {type: central_difference}\nsubstructures:\n";
  for (int i = 1; i <= count; ++i) {
    text << "  - id: storey_" << i << "\n    kind: numerical\n    interface: [{dof: floor_" << i;
    if (i > 1) text << ", relative_to: floor_" << i - 1;
    text << "}]\n    model: {type: elastic, stiffness_n_per_m: 4.0e6}\n";
  }
  text.close();
  return read_scenario(file, {});
}

SimulationSettings wide_area() {
  SimulationSettings settings;
  settings.network.latency = kLatency;
  settings.clock_drift_ppm_max = 0.0;
  return settings;
}

/// Time that each step took under simulated time [s].
std::vector<double> step_times_s(const KeptSimulation& simulation) {
  const std::vector<double> begin_s = simulation.table("coordinator", "steps").column_values("wall_time_s");
  std::vector<double> times_s;
  for (std::size_t i = 1; i < begin_s.size(); ++i) times_s.push_back(begin_s[i] - begin_s[i - 1]);
  return times_s;
}

/// Far more than the nanoseconds by which nodes run after each other, far less than any latency.
constexpr double kMoment_s = 1e-6;

TEST(ManySites, StepOf32TakesOneRoundTripAsThatOfOne) {
  const TemporaryDirectory folder;
  for (const int count : {1, 32}) {
    const KeptSimulation simulation = keep_simulation(storeys(count, folder / "storeys.yaml"), wide_area());
    ASSERT_EQ(simulation.result.coordinator.reason, StopReason::completed) << simulation.log();
    const std::vector<double> times_s = step_times_s(simulation);
    ASSERT_EQ(times_s.size(), static_cast<std::size_t>(kManySitesSteps));
    for (const double time_s : times_s) ASSERT_NEAR(time_s, to_seconds(2 * kLatency), kMoment_s) << count << " sites";
  }
}

TEST(ManySites, StepTakesAsLongAsTheSlowestOf32) {
  constexpr double kPause_s = 0.15;
  const TemporaryDirectory folder;
  SimulationSettings settings = wide_area();
  // Two machines stand still at the same time, in the middle of the test: the step takes the longer one, not the sum.
  const Duration begin = std::chrono::milliseconds{1400};
  settings.pauses.push_back({"storey_7", begin, begin + from_seconds(kPause_s)});
  settings.pauses.push_back({"storey_30", begin, begin + from_seconds(0.8 * kPause_s)});
  const KeptSimulation simulation = keep_simulation(storeys(32, folder / "storeys.yaml"), settings);
  ASSERT_EQ(simulation.result.coordinator.reason, StopReason::completed) << simulation.log();
  std::vector<double> times_s = step_times_s(simulation);
  const auto slowest = std::ranges::max_element(times_s);
  // The command came at any time within one round trip after the begin.
  EXPECT_GE(*slowest, kPause_s - kMoment_s);
  EXPECT_LE(*slowest, kPause_s + to_seconds(2 * kLatency) + kMoment_s);
  times_s.erase(slowest);
  for (const double time_s : times_s) ASSERT_NEAR(time_s, to_seconds(2 * kLatency), kMoment_s);
}

/// Messages of one step, of each receiver one: the difference of a longer and a shorter test.
struct StepMessages {
  double all = 0.0;
  double coupling = 0.0;
};

StepMessages messages_of_a_step(int count, const std::filesystem::path& file) {
  const auto counters = [&](int steps) {
    const KeptSimulation simulation = keep_simulation(storeys(count, file, steps), wide_area());
    EXPECT_EQ(simulation.result.coordinator.reason, StopReason::completed) << simulation.log();
    return simulation.result.network;
  };
  const simulated::NetworkCounters few = counters(25);
  const simulated::NetworkCounters many = counters(75);  // one second more
  return {static_cast<double>(many.sent - few.sent) / 50.0, static_cast<double>(many.coupling - few.coupling) / 50.0};
}

TEST(ManySites, MessagesOfAStepGrowWithTheSites) {
  const TemporaryDirectory folder;
  double all_of_32 = 0.0;
  for (const int count : {2, 32, 100}) {
    const StepMessages messages = messages_of_a_step(count, folder / "storeys.yaml");
    EXPECT_EQ(messages.coupling, 2.0 * count) << "a command and a measurement of each";
    if (count == 32) all_of_32 = messages.all;
    if (count < 100) continue;
    EXPECT_LE(messages.all, all_of_32 * count / 32.0);
    // Statuses of each to the coordinator and back, four in a lease of 2 s, over 50 steps a second.
    EXPECT_NEAR(messages.all, count * (2.0 + 2.0 * 2.0 / 50.0), 0.02 * count);
  }
}

TEST(ManySites, StepOf100TakesTheRoundTripOfTheFarthest) {
  constexpr int kSites = 100;
  const TemporaryDirectory folder;
  std::vector<std::string> sites;
  for (int i = 1; i <= kSites; ++i) sites.push_back("storey_" + std::to_string(i));
  SimulationSettings settings = wide_area();
  settings.network.site_latencies = simulated::draw_site_latencies(1, sites, std::chrono::milliseconds{20}, 0.4);
  const Duration farthest =
      std::ranges::max(settings.network.site_latencies, {}, &simulated::SiteLatency::latency).latency;
  ASSERT_GT(farthest, std::chrono::milliseconds{40}) << "far from the median";
  const KeptSimulation simulation = keep_simulation(storeys(kSites, folder / "storeys.yaml"), settings);
  ASSERT_EQ(simulation.result.coordinator.reason, StopReason::completed) << simulation.log();
  const std::vector<double> times_s = step_times_s(simulation);
  ASSERT_EQ(times_s.size(), static_cast<std::size_t>(kManySitesSteps));
  for (const double time_s : times_s) ASSERT_NEAR(time_s, to_seconds(2 * farthest), kMoment_s);
}

/// Mode j of a frame of n equal storeys, 2 sqrt(k/m) sin((2j - 1) pi / (4n + 2)) with the shape
/// sin((2j - 1) i pi / (2n + 1)) (Blevins, Formulas for Natural Frequency and Mode Shape). Central differences with the
/// step h keep the shape and turn the frequency w into 2/h asin(w h / 2): released at rest, each step is exact but for
/// rounding.
TEST(ManySites, FrameOf100SitesMovesInItsMode) {
  constexpr int kSites = 100;
  constexpr double kAmplitude_m = 0.01;
  constexpr double kAngle = 119.0 * std::numbers::pi / (2 * kSites + 1);  // mode 60
  const TemporaryDirectory folder;
  const auto shape = [](int floor) { return std::sin(kAngle * floor); };
  std::string released = "{free_vibration: {displacement_m: {";
  for (int i = 1; i <= kSites; ++i) {
    char entry[64];
    std::snprintf(entry, sizeof(entry), "%sfloor_%d: %.17g", i == 1 ? "" : ", ", i, kAmplitude_m * shape(i));
    released += entry;
  }
  const KeptSimulation simulation =
      keep_simulation(storeys(kSites, folder / "storeys.yaml", kManySitesSteps, released + "}}}"), wide_area());
  ASSERT_EQ(simulation.result.coordinator.reason, StopReason::completed) << simulation.log();
  const double frequency_rad_per_s =
      2.0 * std::sqrt(kStoreyStiffness_n_per_m / kStoreyMass_kg) * std::sin(0.5 * kAngle);
  const double turn = 2.0 * std::asin(0.5 * frequency_rad_per_s * kManySitesStep_s);
  ASSERT_GT(turn * kManySitesSteps, 1.0) << "it moves";
  for (const int floor : {1, 17, 50, 100}) {
    const std::vector<double> found_m =
        simulation.table("coordinator", "steps").column_values("displacement_floor_" + std::to_string(floor) + "_m");
    ASSERT_EQ(found_m.size(), static_cast<std::size_t>(kManySitesSteps) + 1);
    for (int n = 0; n <= kManySitesSteps; ++n) {
      ASSERT_NEAR(found_m[static_cast<std::size_t>(n)], kAmplitude_m * shape(floor) * std::cos(n * turn),
                  1e-11 * kAmplitude_m)
          << floor << " " << n;
    }
  }
}

}  // namespace
}  // namespace hybridtest
