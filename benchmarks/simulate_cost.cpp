// Steps per second of a test under simulated time, over the same equations in a bare loop: integrator, trajectory,
// compensator, transfer system and specimen of every site, or the law of every numerical substructure, without nodes,
// messages and records. Without records and with the files of `hybridtest simulate`. The displacements of both are
// compared, so that they are the same equations. Processor time. Then how a step grows from 1 to 32 numerical
// substructures, each on a structure of one more degree of freedom. Medians of several runs in turn. At last a step of
// 2 to 1000 substructures, per substructure over that of 2: processor time and messages with the same latency of all,
// and the time of a step over the round trip of the farthest with latencies as on the internet. Usage: simulate_cost
// [name of a shipped scenario]...

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "experimental_site/control_loop.hpp"
#include "recording/recorder.hpp"
#include "runtime/participant.hpp"
#include "runtime/simulation.hpp"
#include "transport/simulated/site_latencies.hpp"

namespace {

using namespace hybridtest;

constexpr int kRounds = 5;

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

/// Of the processor: one thread does all the work, and other programs do not count.
template <class Work>
double seconds_of(Work&& work) {
  const std::clock_t begin = std::clock();
  work();
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

/// A substructure of the bare loop: gives the force of one step.
class BareSubstructure {
 public:
  virtual ~BareSubstructure() = default;
  virtual const InterfaceVector& force(Step step, double model_time_s, const InterfaceMap& interface,
                                       const MotionState& motion) = 0;
};

class BareModel final : public BareSubstructure {
 public:
  explicit BareModel(const SubstructureScenario& substructure) : model_{substructure.make_model()} {
    model_->start({});
    model_->reset();
    force_n_.setZero(substructure.interface.size());
  }
  const InterfaceVector& force(Step, double, const InterfaceMap& interface, const MotionState& motion) override {
    interface.to_interface(motion.displacement_m, displacement_m_);
    interface.to_interface(motion.velocity_m_per_s, velocity_m_per_s_);
    model_->trial(displacement_m_, velocity_m_per_s_, force_n_);
    model_->commit();
    return force_n_;
  }

 private:
  std::unique_ptr<SubstructureModel> model_;
  InterfaceVector displacement_m_;
  InterfaceVector velocity_m_per_s_;
  InterfaceVector force_n_;
};

/// The control periods of one step: trajectory, compensators, rig.
class BareSite final : public BareSubstructure {
 public:
  BareSite(const Scenario& scenario, const SubstructureScenario& substructure)
      : settings_{control_loop_settings(scenario, substructure)},
        period_s_{settings_.step_s / settings_.periods_per_step},
        rig_{substructure.make_rig(period_s_)},
        compensation_{substructure.make_compensation(period_s_)},
        trajectory_{settings_.dofs, settings_.step_s, settings_.time_scale, settings_.trajectory} {
    rig_->connect();
    rig_->arm();
    const SiteVector zero = SiteVector::Zero(settings_.dofs);
    trajectory_.reset(zero);
    command_.displacement_m = zero;
    feedback_ = {zero, zero};
    force_n_ = zero;
    force_before_n_ = zero;
  }
  const InterfaceVector& force(Step step, double model_time_s, const InterfaceMap& interface,
                               const MotionState& motion) override {
    interface.to_interface(motion.displacement_m, values_);
    point_.step = step;
    point_.model_time_s = model_time_s;
    point_.displacement_m = values_;
    interface.to_interface(motion.velocity_m_per_s, values_);
    point_.velocity_m_per_s = values_;
    interface.to_interface(motion.acceleration_m_per_s2, values_);
    point_.acceleration_m_per_s2 = values_;
    trajectory_.set_target(point_);
    while (!run_period()) {
    }
    result_ = force_n_;
    if (reached_.fraction < 1.0) result_ = force_before_n_ + reached_.fraction * (force_n_ - force_before_n_);
    return result_;
  }

 private:
  bool run_period() {
    command_.time_s = static_cast<double>(command_.sample++) * period_s_;
    const bool is_reached = trajectory_.advance(period_s_, reached_);
    const TrajectoryPoint& target = trajectory_.point();
    const double reach_m = settings_.limits.velocity_m_per_s * period_s_;
    for (Eigen::Index k = 0; k < settings_.dofs; ++k) {
      const double wanted_m = compensation_.commands[static_cast<std::size_t>(k)]->command(
          {target.displacement_m[k], target.velocity_m_per_s[k], target.acceleration_m_per_s2[k],
           feedback_.displacement_m[k], feedback_.force_n[k]});
      double& command_m = command_.displacement_m[k];
      command_m = std::clamp(wanted_m, command_m - reach_m, command_m + reach_m);
    }
    if (rig_->exchange(command_, feedback_) != RigStatus::healthy) std::exit(70);
    force_before_n_ = force_n_;
    for (Eigen::Index k = 0; k < settings_.dofs; ++k) {
      force_n_[k] = compensation_.forces[static_cast<std::size_t>(k)]->corrected_force(
          {target.displacement_m[k], feedback_.displacement_m[k], feedback_.force_n[k]});
    }
    return is_reached;
  }

  ControlLoopSettings settings_;
  double period_s_;
  std::unique_ptr<Rig> rig_;
  SiteCompensation compensation_;
  Trajectory trajectory_;
  ActuatorCommand command_;
  RigFeedback feedback_;
  TargetPoint point_;
  ReachedTarget reached_;
  InterfaceVector values_;
  SiteVector force_n_;
  SiteVector force_before_n_;
  InterfaceVector result_;
};

/// The first degree of freedom at every step.
std::vector<double> bare_loop(const Scenario& scenario) {
  const std::unique_ptr<Integrator> integrator = scenario.make_integrator();
  const AppliedLoad load = scenario.excitation.load(scenario.structure);
  const Eigen::SparseMatrix<double>& stiffness = scenario.structure.stiffness_n_per_m;
  std::vector<std::unique_ptr<BareSubstructure>> parts;
  for (const SubstructureScenario& substructure : scenario.substructures) {
    if (substructure.role == Role::numerical_substructure) {
      parts.push_back(std::make_unique<BareModel>(substructure));
    } else {
      parts.push_back(std::make_unique<BareSite>(scenario, substructure));
    }
  }
  Eigen::VectorXd restoring_force_n(scenario.structure.size());
  Eigen::VectorXd applied_force_n(scenario.structure.size());
  std::vector<double> displacement_m;
  displacement_m.reserve(static_cast<std::size_t>(scenario.time.last_step) + 1);
  for (Step step = 0; step <= scenario.time.last_step; ++step) {
    const MotionState& motion = integrator->current();
    displacement_m.push_back(motion.displacement_m[0]);
    restoring_force_n.setZero();
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const InterfaceMap& interface = scenario.substructures[i].interface;
      interface.add_to_structure(parts[i]->force(step, scenario.model_time_s(step), interface, motion),
                                 restoring_force_n);
    }
    if (stiffness.nonZeros() > 0) restoring_force_n.noalias() += stiffness * motion.displacement_m;
    load.ground_at(step, applied_force_n);
    integrator->advance(restoring_force_n, applied_force_n);
  }
  return displacement_m;
}

/// Keeps one column of one table.
class KeptColumn final : public RowSink {
 public:
  void append(std::span<const double> row) noexcept override { values_.push_back(row[4]); }
  [[nodiscard]] const std::vector<double>& values() const noexcept { return values_; }

