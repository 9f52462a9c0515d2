#include "tests/simulation/invariants.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "runtime/participant.hpp"

namespace hybridtest {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

bool same_bits(double a, double b) noexcept {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

const KeptRows& coordinator_steps(const KeptSimulation& run) { return run.table(std::string{kCoordinatorId}, "steps"); }

/// The column `step` counts 0, 1, 2, ...
void expect_consecutive(const KeptRows& rows, std::string_view column, const std::string& whose, Violations& found) {
  const std::vector<double> steps = rows.column_values(column);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i] == static_cast<double>(i)) continue;
    found.push_back(whose + ": row " + std::to_string(i) + " is " + std::string{column} + " " + number(steps[i]));
    return;
  }
}

/// One column per structure degree of freedom of the coordinator's table.
std::vector<std::vector<double>> per_dof(const KeptSimulation& run, const Scenario& scenario, const std::string& before,
                                         const std::string& after) {
  std::vector<std::vector<double>> columns;
  for (const std::string& dof : scenario.dofs) {
    std::string name = before;
    name.append(dof).append(after);
    columns.push_back(coordinator_steps(run).column_values(name));
  }
  return columns;
}

struct SubstructureColumns {
  std::vector<std::vector<double>> displacement_m;
  std::vector<std::vector<double>> force_n;
};

SubstructureColumns columns_of(const KeptSimulation& run, const SubstructureScenario& substructure) {
  const KeptRows& rows = run.table(substructure.id, "steps");
  SubstructureColumns columns;
  for (std::size_t k = 0; k < substructure.interface.dofs().size(); ++k) {
    const bool is_site = substructure.role == Role::experimental_site;
    const std::string suffix = substructure.interface.size() == 1 ? "" : "_" + std::to_string(k + 1);
    const std::string& name = substructure.interface_names[k];
    columns.displacement_m.push_back(
        rows.column_values(is_site ? "target_displacement_m" + suffix : "displacement_" + name + "_m"));
    columns.force_n.push_back(rows.column_values(is_site ? "measured_force_n" + suffix : "force_" + name + "_n"));
  }
  return columns;
}

void expect_exchanges(const KeptSimulation& run, const Scenario& scenario, std::size_t completed, Violations& found) {
  const KeptRows& rows = run.table(std::string{kCoordinatorId}, "exchanges");
  const std::vector<double> steps = rows.column_values("step");
  const std::vector<double> substructures = rows.column_values("substructure");
  const std::vector<double> attempts = rows.column_values("attempts");
  const std::size_t count = scenario.substructures.size();
  if (steps.size() != completed * count && steps.size() != (completed + 1) * count) {
    found.push_back("exchanges: " + std::to_string(steps.size()) + " rows for " + std::to_string(completed) + " steps");
    return;
  }
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const std::size_t step = i / count;
    if (steps[i] == static_cast<double>(step) && substructures[i] == static_cast<double>(i % count) &&
        attempts[i] >= 1.0) {
      continue;
    }
    found.push_back("exchanges: row " + std::to_string(i) + " is step " + number(steps[i]) + " of substructure " +
                    number(substructures[i]) + ", sent " + number(attempts[i]) + " times");
    return;
  }
}

void expect_followed(const KeptSimulation& run, const Scenario& scenario, std::size_t steps, Violations& found) {
  const auto displacement_m = per_dof(run, scenario, "displacement_", "_m");
  for (const SubstructureScenario& substructure : scenario.substructures) {
    const SubstructureColumns columns = columns_of(run, substructure);
    const std::size_t taken = columns.force_n.front().size();
    if (taken < steps || taken > steps + 2) {
      found.push_back(substructure.id + " took " + std::to_string(taken) + " steps, the coordinator " +
                      std::to_string(steps));
      return;
    }
    const std::vector<InterfaceDof>& interface = substructure.interface.dofs();
    for (std::size_t k = 0; k < interface.size(); ++k) {
      const InterfaceDof& dof = interface[k];
      for (std::size_t step = 0; step < steps; ++step) {
        double expected = displacement_m[static_cast<std::size_t>(dof.dof)][step];
        if (dof.relative_to != InterfaceDof::kGround) {
          expected -= displacement_m[static_cast<std::size_t>(dof.relative_to)][step];
        }
        if (same_bits(columns.displacement_m[k][step], expected)) continue;
        found.push_back(substructure.id + " was moved to " + number(columns.displacement_m[k][step]) + " m at step " +
                        std::to_string(step) + ", expected " + number(expected));
        return;
      }
    }
  }
}

