#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "diagnosis/runs/run_records.hpp"
#include "diagnosis/structure/structure_diagnosis.hpp"
#include "recording/summary/run_summary.hpp"
#include "tests/simulation/kept_simulation.hpp"
#include "tests/simulation/recorded_simulation.hpp"
#include "tests/unit/recording/temporary_directory.hpp"

/// Whole tests under every kind of excitation, against closed forms and against each other.
namespace hybridtest::excitation_test {
namespace {

constexpr double kMass_kg = 1000.0;
constexpr double kStiffness_n_per_m = 40.0e3;
constexpr double kRatio = 0.05;
constexpr double kStep_s = 0.001;
const double kOmega = std::sqrt(kStiffness_n_per_m / kMass_kg);

class ExcitationTest : public testing::Test {
 protected:
  ExcitationTest() {
    std::ofstream a{directory_ / "a.txt"};
    std::ofstream b{directory_ / "b.txt"};
    std::ofstream forces{directory_ / "forces.csv"};
    for (std::ofstream* file : {&a, &b}) *file << "time_s acceleration_m_per_s2\n";
    forces << "time_s,first_n\n";
    for (std::ofstream* file : {&a, &b, &forces}) file->precision(17);
    for (int i = 0; i <= 400; ++i) {
      const double time_s = 0.01 * i;
      const double value = 2.0 * std::sin(5.0 * time_s) * std::exp(-time_s);
      a << time_s << ' ' << value << '\n';
      b << time_s << ' ' << std::cos(11.0 * time_s) << '\n';
      forces << time_s << ',' << -kMass_kg * value << '\n';
    }
  }

  /// One storey, computed by a numerical substructure or tested at a site without dynamics of its own.
  [[nodiscard]] Scenario one_storey(const std::string& excitation, double duration_s, bool at_a_site = false,
                                    const std::string& transfer_system = "{type: ideal}") const {
    std::string text = head(excitation, duration_s) +
                       "structure:\n  degrees_of_freedom: [first]\n  mass_kg: {first: " + std::to_string(kMass_kg) +
                       "}\n  damping: {type: mass_and_stiffness, mass_per_s: " + std::to_string(2.0 * kRatio * kOmega) +
                       ", stiffness_s: 0.0}\n" + "substructures:\n  - id: storey\n    interface: [{dof: first}]\n";
    const std::string stiffness = "stiffness_n_per_m: " + std::to_string(kStiffness_n_per_m);
    if (at_a_site) {
      text += "    kind: experimental\n    initial_stiffness_n_per_m: [[" + std::to_string(kStiffness_n_per_m) +
              "]]\n    rig: {type: simulated, transfer_system: " + transfer_system + ", specimen: {type: elastic, " +
              stiffness +
              "}}\n    limits: {displacement_m: 0.1, velocity_m_per_s: 0.5, force_n: 10.0e3}\n"
              "    control_rate_hz: 1000\n";
    } else {
      text += "    kind: numerical\n    model: {type: elastic, " + stiffness + "}\n";
    }
    return written(text);
  }

  /// Two degrees of freedom that a full matrix couples.
  [[nodiscard]] Scenario coupled(const std::string& excitation, double duration_s) const {
    return written(head(excitation, duration_s) +
                   "structure:\n  degrees_of_freedom: [first, second]\n  mass_kg: {first: 1000.0, second: 700.0}\n"
                   "  damping: {type: rayleigh, ratio: 0.03, modes: [1, 2]}\n"
                   "substructures:\n  - id: all\n    kind: numerical\n    interface: [{dof: first}, {dof: second}]\n"
                   "    model: {type: elastic, stiffness_matrix_n_per_m: [[90.0e3, -30.0e3], [-30.0e3, 50.0e3]]}\n");
  }