 private:
  std::vector<double> values_;
};

SimulationSettings settings() {
  SimulationSettings settings;
  settings.seed = 1;
  return settings;
}

std::vector<double> simulated(const Scenario& scenario) {
  NoRecord nothing;
  KeptColumn steps;
  SimulationObserver observer;
  observer.sink = [&](const std::string& participant, const TableLayout& table) -> RowSink& {
    if (participant == kCoordinatorId && table.name == "steps") return steps;
    return nothing;
  };
  if (simulate(scenario, settings(), observer).coordinator.reason != StopReason::completed) std::exit(70);
  return steps.values();
}

/// With the files of `hybridtest simulate`.
void recorded(const Scenario& scenario, const std::filesystem::path& folder) {
  std::map<std::string, std::unique_ptr<Recorder>> recorders;
  const auto open = [&](const std::string& id, const std::vector<TableLayout>& tables) {
    std::vector<RecordedTable> recorded;
    for (const TableLayout& table : tables) {  // as `hybridtest simulate` does it
      recorded.push_back({table, table.name == "steps" ? 1U << 14U : 1U << 16U});
    }
    RunFileHeader header;
    header.participant = id;
    recorders[id] = std::make_unique<Recorder>(folder / (id + ".h5"), header, recorded);
  };
  open(std::string{kCoordinatorId}, CoordinatorParticipant::tables(scenario));
  for (const SubstructureScenario& substructure : scenario.substructures) {
    open(substructure.id, substructure_tables(substructure));
  }
  SimulationObserver observer;
  observer.sink = [&](const std::string& participant, const TableLayout& table) -> RowSink& {
    return recorders.at(participant)->sink(table.name);
  };
  std::map<std::string, int> calls;  // as `hybridtest simulate` does it
  observer.housekeeping = [&](const std::string& participant, Presence&, Instant) {
    Recorder& recorder = *recorders.at(participant);
    if (calls[participant]++ % 8 == 0 || recorder.should_drain()) recorder.drain();
  };
  (void)simulate(scenario, settings(), observer);
}

/// Relative to the peak.
double distance(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) return 1.0;
  double peak = 0.0;
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    peak = std::max(peak, std::abs(b[i]));
    largest = std::max(largest, std::abs(a[i] - b[i]));
  }
  return largest / peak;
}