void expect_their_forces(const KeptSimulation& run, const Scenario& scenario, std::size_t steps, Violations& found) {
  const auto recorded_n = per_dof(run, scenario, "restoring_force_", "_n");
  std::vector<std::vector<double>> assembled_n(scenario.dofs.size(), std::vector<double>(steps, 0.0));
  for (const SubstructureScenario& substructure : scenario.substructures) {
    const SubstructureColumns columns = columns_of(run, substructure);
    const std::vector<InterfaceDof>& interface = substructure.interface.dofs();
    for (std::size_t k = 0; k < interface.size(); ++k) {
      const InterfaceDof& dof = interface[k];
      for (std::size_t step = 0; step < std::min(steps, columns.force_n[k].size()); ++step) {
        assembled_n[static_cast<std::size_t>(dof.dof)][step] += columns.force_n[k][step];
        if (dof.relative_to != InterfaceDof::kGround) {
          assembled_n[static_cast<std::size_t>(dof.relative_to)][step] -= columns.force_n[k][step];
        }
      }
    }
  }
  for (std::size_t dof = 0; dof < scenario.dofs.size(); ++dof) {
    for (std::size_t step = 0; step < steps; ++step) {
      if (same_bits(recorded_n[dof][step], assembled_n[dof][step])) continue;
      found.push_back("restoring force at " + scenario.dofs[dof] + ", step " + std::to_string(step) + ": " +
                      number(recorded_n[dof][step]) + " N recorded, " + number(assembled_n[dof][step]) + " N measured");
      return;
    }
  }
}

Eigen::VectorXd row_of(const std::vector<std::vector<double>>& columns, std::size_t row) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i) values[static_cast<Eigen::Index>(i)] = columns[i][row];
  return values;
}

bool tells_of_interlock(const KeptSimulation& run) {
  return run.count(EventCode::interlock_tripped) + run.count(EventCode::command_overdue) +
             run.count(EventCode::coordinator_lost) >
         0;
}

/// Events of the coordinator that name a participant which no longer answers.
std::size_t tells_of_loss(const KeptSimulation& run) {
  return run.count(EventCode::participant_lost, kCoordinatorId) + run.count(EventCode::answer_overdue, kCoordinatorId);
}

/// The faults drawn explain the coordinator's stop reason, and an event reports it.
void expect_explained(const KeptSimulation& run, const KeptSimulation& reference, const Scenario& scenario,
                      const DrawnCase& drawn, Violations& found) {
  const StopReason reason = run.result.coordinator.reason;
  const StopReason without_faults = reference.result.coordinator.reason;
  const bool is_paced = scenario.time.mode == CouplingMode::paced;
  const std::string what =
      "ended with " + std::string{name(reason)} + ", without faults with " + std::string{name(without_faults)};
  // In paced mode waiting changes the motion: a specimen near a limit may pass it or not.
  const bool may_differ = is_paced && (reason == StopReason::interlock || without_faults == StopReason::interlock);
  if (drawn.is_harmless() && reason != without_faults && !may_differ) found.push_back("harmless faults: " + what);
  switch (reason) {
    case StopReason::completed:
      if (run.result.coordinator.completed_steps != scenario.time.last_step + 1) {
        found.push_back("completed without all of its steps");
      }
      break;
    case StopReason::interlock:
      if (!tells_of_interlock(run)) found.push_back(what + ", and no site says why");
      break;
    case StopReason::participant_lost:
      if (tells_of_loss(run) == 0) found.push_back(what + " and does not say who");
      break;
    case StopReason::not_assembled:
      if (run.count(EventCode::participant_missing, kCoordinatorId) == 0) {
        found.push_back(what + " and does not say who");
      }
      break;
    case StopReason::none:
      if (!drawn.is_killed(std::string{kCoordinatorId})) found.push_back(what);
      break;
    case StopReason::interrupted:
    case StopReason::coordinator_lost:
    case StopReason::not_finite:
    case StopReason::no_equilibrium:
    case StopReason::opensees_lost:
    case StopReason::opensees_iterates:
    case StopReason::model_failed:
    case StopReason::deadlines_missed:
    case StopReason::network_too_slow:
    case StopReason::resume_refused:
    case StopReason::refused:
    case StopReason::emergency_stop:
    case StopReason::participant_failed:
    case StopReason::recording_failed: found.push_back(what); break;
  }
}

