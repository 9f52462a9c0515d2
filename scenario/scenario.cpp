#include "scenario/scenario.hpp"

#include <Eigen/Cholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <span>

#include "compensation/no_force_compensation.hpp"
#include "coordinator/preflight/step_stability.hpp"
#include "core/config/section.hpp"
#include "core/input_file.hpp"
#include "experimental_site/energy_error.hpp"
#include "mechanics/structure/stiffness_matrix.hpp"
#include "mechanics/structure/vibration_modes.hpp"
#include "numerical_substructure/scaled_model.hpp"
#include "scenario/bridging_section.hpp"
#include "scenario/catalogue/compensators.hpp"
#include "scenario/catalogue/force_compensators.hpp"
#include "scenario/catalogue/numerical_effects.hpp"
#include "scenario/catalogue/numerical_models.hpp"
#include "scenario/catalogue/rigs.hpp"
#include "scenario/catalogue/simulated_rig.hpp"
#include "scenario/named_file.hpp"
#include "scenario/plain_name.hpp"
#include "scenario/scenario_digest.hpp"
#include "scenario/sites_in_place.hpp"
#include "scenario/structure_section.hpp"

namespace hybridtest {
namespace {
using config::Section;

constexpr double kStepsAtMost = 1e9;
constexpr std::size_t kTestNameLongest = 64;
/// A column of a recording has at most 63 letters, and 15 of `displacement_…_m` are not the name's.
constexpr std::size_t kInterfaceNameLongest = 48;

std::string plain_name(Section& section, std::string_view key, std::size_t longest) {
  std::string name = section.text(key);
  if (name.size() > longest || (!name.empty() && !is_plain_name(name))) {
    section.error(key, "'" + name + "' does not serve as a name: expected at most " + std::to_string(longest) + " " +
                           std::string{kPlainNameRule});
  }
  return name;
}

void read_time(Section section, TimeScenario& time) {
  time.mode = static_cast<CouplingMode>(section.choice("mode", {"lockstep", "paced", "real_time"}));
  time.step_s = section.number("step_s", {.low = 1e-6, .high = 10.0});
  time.duration_s = section.number("duration_s", {.low = 0.0, .high = 1e6, .low_open = true});
  if (time.mode == CouplingMode::paced) {
    time.time_scale = section.number("time_scale", {.low = 1e-3, .high = 1e6}, 1.0);
  }
  const double steps = time.duration_s / time.step_s;
  if (steps < 1.0 || steps > kStepsAtMost) {
    section.error("duration_s", "the test would have " + std::to_string(steps) + " steps; expected 1 to 1e9");
  } else {
    time.last_step = static_cast<Step>(std::floor(steps * (1.0 + 1e-12) + 1e-9));
  }
  section.finish();
}

/// Waiting for a resumed coordinator is for tests that can stand still, and that have their state in our recording.
void check_resume(Section& root, const Scenario& scenario) {
  if (scenario.timeouts.resume <= Duration::zero()) return;
  if (scenario.time.mode == CouplingMode::real_time) {
    root.error("timeouts", "resume_s: a test in real time cannot wait for a coordinator; leave it out, or use `paced`");
  }
  if (scenario.opensees) {
    root.error("timeouts", "resume_s: OpenSees, which leads, cannot be resumed; leave it out");
  }
  const double lease_s = to_seconds(scenario.timeouts.silence_most());
  for (const SubstructureScenario& substructure : scenario.substructures) {
    if (substructure.role != Role::experimental_site) continue;
    if (substructure.site.loop.limits.command_age_s > lease_s) continue;
    root.error("timeouts", "resume_s: the site '" + substructure.id +
                               "' would end the test before it knows that the coordinator is lost: give it a "
                               "limits.command_age_s longer than timeouts.liveliness_lease_s");
  }
}

void read_timeouts(Section& root, CouplingMode mode, TimeoutScenario& timeouts) {
  constexpr Range kTimeout{.low = 0.1, .high = 86400.0};
  Section section = root.section_or_empty("timeouts");
  timeouts.discovery = from_seconds(section.number("discovery_s", kTimeout, 30.0));
  timeouts.arm = from_seconds(section.number("arm_s", kTimeout, 10.0));
  timeouts.stop = from_seconds(section.number("stop_s", kTimeout, 10.0));
  timeouts.liveliness_lease = from_seconds(section.number("liveliness_lease_s", kTimeout, 2.0));
  timeouts.link = from_seconds(section.number("link_s", {.low = 0.0, .high = 86400.0}, 0.0));
  if (mode == CouplingMode::real_time && timeouts.link > Duration{0}) {
    section.error("link_s", "in real time the test does not wait for a link that is down: leave it out");
  }
  timeouts.resume = from_seconds(section.number("resume_s", {.low = 0.0, .high = 86400.0}, 0.0));
  section.finish();
}

/// `{dof: …}`, with `relative_to` or without.
std::vector<InterfaceDof> one_dof(Section& entry, const DofTable& table) {
  InterfaceDof interface { .dof = dof_position(entry, "dof", table) };
  if (entry.has("relative_to")) {
    interface.relative_to = dof_position(entry, "relative_to", table);
    if (interface.relative_to == interface.dof) {
      entry.error("relative_to", "a degree of freedom relative to itself, expected another one");
      interface.relative_to = InterfaceDof::kGround;
    }
    if (table.size() == 0) interface.relative_to = InterfaceDof::kGround;  // reported
  }
  return {interface};
}

/// `{dofs: PATTERN}`: each of them against the ground.
std::vector<InterfaceDof> matching_dofs(Section& entry, const DofTable& table) {
  const std::string pattern = entry.text("dofs");
  std::vector<InterfaceDof> matching;
  for (const int row : table.matching(pattern)) matching.push_back({.dof = row});
  if (matching.empty()) entry.error("dofs", "no degree of freedom matches '" + pattern + "'");
  return matching;
}

void read_interface(Section& section, const DofTable& table, const ExcitationScenario& excitation,
                    SubstructureScenario& substructure) {
  const std::vector<std::string>& dofs = table.names();
  std::vector<InterfaceDof> interface_dofs;
  std::set<std::string> names;
  for (Section& entry : section.sections("interface")) {
    const bool is_pattern = entry.has("dofs");
    for (InterfaceDof interface : is_pattern ? matching_dofs(entry, table) : one_dof(entry, table)) {
      std::string name = dofs.empty() ? "" : dofs[static_cast<std::size_t>(interface.dof)];
      if (interface.relative_to != InterfaceDof::kGround) {
        name += "_relative_to_" + dofs[static_cast<std::size_t>(interface.relative_to)];
      }
      const std::string_view key = is_pattern ? "dofs" : "dof";
      if (!names.insert(name).second)
        entry.error(key, "the interface degree of freedom '" + name + "' is listed twice");
      if (substructure.role == Role::numerical_substructure && name.size() > kInterfaceNameLongest) {
        entry.error(key, "'" + name +
                             "' is the name of this interface degree of freedom in the recording; expected at "
                             "most " +
                             std::to_string(kInterfaceNameLongest) + " letters: shorten the names");
      }
      read_interface_support(entry, key, interface, excitation);
      interface_dofs.push_back(interface);
      substructure.interface_names.push_back(std::move(name));
    }
    entry.finish();
  }
  const bool is_numerical = substructure.role == Role::numerical_substructure;
  const auto most = static_cast<std::size_t>(is_numerical ? kMaxInterfaceDofs : kMaxSiteDofs);
  if (interface_dofs.empty() || interface_dofs.size() > most) {
    section.error("interface", std::to_string(interface_dofs.size()) + " degrees of freedom; expected 1 to " +
                                   std::to_string(most) +
                                   (is_numerical ? "" : ", which the control loop of a site has room for"));
    interface_dofs.resize(1);
    substructure.interface_names.resize(1);
  }
  // Without the names of the structure, which is an error by now, there is at least the first one.
  const auto structure_size = std::max<Eigen::Index>(1, std::ssize(dofs));
  substructure.interface = InterfaceMap{structure_size, std::move(interface_dofs)};
}

/// Named as in the recording or, against the ground, as in the table of the structure.
NamedInterface named_interface(const SubstructureScenario& substructure, const DofTable& table) {
  const std::vector<std::string>& names = substructure.interface_names;
  const std::vector<InterfaceDof>& dofs = substructure.interface.dofs();
  return {.names = names, .find = [&](const std::string& address) -> std::optional<int> {
            if (const auto named = std::ranges::find(names, address); named != names.end()) {
              return static_cast<int>(named - names.begin());
            }
            const std::optional<int> row = table.find(address);
            const auto grounded = std::ranges::find_if(dofs, [&](const InterfaceDof& dof) {
              return row && dof.dof == *row && dof.relative_to == InterfaceDof::kGround;
            });
            if (grounded == dofs.end()) return std::nullopt;
            return static_cast<int>(grounded - dofs.begin());
          }};
}

/// One compensator for all interface degrees of freedom, or one for each; none when the key is absent.
template <class Reading>
std::vector<Reading> read_each(Section& section, std::string_view key, std::size_t dofs, Reading (*read)(Section)) {
  std::vector<Reading> readings;
  for (Section& entry : section.sections_or_empty(key)) readings.push_back(read(entry));
  if (readings.size() != 1 && readings.size() != dofs) {
    section.error(key,
                  "expected one, or one for each of the " + std::to_string(dofs) + " interface degrees of freedom");
    if (readings.empty()) readings.push_back(read(section.section_or_empty(key)));
    readings.resize(1, readings.front());
  }
  if (readings.size() == 1) readings.resize(dofs, readings.front());
  return readings;
}

/// Of a site, beside its rig: checked before the test, used after it and, where the rig is elsewhere, in its place by
/// the preflight.
RigReading read_model_rig(Section section, int dofs) {
  if (section.has("type")) static_cast<void>(section.choice("type", {"simulated"}));
  RigReading reading = read_simulated_rig(section, dofs, 0, AbsentPart::ideal);
  section.finish();
  return reading;
}

std::vector<ForceDelay> force_delays(const RigReading& rig, std::span<const CompensatorReading> commands,
                                     std::span<const ForceCompensatorReading> forces) {
  std::vector<ForceDelay> delays{commands.size()};
  for (std::size_t k = 0; k < delays.size(); ++k) {
    ForceDelay& delay = delays[k];
    delay.transfer_s = rig.transfer_delay_s[k];
    delay.after_command_s = delay.transfer_s - commands[k].delay_s;
    delay.remaining_s =
        delay.after_command_s - std::clamp(delay.after_command_s, forces[k].delay_s_min, forces[k].delay_s_max);
    delay.is_learnt = commands[k].learns_delay || forces[k].learns_delay;
    if (forces[k].is_linear) continue;
    delay.moved_s = delay.after_command_s - delay.remaining_s;
    delay.further_s = forces[k].delay_s_max - delay.moved_s;
  }
  return delays;
}

SiteCompensation linear_compensation(const std::vector<CompensatorReading>& commands,
                                     const std::vector<ForceCompensatorReading>& forces, double period_s,
                                     LearntDelay learnt) {
  const EstimateBound bound = learnt == LearntDelay::largest ? EstimateBound::largest : EstimateBound::smallest;
  const bool is_initial = learnt == LearntDelay::initial;
  SiteCompensation made;
  for (const CompensatorReading& reading : commands) {
    made.commands.push_back(is_initial || !reading.make_at ? reading.make(period_s, 0.0)
                                                           : reading.make_at(period_s, bound));
  }
  for (const ForceCompensatorReading& reading : forces) {
    if (!reading.is_linear) {
      made.forces.push_back(std::make_unique<NoForceCompensation>());
    } else {
      made.forces.push_back(is_initial || !reading.make_at ? reading.make(period_s) : reading.make_at(period_s, bound));
    }
  }
  return made;
}

TrackingExpectation tracking_expectation(const RigReading& rig, std::span<const ForceDelay> delays,
                                         double control_period_s) {
  TrackingExpectation expectation{.follows_commands = rig.follows_commands,
                                  .control_period_s = control_period_s,
                                  .reading_delay_s = rig.silence_s_max,
                                  .displacement_resolution_m = rig.displacement_resolution_m,
                                  .force_always_varies = rig.force_always_varies};
  for (const ForceDelay& delay : delays) {
    expectation.reading_delay_s = std::max(expectation.reading_delay_s, rig.silence_s_max + delay.transfer_s);
    expectation.remaining_delay_s = std::max(expectation.remaining_delay_s, std::abs(delay.after_command_s));
  }
  return expectation;
}

/// A stiffness that a specimen at rest can have: symmetric, without a motion that it pushes along.
void check_initial_stiffness(Section& section, const Eigen::MatrixXd& stiffness_n_per_m) {
  constexpr const char* kKey = "initial_stiffness_n_per_m";
  constexpr double kRounding = 1e-9;  // of the largest entry
  try {
    Eigen::MatrixXd stiffness = checked_stiffness(stiffness_n_per_m);
    stiffness.diagonal().array() += kRounding * stiffness.cwiseAbs().maxCoeff();
    if (Eigen::LDLT<Eigen::MatrixXd>{stiffness}.isPositive()) return;
    section.error(kKey,
                  "is negative in some direction: the specimen would push itself away from rest; expected a positive "
                  "semidefinite matrix. A force is positive when it resists a positive displacement: check the sign");
  } catch (const ConfigError& error) {
    section.error(kKey, error.what());
  }
}

void read_site(Section& section, const Scenario& scenario, const std::filesystem::path& directory,
               SubstructureScenario& substructure) {
  const TimeScenario& time = scenario.time;
  const auto dofs = static_cast<std::size_t>(substructure.interface.size());
  SiteScenario& site = substructure.site;
  substructure.initial_stiffness_n_per_m = section.matrix("initial_stiffness_n_per_m", dofs, dofs);
  check_initial_stiffness(section, substructure.initial_stiffness_n_per_m);
  RigReading rig = read_rig(section.section("rig"), static_cast<int>(dofs), directory,
                            static_cast<int>(scenario.substructures.size()));
  site.rig_type = rig.type;
  site.rig_is_elsewhere = rig.is_elsewhere;
  site.rig_tables = std::move(rig.tables);
  site.specimen_stiffness_n_per_m = rig.stiffness_n_per_m;
  site.rating = rig.rating;
  site.displacement_noise_m = rig.displacement_noise_m;
  site.force_noise_n = rig.force_noise_n;
  site.nominal_inputs = std::move(rig.nominal_inputs);
  if (rig.keeps_time && time.mode == CouplingMode::lockstep) {
    section.error("rig",
                  "this rig keeps time by a clock of its own, which the mode `lockstep` does not; use `paced` or "
                  "`real_time`");
  }
  substructure.make_rig = std::move(rig.make);
  substructure.make_reference = std::move(rig.make_specimen);
  site.has_model = section.has_optional("model");
  if (site.has_model) {
    RigReading model = read_model_rig(section.section("model"), static_cast<int>(dofs));
    substructure.make_model_rig = std::move(model.make);
    if (!substructure.make_reference) substructure.make_reference = std::move(model.make_specimen);
  }
  site.control_rate_hz = section.number("control_rate_hz", {.low = 1.0, .high = 20e3}, 1024.0);

  const double site_step_s = time.step_s * time.time_scale;
  site.periods_per_step = std::max(1, static_cast<int>(std::ceil(site_step_s * site.control_rate_hz - 1e-6)));

  const auto commands = read_each(section, "compensator", dofs, read_compensator);
  const auto forces = read_each(section, "force_compensator", dofs, read_force_compensator);
  site.delays = force_delays(rig, commands, forces);
  substructure.make_compensation = [commands, forces](double period_s) {
    SiteCompensation made;
    for (const CompensatorReading& compensator : commands) made.commands.push_back(compensator.make(period_s, 0.0));
    for (const ForceCompensatorReading& compensator : forces) made.forces.push_back(compensator.make(period_s));
    return made;
  };
  substructure.make_linear_rig = [make_linear = rig.make_linear, given = substructure.initial_stiffness_n_per_m](
                                     double period_s, double displacement_m) {
    return make_linear(period_s, displacement_m, given);
  };
  substructure.make_linear_compensation = [commands, forces](double period_s, LearntDelay learnt) {
    return linear_compensation(commands, forces, period_s, learnt);
  };
  site.has_estimator = std::ranges::any_of(commands, [](const auto& reading) { return bool{reading.make_at}; }) ||
                       std::ranges::any_of(forces, [](const auto& reading) { return bool{reading.make_at}; });
  site.loop = read_loop(section, time.mode, site_step_s, std::chrono::duration<double>{scenario.timeouts.link}.count(),
                        tracking_expectation(rig, site.delays, site_step_s / site.periods_per_step));
  substructure.real_time = read_real_time(section, time.mode != CouplingMode::lockstep);
  if (time.mode == CouplingMode::real_time) {
    if (site.loop.trajectory.type == TrajectoryType::ramp_and_hold) {
      section.error("trajectory",
                    "ramp_and_hold waits for its targets, and real time does not: use predictor_corrector");
    }
    site.loop.trajectory.keeps_time = true;
    site.loop.trajectory.missed_most = scenario.real_time.bridging.most_in_a_row;
  }
}

SubstructureScenario read_substructure(Section& section, Scenario& scenario, const DofTable& table,
                                       const std::filesystem::path& directory) {
  SubstructureScenario substructure;
  substructure.id = plain_name(section, "id", ParticipantId::kCapacity);
  if (substructure.id == kCoordinatorId) section.error("id", "'coordinator' is taken by the coordinator itself");
  if (substructure.id == kOpenSeesId) section.error("id", "'opensees' stands for an OpenSees that leads");
  if (substructure.id == kOperatorId) section.error("id", "'operator' stands for the person at the controls");
  const bool is_numerical = section.choice("kind", {"numerical", "experimental"}) == 0;
  substructure.role = is_numerical ? Role::numerical_substructure : Role::experimental_site;
  read_interface(section, table, scenario.excitation, substructure);
  if (is_numerical) {
    substructure.make_model = read_model(section.section("model"), named_interface(substructure, table), directory,
                                         scenario.time.step_s, scenario.files);
    substructure.make_reference = substructure.make_model;
    const bool has_deadlines = scenario.time.mode == CouplingMode::real_time;
    if (has_deadlines) substructure.real_time = read_real_time(section, has_deadlines);
  } else {
    read_site(section, scenario, directory, substructure);
  }
  section.finish();
  return substructure;
}

/// K + sum over substructures of B^T K_s B.
Eigen::SparseMatrix<double> assembled_stiffness(const Scenario& scenario) {
  Eigen::SparseMatrix<double> stiffness = scenario.structure.stiffness_n_per_m;
  if (stiffness.size() == 0) stiffness.resize(scenario.structure.size(), scenario.structure.size());
  for (const SubstructureScenario& substructure : scenario.substructures) {
    stiffness += substructure.interface.on_structure(substructure.initial_stiffness_n_per_m);
  }
  stiffness.prune(0.0, 0.0);
  return stiffness;
}

/// Those at an interface of at most so many, each once, in order.
std::vector<Eigen::Index> interface_dofs(const Scenario& scenario, std::size_t widest = kMaxInterfaceDofs) {
  std::set<Eigen::Index> dofs;
  for (const SubstructureScenario& substructure : scenario.substructures) {
    if (substructure.interface_names.size() > widest) continue;
    for (const InterfaceDof& interface : substructure.interface.dofs()) {
      dofs.insert(interface.dof);
      if (interface.relative_to != InterfaceDof::kGround) dofs.insert(interface.relative_to);
    }
  }
  return {dofs.begin(), dofs.end()};
}

/// Positions of all, or of a wide interface those whose degree of freedom the coordinator records.
std::vector<Eigen::Index> recorded_interface(const SubstructureScenario& substructure,
                                             const std::vector<Eigen::Index>& recorded_dofs) {
  const std::vector<InterfaceDof>& dofs = substructure.interface.dofs();
  std::vector<Eigen::Index> recorded;
  for (std::size_t k = 0; k < dofs.size(); ++k) {
    if (dofs.size() <= kAllRecordedUpTo || std::ranges::binary_search(recorded_dofs, dofs[k].dof))
      recorded.push_back(static_cast<Eigen::Index>(k));
  }
  return recorded;
}

/// Of the elastic part: some force resists a displacement there.
bool is_held_by(const Eigen::SparseMatrix<double>& stiffness, Eigen::Index dof) {
  return dof < stiffness.cols() && stiffness.coeff(dof, dof) != 0.0;
}

void check_substructures(Section& root, const Scenario& scenario) {
  if (scenario.substructures.empty() || scenario.substructures.size() > kMaxSimulatedSubstructures) {
    root.error("substructures", std::to_string(scenario.substructures.size()) + " substructures; expected 1 to " +
                                    std::to_string(kMaxSubstructures) + ", or under simulated time alone up to " +
                                    std::to_string(kMaxSimulatedSubstructures));
  }
  for (std::size_t i = 0; i < scenario.substructures.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (scenario.substructures[i].id == scenario.substructures[j].id) {
        root.error("substructures", "two substructures with the id '" + scenario.substructures[i].id + "'");
      }
    }
  }
  const std::vector<Eigen::Index> coupled = interface_dofs(scenario);
  for (std::size_t dof = 0; dof < scenario.dofs.size(); ++dof) {
    const auto row = static_cast<Eigen::Index>(dof);
    if (std::ranges::binary_search(coupled, row) || is_held_by(scenario.structure.stiffness_n_per_m, row)) continue;
    root.error("substructures", "no substructure has the degree of freedom '" + scenario.dofs[dof] +
                                    "' at its interface: nothing would hold it");
  }
}

/// A specimen cannot go back to the state before a trial.
void check_trials(Section& integrator, const Scenario& scenario) {
  if (!scenario.integrator.needs.tries_displacements) return;
  if (scenario.time.mode == CouplingMode::real_time) {
    integrator.error("type", "'" + scenario.integrator.type +
                                 "' tries several displacements in a step; a step in real time has time for one");
  }
  for (const SubstructureScenario& substructure : scenario.substructures) {
    if (substructure.role != Role::experimental_site) continue;
    integrator.error("type", "'" + scenario.integrator.type +
                                 "' tries several displacements in a step, each from the state before it; the specimen "
                                 "of '" +
                                 substructure.id +
                                 "' cannot go back. Expected numerical substructures alone; with a site take an "
                                 "integrator that commands each displacement once, such as alpha_operator_splitting, "
                                 "cr or kr_alpha");
    return;
  }
}

/// The specimens of all sites get to their initial displacements without a jump and within their limits.
void check_initial_ramps(const Section& excitation, const Scenario& scenario) {
  for (const SubstructureScenario& substructure : scenario.substructures) {
    if (substructure.role != Role::experimental_site) continue;
    const SiteLimits& limits = substructure.site.loop.limits;
    check_initial_ramp(excitation, *scenario.excitation.free_vibration, {scenario.time.step_s, scenario.time.last_step},
                       substructure.id, substructure.interface, limits.displacement_m, limits.velocity_m_per_s,
                       scenario.time.time_scale);
  }
}

/// Makes the parts once, so that what they object to is found before anything runs.
void try_out(const Scenario& scenario, SubstructureScenario& substructure) {
  if (substructure.role == Role::numerical_substructure) {
    substructure.initial_stiffness_n_per_m = substructure.make_model()->initial_stiffness_n_per_m();
    return;
  }
  const double period_s = scenario.time.step_s * scenario.time.time_scale / substructure.site.periods_per_step;
  static_cast<void>(substructure.make_rig(period_s));
  static_cast<void>(substructure.make_compensation(period_s));
  static_cast<void>(EnergyErrorMonitor{substructure.initial_stiffness_n_per_m, 1.0});
}

/// Errors of the part that is computed; the damping that comes of the stiffness is that of the right one.
void apply(const NumericalErrors& errors, Scenario& scenario) {
  scenario.structure.mass_kg *= errors.mass;
  scenario.structure.damping_n_s_per_m *= errors.damping;
  if (errors.stiffness == 1.0) return;
  scenario.structure.stiffness_n_per_m *= errors.stiffness;
  for (SubstructureScenario& substructure : scenario.substructures) {
    if (substructure.role != Role::numerical_substructure) continue;
    substructure.make_model = [make = substructure.make_model, factor = errors.stiffness] {
      return std::make_unique<ScaledModel>(make(), factor);
    };
    substructure.make_reference = substructure.make_model;
    substructure.initial_stiffness_n_per_m *= errors.stiffness;
  }
  scenario.structure.initial_stiffness_n_per_m = assembled_stiffness(scenario);
}

/// Of the effective text; files of the structure count with their content.
ScenarioDigest digest_of(const Scenario& scenario) {
  constexpr std::size_t kAnySize = std::numeric_limits<std::size_t>::max();  // was read before, which bounds it
  std::string text = scenario.effective;
  for (const NamedFile& named : scenario.files) {
    if (!named.is_digested) continue;
    const ScenarioDigest content = sha256(read_input_file(named.file, kAnySize, "a matrix"));
    text.append(content.begin(), content.end());
  }
  return sha256(text);
}

/// Reports what a part finds wrong with its parameters at the section they came from.
template <class Work>
void report_at(Section section, Work work) {
  try {
    work();
  } catch (const ConfigError& error) {
    section.error("", error.what());
  }
}

}  // namespace

