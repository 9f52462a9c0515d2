#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "coordinator/preflight/critical_delay.hpp"
#include "coordinator/preflight/site_coupling.hpp"
#include "coordinator/preflight/step_stability.hpp"
#include "core/exit_code.hpp"
#include "launch/commands.hpp"
#include "mechanics/structure/damping.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {
namespace {

CoupledSite coupled_site(const SubstructureScenario& substructure) {
  CoupledSite site;
  site.id = substructure.id;
  site.interface = substructure.interface;
  site.stiffness_n_per_m = substructure.initial_stiffness_n_per_m;
  return site;
}

void print_modes(const Scenario& scenario, const VibrationModes& modes) {
  const Eigen::VectorXd ratios = damping_ratios(scenario.structure, modes);
  fmt::print("\nmode  frequency    period    damping  effective mass\n");
  for (Eigen::Index mode = 0; mode < modes.count(); ++mode) {
    fmt::print("{:4}  {:6.3f} Hz  {:6.4f} s  {:6.2f} %  {:10.4g} kg\n", mode + 1,
               modes.frequency_rad_per_s[mode] / (2.0 * std::numbers::pi), modes.period_s(mode), 100.0 * ratios[mode],
               modes.effective_mass_kg[mode]);
  }
}

void print_site(const Scenario& scenario, const VibrationModes& modes, const std::vector<CoupledSite>& sites,
                std::size_t position, const SubstructureScenario& substructure) {
  const SiteScenario& site = substructure.site;
  const Eigen::VectorXd shares = stiffness_share_by_mode(scenario.structure, modes, sites[position]);
  const CriticalDelay critical = critical_delay(scenario.structure, sites, position);
  fmt::print("\nsite {}: {} rig\n", substructure.id, site.rig_type);
  fmt::print("  control rate        {:.6g} Hz requested, {:.6g} Hz used ({} per step)\n", site.control_rate_hz,
             site.periods_per_step / (scenario.time.step_s * scenario.time.time_scale), site.periods_per_step);
  fmt::print("  stiffness share    ");
  for (const double share : shares) fmt::print(" {:.1f} %", 100.0 * share);
  fmt::print(" of modes 1 to {}\n", shares.size());
  if (std::isfinite(critical.delay_s)) {
    fmt::print("  critical delay      {:.3f} ms, at {:.2f} Hz\n", 1e3 * critical.delay_s,
               critical.frequency_rad_per_s / (2.0 * std::numbers::pi));
  } else {
    fmt::print("  critical delay      none: stable at any delay\n");
  }
  const double left_s = site.transfer_delay_s - site.compensated_delay_s;
  fmt::print("  transfer system     {:.3f} ms delay at low frequency, {:.3f} ms of it compensated\n",
             1e3 * site.transfer_delay_s, 1e3 * site.compensated_delay_s);
  if (!std::isfinite(critical.delay_s)) return;
  fmt::print(
      "  delay margin        {:.3f} ms{}\n", 1e3 * (critical.delay_s - std::abs(left_s)),
      std::abs(left_s) < critical.delay_s ? "" : "   UNSTABLE: the motion will grow until an interlock ends the test");
}

int check(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  const Scenario scenario = read_scenario(file, overrides);
  const VibrationModes modes = vibration_modes(scenario.structure);
  const StepStability stability = step_stability(modes);
  fmt::print("{}: valid, {} degrees of freedom, {} substructures, {} steps\n", scenario.name, scenario.dofs.size(),
             scenario.substructures.size(), scenario.time.last_step);
  print_modes(scenario, modes);
  fmt::print("\n{}: step {:.6g} s, stable up to {:.6g} s ({:.1f} % used)\n", scenario.integrator_type,
             scenario.time.step_s, stability.step_s_max, 100.0 * scenario.time.step_s / stability.step_s_max);

  std::vector<CoupledSite> sites;
  std::vector<const SubstructureScenario*> experimental;
  for (const SubstructureScenario& substructure : scenario.substructures) {
    if (substructure.role != Role::experimental_site) continue;
    sites.push_back(coupled_site(substructure));
    experimental.push_back(&substructure);
  }
  for (std::size_t i = 0; i < sites.size(); ++i) print_site(scenario, modes, sites, i, *experimental[i]);
  return kExitCompleted;
}

}  // namespace

void add_check_command(CLI::App& app, CommandAction& action) {
  auto file = std::make_shared<std::filesystem::path>();
  auto overrides = std::make_shared<std::vector<std::string>>();
  CLI::App* command = app.add_subcommand(
      "check",
      "Check a scenario and list all its errors; print modes, the stability limit of the step, and the\n"
      "critical delay and delay margin of each site");
  command->add_option("FILE", *file, "Scenario file (YAML)")->required();
  command->add_option("--set", *overrides, "Override one value of the scenario: key.path=value; repeatable");
  command->callback([file, overrides, &action] { action = [file, overrides] { return check(*file, *overrides); }; });
}

}  // namespace hybridtest