/// The others name a participant that was killed before the end of its test.
void expect_kills_told(const KeptSimulation& run, Violations& found) {
  for (const SimulatedOutcome& outcome : run.result.participants) {
    if (!outcome.was_killed) continue;
    if (outcome.participant == kCoordinatorId) {
      for (const SimulatedOutcome& other : run.result.participants) {
        if (other.was_killed || other.reason != StopReason::coordinator_lost) continue;
        if (run.count(EventCode::coordinator_lost, other.participant) == 0) {
          found.push_back(other.participant + " lost the coordinator and does not say so");
        }
      }
    } else if (run.result.coordinator.reason != StopReason::completed &&
               run.result.coordinator.reason != StopReason::interlock &&
               tells_of_loss(run) + run.count(EventCode::participant_missing, kCoordinatorId) == 0) {
      // Another participant may have ended the test before the lease of the killed one expired.
      found.push_back(outcome.participant + " was killed and nobody is named");
    }
  }
}

}  // namespace

Violations steps_violated(const KeptSimulation& run, const Scenario& scenario) {
  Violations found;
  const KeptRows& steps = coordinator_steps(run);
  expect_consecutive(steps, "step", std::string{kCoordinatorId}, found);
  for (const SubstructureScenario& substructure : scenario.substructures) {
    expect_consecutive(run.table(substructure.id, "steps"), "step", substructure.id, found);
  }
  // A step is written when the next one goes out; a coordinator that is killed before does not.
  const auto completed = static_cast<std::size_t>(run.result.coordinator.completed_steps);
  const bool was_killed = run.outcome(kCoordinatorId).was_killed;
  if (steps.size() != completed && !(was_killed && steps.size() + 1 == completed)) {
    found.push_back(std::to_string(steps.size()) + " steps recorded of " + std::to_string(completed) + " completed");
  }
  if (!found.empty()) return found;
  expect_exchanges(run, scenario, completed, found);
  expect_followed(run, scenario, steps.size(), found);
  expect_their_forces(run, scenario, steps.size(), found);
  return found;
}

Violations limits_violated(const KeptSimulation& run, const Scenario& scenario) {
  Violations found;
  for (const SubstructureScenario& substructure : scenario.substructures) {
    if (substructure.role != Role::experimental_site) continue;
    const KeptRows& rows = run.table(substructure.id, "control");
    expect_consecutive(rows, "sample", substructure.id, found);
    const SiteLimits& limits = substructure.site.loop.limits;
    const double period_s = scenario.time.step_s * scenario.time.time_scale / substructure.site.periods_per_step;
    // A command is made by adding the largest change to the one before: rounded once.
    const double reach_m = limits.velocity_m_per_s * period_s + kEpsilon * limits.displacement_m;
    for (std::size_t k = 0; k < substructure.interface.dofs().size(); ++k) {
      const std::string suffix = substructure.interface.size() == 1 ? "" : "_" + std::to_string(k + 1);
      double before_m = 0.0;
      for (const double command_m : rows.column_values("command_displacement_m" + suffix)) {
        if (!(std::abs(command_m) <= limits.displacement_m)) {
          found.push_back(substructure.id + ": command of " + number(command_m) + " m");
          return found;
        }
        if (!(std::abs(command_m - before_m) <= reach_m)) {
          found.push_back(substructure.id + ": command moves by " + number(command_m - before_m) + " m in a period");
          return found;
        }
        before_m = command_m;
      }
    }
  }
  return found;
}