void print_costs(const std::string& name, const Scenario& scenario, const std::filesystem::path& folder) {
  std::vector<double> bare_s;
  std::vector<double> nodes_s;
  std::vector<double> files_s;
  std::vector<double> bare_m;
  std::vector<double> simulated_m;
  for (int round = 0; round < kRounds; ++round) {
    bare_s.push_back(seconds_of([&] { bare_m = bare_loop(scenario); }));
    nodes_s.push_back(seconds_of([&] { simulated_m = simulated(scenario); }));
    files_s.push_back(seconds_of([&] { recorded(scenario, folder); }));
  }
  const double steps = static_cast<double>(scenario.time.last_step + 1);
  const double bare_us = 1e6 * median(bare_s) / steps;
  const double nodes_us = 1e6 * median(nodes_s) / steps;
  const double files_us = 1e6 * median(files_s) / steps;
  std::printf("%-28s %8.2f %9.2f %7.2f %9.2f %7.2f %11.0f %10.1e\n", name.c_str(), bare_us, nodes_us,
              nodes_us / bare_us, files_us, files_us / bare_us, 1e6 / files_us, distance(simulated_m, bare_m));
}

/// A shear frame with a numerical substructure in every storey.
std::filesystem::path write_chain(const std::filesystem::path& folder, int storeys) {
  std::filesystem::path file = folder / ("chain_" + std::to_string(storeys) + ".yaml");
  std::string names;
  std::string mass;
  std::string parts;
  for (int i = 1; i <= storeys; ++i) {
    const std::string number = std::to_string(i);
    const std::string below = i == 1 ? "" : ", relative_to: floor_" + std::to_string(i - 1);
    names += (i == 1 ? "floor_" : ", floor_") + number;
    mass += (i == 1 ? "floor_" : ", floor_") + number + ": 20.0e3";
    parts.append("  - id: storey_").append(number).append("\n    kind: numerical\n    interface: [{dof: floor_");
    parts.append(number).append(below).append("}]\n    model: {type: elastic, stiffness_n_per_m: 4.0e6}\n");
  }
  std::ofstream{file} << "schema: hybridtest/1\nname: chain\ntime: {mode: lockstep, step_s: 0.001, duration_s: 10.0}\n"
                         "excitation: {ground_motion: " HYBRIDTEST_SOURCE_DIR
                         "/launch/scenarios/ground_motions/design_ec8_c.AT2}\nstructure:\n  degrees_of_freedom: ["
                      << names << "]\n  mass_kg: {" << mass << "}\n  damping: "
                      << (storeys == 1 ? "{type: none}" : "{type: rayleigh, ratio: 0.02, modes: [1, 2]}")
                      << "\nintegrator: {type: central_difference}\nsubstructures:\n"
                      << parts;
  return file;
}