  /// A deck on two supports: held by the elastic part, with a spring between its ends that no support strains.
  [[nodiscard]] Scenario deck(const std::string& excitation, double duration_s) const {
    std::ofstream{directory_ / "k.mtx"}
        << "%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 60e3\n2 2 60e3\n";
    return written(head(excitation, duration_s) +
                   "structure:\n  degrees_of_freedom: [first, second]\n  mass_kg: {first: 1000.0, second: 1200.0}\n"
                   "  stiffness: k.mtx\n  damping: {type: rayleigh, ratio: 0.03, modes: [1, 2]}\n"
                   "substructures:\n  - id: spring\n    kind: numerical\n"
                   "    interface: [{dof: second, relative_to: first}]\n"
                   "    model: {type: elastic, stiffness_n_per_m: 20.0e3}\n");
  }

  [[nodiscard]] static KeptRows steps_of(const Scenario& scenario) {
    const KeptSimulation kept = keep_simulation(scenario, SimulationSettings{});
    EXPECT_EQ(kept.result.coordinator.reason, StopReason::completed) << kept.log();
    return kept.table("coordinator", "steps");
  }
  [[nodiscard]] static std::vector<double> displacement_m(const Scenario& scenario, const std::string& dof = "first") {
    return steps_of(scenario).column_values("displacement_" + dof + "_m");
  }

  TemporaryDirectory directory_;