const SubstructureScenario* Scenario::find(std::string_view id) const noexcept {
  const auto found = std::ranges::find(substructures, id, &SubstructureScenario::id);
  return found == substructures.end() ? nullptr : &*found;
}

std::vector<std::string> SubstructureScenario::recorded_names() const {
  std::vector<std::string> names;
  for (const Eigen::Index k : recorded) names.push_back(interface_names[static_cast<std::size_t>(k)]);
  return names;
}

std::vector<std::string> Scenario::recorded_names() const {
  std::vector<std::string> names;
  for (const Eigen::Index dof : recorded_dofs) names.push_back(dofs[static_cast<std::size_t>(dof)]);
  return names;
}

SubstructureIndex Scenario::index_of(const SubstructureScenario& substructure) const noexcept {
  return static_cast<SubstructureIndex>(&substructure - substructures.data());
}

ControlLoopSettings control_loop_settings(const Scenario& scenario, const SubstructureScenario& substructure) {
  ControlLoopSettings settings;
  settings.mode = scenario.time.mode;
  settings.dofs = static_cast<int>(substructure.interface.size());
  settings.periods_per_step = substructure.site.periods_per_step;
  settings.time_scale = scenario.time.time_scale;
  settings.step_s = scenario.time.step_s * settings.time_scale;
  const LoopScenario& loop = substructure.site.loop;
  settings.limits = loop.limits;
  settings.rules = loop.rules;
  settings.tracking_window_s = loop.tracking_window_s;
  settings.trajectory = loop.trajectory;
  settings.ramp_in_s = loop.ramp_in_s;
  settings.captures_zero_offsets = loop.captures_zero_offsets;
  settings.returns_at_end = loop.returns_at_end;
  settings.return_time_s = loop.return_time_s;
  return settings;
}