SimulationResult run_of(Scenario scenario, int steps, const simulated::NetworkConditions& network) {
  scenario.time.last_step = steps;
  NoRecord nothing;
  SimulationObserver observer;
  observer.sink = [&](const std::string&, const TableLayout&) -> RowSink& { return nothing; };
  SimulationSettings same = settings();
  same.network = network;
  SimulationResult result = simulate(scenario, same, observer);
  if (result.coordinator.reason != StopReason::completed) std::exit(70);
  return result;
}

/// Of one substructure in one step.
struct SiteStep {
  double processor_us = 0.0;
  double messages = 0.0;
  double step_over_round_trip = 0.0;
};

SiteStep site_step(const Scenario& chain, int sites) {
  const int steps = std::max(10, 4000 / sites);
  simulated::NetworkConditions network;
  network.latency = std::chrono::milliseconds{10};
  std::vector<double> times_s;
  double sent = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    // A longer test less a shorter one: without reading the scenario, joining and leaving.
    SimulationResult few;
    SimulationResult many;
    const double few_s = seconds_of([&] { few = run_of(chain, steps, network); });
    times_s.push_back(seconds_of([&] { many = run_of(chain, 4 * steps, network); }) - few_s);
    sent = static_cast<double>(many.network.sent - few.network.sent);
  }
  std::vector<std::string> ids;
  for (int i = 1; i <= sites; ++i) ids.push_back("storey_" + std::to_string(i));
  network.site_latencies = simulated::draw_site_latencies(1, ids, std::chrono::milliseconds{60}, 0.6);
  const double farthest_s =
      to_seconds(std::ranges::max(network.site_latencies, {}, &simulated::SiteLatency::latency).latency);
  constexpr int kSteps = 10;
  const double step_s = to_seconds(run_of(chain, 3 * kSteps, network).coordinator.running_time -
                                   run_of(chain, kSteps, network).coordinator.running_time) /
                        (2 * kSteps);
  const double site_steps = 3.0 * steps * sites;
  return {1e6 * median(times_s) / site_steps, sent / site_steps, step_s / (2.0 * farthest_s)};
}

void print_growth(const std::filesystem::path& folder) {
  std::printf("\n%-14s %16s %10s %10s %22s\n", "substructures", "us per one, step", "over 2", "messages",
              "step over round trip");
  double first_us = 0.0;
  for (const int sites : {2, 10, 32, 100, 316, 1000}) {
    const SiteStep one = site_step(read_scenario(write_chain(folder, sites), {}), sites);
    if (first_us == 0.0) first_us = one.processor_us;
    std::printf("%-14d %16.2f %10.2f %10.2f %22.4f\n", sites, one.processor_us, one.processor_us / first_us,
                one.messages, one.step_over_round_trip);
  }
}

}  // namespace

int main(int count, char** words) {
  std::string folder = (std::filesystem::temp_directory_path() / "hybridtest_simulate_XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) return 70;
  std::printf("%-28s %8s %9s %7s %9s %7s %11s %10s\n", "us per step", "bare", "simulate", "/ bare", "with files",
              "/ bare", "steps / s", "difference");
  std::vector<std::string> names{"two_storey_one_site", "two_storey_two_sites", "three_storey_base_isolated"};
  if (count > 1) names.assign(words + 1, words + count);
  for (const std::string& name : names) {
    print_costs(name, read_scenario(HYBRIDTEST_SOURCE_DIR "/launch/scenarios/" + name + ".yaml", {}), folder);
  }
  for (const int storeys : {1, 2, 4, 8, 16, 32}) {
    if (count > 1) break;
    print_costs(std::to_string(storeys) + " numerical", read_scenario(write_chain(folder, storeys), {}), folder);
  }
  if (count == 1) print_growth(folder);
  std::filesystem::remove_all(folder);
}