 private:
  [[nodiscard]] static std::string head(const std::string& excitation, double duration_s) {
    return "schema: hybridtest/1\nname: excitation\ntime: {mode: lockstep, step_s: 0.001, duration_s: " +
           std::to_string(duration_s) + "}\nexcitation: " + excitation + "\nintegrator: {type: central_difference}\n";
  }
  [[nodiscard]] Scenario written(const std::string& text) const {
    std::ofstream{directory_ / "scenario.yaml"} << text;
    return read_scenario(directory_ / "scenario.yaml", {});
  }
};

double largest(const std::vector<double>& values) {
  double found = 0.0;
  for (const double value : values) found = std::max(found, std::abs(value));
  return found;
}

/// Largest distance between them.
double distance(const std::vector<double>& one, const std::vector<double>& other) {
  EXPECT_EQ(one.size(), other.size());
  double found = 0.0;
  for (std::size_t i = 0; i < std::min(one.size(), other.size()); ++i)
    found = std::max(found, std::abs(one[i] - other[i]));
  return found;
}

TEST_F(ExcitationTest, TwoDirectionsAreTheSumOfEachAlone) {
  const std::string a = "{ground_motion: a.txt, influence: {first: 1.0}}";
  const std::string b = "{ground_motion: b.txt, influence: {second: 1.0}, start_s: 0.3}";
  for (const char* dof : {"first", "second"}) {
    const auto both = displacement_m(coupled(fmt::format("{{records: [{}, {}]}}", a, b), 4.0), dof);
    auto sum = displacement_m(coupled(a, 4.0), dof);
    const auto other = displacement_m(coupled(b, 4.0), dof);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += other[i];
    EXPECT_GT(largest(other), 0.01 * largest(both)) << "control: both count";
    EXPECT_LT(distance(both, sum), 1e-12 * largest(both)) << dof;
  }
}

TEST_F(ExcitationTest, UniformSupportsAreASingleGroundMotion) {
  const auto single = displacement_m(deck("{ground_motion: a.txt}", 4.0));
  const auto supports =
      displacement_m(deck("{records: [{ground_motion: a.txt, support: west, influence: {first: 0.4, second: 0.4}}, "
                          "{ground_motion: a.txt, support: east, influence: {first: 0.6, second: 0.6}}]}",
                          4.0));
  EXPECT_GT(largest(single), 0.005);
  EXPECT_LT(distance(single, supports), 1e-12 * largest(single));
}

TEST_F(ExcitationTest, ForcesOfTheSameSizeAreAGroundMotion) {
  const auto ground = displacement_m(one_storey("{ground_motion: a.txt}", 4.0));
  const auto forces = displacement_m(one_storey("{forces: [{force_history: forces.csv}]}", 4.0));
  EXPECT_GT(largest(ground), 0.01);
  EXPECT_LT(distance(ground, forces), 1e-12 * largest(ground));
}

/// Largest over the last cycle of the excitation.
double steady_m(const std::vector<double>& displacement_m, double frequency_hz) {
  const auto cycle = static_cast<std::ptrdiff_t>(1.0 / frequency_hz / kStep_s);
  return largest({displacement_m.end() - cycle, displacement_m.end()});
}

TEST_F(ExcitationTest, HarmonicForceAndGroundReachTheirSteadyState) {
  constexpr double kFrequency_hz = 0.8;
  const double over = 2.0 * std::numbers::pi * kFrequency_hz / kOmega;
  const double dynamic = 1.0 / std::hypot(1.0 - over * over, 2.0 * kRatio * over);
  // Thirty seconds leave 1e-4 of the transient at the most; the ramps add none.
  const auto by_force = displacement_m(one_storey(
      "{forces: [{harmonic: {amplitude_n: 400.0, frequency_hz: 0.8, ramp_s: 2.0, duration_s: 40.0}, dof: first}]}",
      30.0));
  EXPECT_NEAR(steady_m(by_force, kFrequency_hz), 400.0 / kStiffness_n_per_m * dynamic, 2e-4 * 0.01 * dynamic);
  const auto by_ground = displacement_m(one_storey("{harmonic: {amplitude_m_per_s2: 0.4, frequency_hz: 0.8}}", 30.0));
  EXPECT_NEAR(steady_m(by_ground, kFrequency_hz), 0.01 * dynamic, 2e-4 * 0.01 * dynamic);
}

TEST_F(ExcitationTest, SweepPassesResonance) {
  // Slow through 1 Hz: the peak comes near that of a harmonic at resonance, 1/(2 xi) of the static one.
  const auto found = displacement_m(one_storey(
      "{forces: [{sweep: {amplitude_n: 100.0, from_hz: 0.7, to_hz: 1.4, duration_s: 120.0}, dof: first}]}", 120.0));
  const double resonance_m = 100.0 / kStiffness_n_per_m / (2.0 * kRatio);
  EXPECT_GT(largest(found), 0.95 * resonance_m);
  EXPECT_LT(largest(found), 1.01 * resonance_m);
}

/// Released from u_0 and v_0.
double free_m(double time_s, double u_m, double v_m_per_s) {
  const double damped = kOmega * std::sqrt(1.0 - kRatio * kRatio);
  return std::exp(-kRatio * kOmega * time_s) *
         (u_m * std::cos(damped * time_s) + (v_m_per_s + kRatio * kOmega * u_m) / damped * std::sin(damped * time_s));
}

double distance_from_free_vibration(const std::vector<double>& found_m, std::size_t release, double u_m,
                                    double v_m_per_s) {
  double worst = 0.0;
  for (std::size_t i = release; i < found_m.size(); ++i) {
    const double time_s = kStep_s * static_cast<double>(i - release);
    worst = std::max(worst, std::abs(found_m[i] - free_m(time_s, u_m, v_m_per_s)));
  }
  return worst;
}

TEST_F(ExcitationTest, FreeVibrationOfANumericalStoreyFollowsClosedForm) {
  const auto at_once = displacement_m(
      one_storey("{free_vibration: {displacement_m: {first: 0.02}, velocity_m_per_s: {first: -0.1}}}", 5.0));
  EXPECT_EQ(at_once.front(), 0.02);
  // (w dt)^2/24 = 1.7e-6 of the frequency, over 32 rad.
  EXPECT_LT(distance_from_free_vibration(at_once, 0, 0.02, -0.1), 1e-4 * 0.02);
  const auto ramped = displacement_m(one_storey(
      "{free_vibration: {displacement_m: {first: 0.02}, velocity_m_per_s: {first: -0.1}, ramp_s: 1.0}}", 6.0));
  EXPECT_EQ(ramped.front(), 0.0);
  EXPECT_EQ(std::vector(ramped.begin() + 1000, ramped.end()), at_once) << "from the release on";
}

TEST_F(ExcitationTest, SpecimenIsPulledToItsDisplacementBeforeTheRelease) {
  const std::string excitation = "{free_vibration: {displacement_m: {first: 0.02}, ramp_s: 1.0, hold_s: 0.5}}";
  const Scenario scenario = one_storey(excitation, 6.5, true);
  const KeptSimulation kept = keep_simulation(scenario, SimulationSettings{});
  ASSERT_EQ(kept.result.coordinator.reason, StopReason::completed) << kept.log();
  const KeptRows& steps = kept.table("coordinator", "steps");
  EXPECT_LT(distance_from_free_vibration(steps.column_values("displacement_first_m"), 1500, 0.02, 0.0), 1e-4 * 0.02);
  EXPECT_DOUBLE_EQ(steps.column_values("restoring_force_first_n")[1500], 0.02 * kStiffness_n_per_m);
  // Never faster than the ramp at its steepest, 15/8 of its mean.
  const auto command_m = kept.table("storey", "control").column_values("command_displacement_m");
  for (std::size_t i = 1; i < 1500; ++i)
    ASSERT_LT(std::abs(command_m[i] - command_m[i - 1]), 1.876 * 0.02 * kStep_s) << i;
}

TEST_F(ExcitationTest, HoldLetsASlowActuatorSettle) {
  const Scenario scenario =
      one_storey("{free_vibration: {displacement_m: {first: 0.02}, ramp_s: 1.0, hold_s: 1.0}}", 2.1, true,
                 "{type: second_order, natural_frequency_hz: 15.0, damping_ratio: 0.9, delay_s: 0.004}");
  const KeptRows steps = steps_of(scenario);
  const auto force_n = steps.column_values("restoring_force_first_n");
  EXPECT_LT(force_n[1000], 0.9999 * 0.02 * kStiffness_n_per_m) << "control: behind the ramp at its end";
  EXPECT_NEAR(force_n[2000], 0.02 * kStiffness_n_per_m, 1e-6 * 0.02 * kStiffness_n_per_m);
}

/// Every kind at once, recorded: the recording tells what was applied, and the diagnosis finds no gap.
TEST_F(ExcitationTest, RecordedTestIsRecomputedBitForBit) {
  const std::string excitation =
      "{records: [{ground_motion: a.txt, influence: {first: 1.0}}, {ground_motion: b.txt, influence: {second: 1.0}}], "
      "forces: [{force_history: forces.csv}], "
      "free_vibration: {displacement_m: {second: 0.01}, ramp_s: 0.2, hold_s: 0.1}}";
  const Scenario scenario = coupled(excitation, 3.0);
  const std::filesystem::path run = directory_ / "run";
  prepare_run_directory(run, scenario);
  RecordedSimulation simulation{scenario, run, std::size_t{1} << 14U};
  ASSERT_EQ(simulation.run(SimulationSettings{}), StopReason::completed);
  ASSERT_EQ(simulation.dropped(), 0U);

  const StructureRecord record = structure_record(run, scenario);
  EXPECT_EQ(recomputed_displacement_m(record.model, record.recording), record.recording.displacement_m);
  EXPECT_TRUE(record.notes.empty());
  EXPECT_EQ(record.recording.ground_m_per_s2.rows(), 2);
  EXPECT_NEAR(record.recording.forces_n(0, 300 + 100), -kMass_kg * 2.0 * std::sin(0.5) * std::exp(-0.1), 1e-9);
  // Control: without the second motion it is another test.
  StructureRecording less = record.recording;
  less.ground_m_per_s2.row(1).setZero();
  EXPECT_NE(recomputed_displacement_m(record.model, less), record.recording.displacement_m);

  const RunSummary summary = summarise(run);
  ASSERT_EQ(summary.ground_motions.size(), 2U);
  EXPECT_EQ(summary.ground_motions[1].facts.points, 401);
  EXPECT_EQ(summary.ground_motions[0].spectrum.size(), 101U + 2U) << "the grid, and two modes";
  EXPECT_EQ(summary.ground_motions[0].spectrum.back().mode, 2);
  EXPECT_GT(summary.ground_motions[0].spectrum.back().pseudo_acceleration_m_per_s2, 1.0);
}

}  // namespace
}  // namespace hybridtest::excitation_test