bool is_test_name(std::string_view name) noexcept { return name.size() <= kTestNameLongest && is_plain_name(name); }

namespace {

std::vector<Section> read_substructures(Section& root, const config::Document& document, const DofTable& table,
                                        Scenario& scenario) {
  std::vector<Section> substructures = root.sections("substructures");
  for (Section& section : substructures) {
    scenario.substructures.push_back(read_substructure(section, scenario, table, document.directory()));
  }
  return substructures;
}

/// What is recorded: the end of a scenario.
void read_rest(Section& root, const DofTable& table, Scenario& scenario) {
  // The interfaces of more substructures than go over a network may be more than a table has columns for.
  const bool has_few = scenario.substructures.size() <= kMaxSubstructures;
  scenario.recorded_dofs = read_output(root, table, {interface_dofs(scenario, kAllRecordedUpTo), has_few},
                                       !scenario.excitation.forces.empty());
  for (SubstructureScenario& substructure : scenario.substructures) {
    substructure.recorded = recorded_interface(substructure, scenario.recorded_dofs);
  }
  check_resume(root, scenario);
  Section recording = root.section_or_empty("recording");
  scenario.stop_on_recording_failure = recording.choice("on_failure", {"stop", "continue"}, "stop") == 0;
  recording.finish();
  root.finish();
}

void try_out_all(const config::Document& document, const std::vector<Section>& sections, Scenario& scenario) {
  document.throw_if_errors();
  for (std::size_t i = 0; i < sections.size(); ++i) {
    report_at(sections[i], [&] { try_out(scenario, scenario.substructures[i]); });
  }
  document.throw_if_errors();
}

/// A test whose coordinator integrates the structure.
void read_integrated(const config::Document& document, Section& root, Scenario& scenario) {
  Section excitation = root.section("excitation");
  Section structure = root.section("structure");
  StructureReading reading = read_structure(structure, document.directory());
  scenario.dofs = reading.dofs.names();
  scenario.structure = std::move(reading.structure);
  const TestSteps test{scenario.time.step_s, scenario.time.last_step};
  scenario.excitation = read_excitation(excitation, reading.dofs, test, document.directory(), scenario.files);
  scenario.files.insert(scenario.files.end(), reading.files.begin(), reading.files.end());
  scenario.structure.influence = scenario.excitation.records.empty() ? uniform_influence(reading.dofs, 0)
                                                                     : scenario.excitation.records.front().influence;
  Section integrator = root.section("integrator");
  scenario.integrator = read_integrator(integrator);

  const std::vector<Section> substructures = read_substructures(root, document, reading.dofs, scenario);
  const NumericalErrors errors = read_numerical_errors(root);
  read_rest(root, reading.dofs, scenario);
  check_substructures(root, scenario);
  check_trials(integrator, scenario);
  try_out_all(document, substructures, scenario);

  report_at(structure, [&] {
    scenario.structure.initial_stiffness_n_per_m = assembled_stiffness(scenario);
    scenario.structure.damping_n_s_per_m.resize(scenario.structure.size(), scenario.structure.size());
    require_consistent(scenario.structure);
    scenario.structure.damping_n_s_per_m = reading.damping(scenario.structure);
    apply(errors, scenario);
  });
  document.throw_if_errors();
  if (scenario.excitation.free_vibration) {
    report_at(excitation.section("free_vibration"), [&] {
      let_others_follow(*scenario.excitation.free_vibration, scenario.structure.initial_stiffness_n_per_m);
      check_initial_ramps(excitation, scenario);
    });
    document.throw_if_errors();
  }
  scenario.integrator_step_s = scenario.time.step_s * errors.step;
  if (!scenario.integrator.needs.initial_stiffness) {
    report_at(root.section("time"),
              [&] { require_stable_step(vibration_modes(scenario.structure, 0), scenario.integrator_step_s); });
  }
  scenario.make_integrator = [structure = scenario.structure, integrator = scenario.integrator,
                              start = scenario.excitation.free_vibration, step_s = scenario.integrator_step_s] {
    return begun_integrator(integrator, start, structure, step_s);
  };
  report_at(integrator, [&] { static_cast<void>(scenario.make_integrator()); });
  document.throw_if_errors();
}

/// Each substructure has one element, which has the degrees of freedom of its interface.
void check_elements(Section& root, const Scenario& scenario) {
  Section section = root.section("coordinator");
  std::set<std::string> known;
  for (const LedElementScenario& element : scenario.opensees->elements) {
    const SubstructureScenario* substructure = scenario.find(element.substructure);
    if (substructure == nullptr) {
      section.error("elements", "there is no substructure '" + element.substructure + "'");
    } else if (!known.insert(element.substructure).second) {
      section.error("elements", "two elements for the substructure '" + element.substructure + "', expected one");
    } else {
      for (const InterfaceDof& dof : substructure->interface.dofs()) {
        for (const int row : {dof.dof, dof.relative_to}) {
          if (row == InterfaceDof::kGround) continue;
          const std::string& name = scenario.dofs[static_cast<std::size_t>(row)];
          if (std::ranges::find(element.dofs, name) != element.dofs.end()) continue;
          section.error("elements", "the interface of '" + element.substructure + "' has the degree of freedom '" +
                                        name + "', its element has not");
        }
      }
    }
  }
  for (const SubstructureScenario& substructure : scenario.substructures) {
    if (known.contains(substructure.id)) continue;
    section.error("elements", "no element for the substructure '" + substructure.id + "'");
  }
}

/// A test whose coordinator asks OpenSees for each displacement. The structure is in OpenSees: here it has neither mass
/// nor load.
void read_led(const config::Document& document, Section& root, Scenario& scenario) {
  const DofTable table{scenario.opensees->dofs};
  scenario.dofs = table.names();
  const auto size = std::ssize(scenario.dofs);
  for (auto* matrix : {&scenario.structure.mass_kg, &scenario.structure.damping_n_s_per_m}) matrix->resize(size, size);
  scenario.structure.degrees_of_freedom = scenario.dofs;
  scenario.structure.influence = Eigen::VectorXd::Zero(size);
  scenario.integrator_step_s = scenario.time.step_s;
  for (const char* key : {"structure", "excitation", "integrator"}) {
    if (root.has_optional(key))
      root.error(key, "is in the model of OpenSees, which leads (coordinator.type); leave it out");
  }
  const std::vector<Section> substructures = read_substructures(root, document, table, scenario);
  read_rest(root, table, scenario);
  check_substructures(root, scenario);
  check_elements(root, scenario);
  try_out_all(document, substructures, scenario);
  scenario.structure.initial_stiffness_n_per_m = assembled_stiffness(scenario);
}

}  // namespace

Scenario read_scenario(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  config::Document document = config::Document::load(file, with_sites_in_place(file, overrides));
  Section root = document.root();
  Scenario scenario;
  scenario.file = file;
  static_cast<void>(root.choice("schema", {"hybridtest/1"}));
  scenario.name = plain_name(root, "name", kTestNameLongest);
  if (root.has("description")) static_cast<void>(root.text("description", ""));
  read_time(root.section("time"), scenario.time);
  read_timeouts(root, scenario.time.mode, scenario.timeouts);
  scenario.opensees = read_opensees_lead(root, document.directory(), scenario.files);
  if (scenario.time.mode == CouplingMode::real_time) {
    scenario.real_time = {read_bridging(root, scenario.time.step_s), read_real_time(root, true)};
    if (scenario.opensees) root.error("coordinator", "OpenSees, which leads, has no deadlines: use `paced`");
  }
  if (scenario.opensees) {
    read_led(document, root, scenario);
  } else {
    read_integrated(document, root, scenario);
  }
  scenario.effective = document.effective();
  scenario.digest = digest_of(scenario);
  return scenario;
}

}  // namespace hybridtest