Violations energy_violated(const KeptSimulation& run, const Scenario& scenario) {
  const std::size_t steps = coordinator_steps(run).size();
  if (steps < 3) return {};
  const auto displacement_m = per_dof(run, scenario, "displacement_", "_m");
  const auto velocity_m_per_s = per_dof(run, scenario, "velocity_", "_m_per_s");
  const auto restoring_force_n = per_dof(run, scenario, "restoring_force_", "_n");
  const auto ground_m_per_s2 = coordinator_steps(run).column_values("ground_acceleration_m_per_s2");
  const LinearStructure& structure = scenario.structure;
  const Eigen::VectorXd load_kg = structure.load_per_ground_acceleration_kg();
  const double dt = scenario.time.step_s;
  const auto half_step_velocity = [&](std::size_t row) -> Eigen::VectorXd {
    return (row_of(displacement_m, row + 1) - row_of(displacement_m, row)) / dt;
  };
  const auto kinetic_j = [&](const Eigen::VectorXd& velocity) -> double {
    return 0.5 * velocity.dot(structure.mass_kg * velocity);
  };
  const double begin_j = kinetic_j(half_step_velocity(0));
  double work_j = 0.0;   // put in, less what damping and restoring force took
  double scale_j = 0.0;  // what the terms sum up to, regardless of sign
  double worst_j = 0.0;
  double displacement_max_m = 0.0;
  double velocity_max_m_per_s = 0.0;
  for (std::size_t i = 1; i + 1 < steps; ++i) {
    const Eigen::VectorXd velocity = row_of(velocity_m_per_s, i);
    const double input = velocity.dot(load_kg) * ground_m_per_s2[i];
    const double damping = velocity.dot(structure.damping_n_s_per_m * velocity);
    const double restoring = velocity.dot(row_of(restoring_force_n, i));
    work_j += dt * (input - damping - restoring);
    scale_j += dt * (std::abs(input) + std::abs(damping) + std::abs(restoring));
    const Eigen::VectorXd half = half_step_velocity(i);
    worst_j = std::max(worst_j, std::abs(kinetic_j(half) - begin_j - work_j));
    displacement_max_m = std::max(displacement_max_m, row_of(displacement_m, i).cwiseAbs().maxCoeff());
    velocity_max_m_per_s = std::max(velocity_max_m_per_s, half.cwiseAbs().maxCoeff());
  }
  // Displacements are rounded to eps |u|, so half-step velocities to eps |u|/dt and the kinetic
  // energy to twice that share of |h|; every step adds the rounding of its sums. Both twice over.
  const double relative =
      2.0 * kEpsilon * (4.0 * displacement_max_m / (dt * velocity_max_m_per_s) + static_cast<double>(steps));

  if (worst_j <= relative * scale_j) return {};
  return {"energy: " + number(worst_j) + " J out of " + number(scale_j) + " J are unaccounted for; rounding explains " +
          number(relative * scale_j) + " J"};
}

Violations ending_violated(const KeptSimulation& run, const KeptSimulation& reference, const Scenario& scenario,
                           const DrawnCase& drawn) {
  Violations found;
  for (const SimulatedOutcome& outcome : run.result.participants) {
    if (!outcome.was_killed && !outcome.is_done) found.push_back(outcome.participant + " never came to an end");
  }
  expect_explained(run, reference, scenario, drawn, found);
  expect_kills_told(run, found);
  if (drawn.is_harmless()) {
    for (const SimulatedOutcome& outcome : run.result.participants) {
      if (outcome.reason != run.result.coordinator.reason) {
        found.push_back(outcome.participant + " ended with " + std::string{name(outcome.reason)});
      }
    }
  }
  return found;
}

Violations history_violated(const KeptSimulation& run, const KeptSimulation& reference) {
  const std::size_t steps = coordinator_steps(run).size();
  if (steps > coordinator_steps(reference).size()) return {"more steps than without faults"};
  const bool is_whole = run.result.coordinator.reason == StopReason::completed;
  if (is_whole && steps != coordinator_steps(reference).size()) return {"fewer steps than without faults"};
  const std::size_t wall_time = coordinator_steps(run).column("wall_time_s");
  const std::size_t width = coordinator_steps(run).layout().columns.size();
  for (std::size_t i = 0; i < steps * width; ++i) {
    if (i % width == wall_time) continue;
    const double value = coordinator_steps(run).values()[i];
    if (same_bits(value, coordinator_steps(reference).values()[i])) continue;
    return {"step " + std::to_string(i / width) + ", " + coordinator_steps(run).layout().columns[i % width].name +
            ": " + number(value) + ", without faults " + number(coordinator_steps(reference).values()[i])};
  }
  return {};
}

}  // namespace hybridtest
