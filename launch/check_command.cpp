#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/config_error.hpp"
#include "core/exit_code.hpp"
#include "launch/commands.hpp"
#include "launch/excitation_text.hpp"
#include "mechanics/structure/damping.hpp"
#include "scenario/scenario.hpp"
#include "scenario/site_model_file.hpp"
#include "scenario/test_stability.hpp"

namespace hybridtest {
namespace {

void print_modes(const Scenario& scenario, const VibrationModes& modes) {
  const Eigen::VectorXd ratios = damping_ratios(scenario.structure, modes);
  fmt::print("\nmode  frequency    period    damping  effective mass\n");
  for (Eigen::Index mode = 0; mode < modes.count(); ++mode) {
    fmt::print("{:4}  {:6.3f} Hz  {:6.4f} s  {:6.2f} %  {:10.4g} kg\n", mode + 1,
               modes.frequency_rad_per_s[mode] / (2.0 * std::numbers::pi), modes.period_s(mode), 100.0 * ratios[mode],
               modes.effective_mass_kg[mode]);
  }
  if (modes.count() == scenario.structure.size()) return;
  fmt::print("and {} more; the highest frequency is at most {:.4g} Hz\n", scenario.structure.size() - modes.count(),
             modes.highest_frequency_rad_per_s() / (2.0 * std::numbers::pi));
}

/// One row in brackets after the other.
std::string written(const Eigen::MatrixXd& matrix) {
  std::string text;
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    std::string entries;
    for (const double entry : matrix.row(row)) entries += fmt::format("{}{:.6g}", entries.empty() ? "" : ", ", entry);
    text += fmt::format("{}[{}]", row == 0 ? "" : ", ", entries);
  }
  return "[" + text + "]";
}

void print_stiffness(const SiteStability& stability) {
  if (stability.stiffness_error <= kStiffnessTolerance) return;
  fmt::print("  WARNING: initial_stiffness_n_per_m is {}, but the simulated specimen has\n",
             written(stability.site->initial_stiffness_n_per_m));
  fmt::print("  {} N/m from rest. The figures below are those of the specimen. Correct the scenario:\n",
             written(stability.specimen_stiffness_n_per_m));
  fmt::print("  damping, energy error and the stability limit of the step come from its number.\n");
}

void print_step(const Scenario& scenario, const TestStability& stability) {
  const double step_s = scenario.integrator_step_s;
  fmt::print("\n{}: step {:.6g} s, ", scenario.integrator.text, step_s);
  if (!scenario.integrator.needs.initial_stiffness) {
    fmt::print("stable up to {:.6g} s ({:.1f} % used)\n", stability.step.step_s_max,
               100.0 * step_s / stability.step.step_s_max);
    return;
  }
  fmt::print("stable with any step while no stiffness exceeds the initial one\n");
  if (stability.grows) {
    fmt::print("  UNSTABLE: a free vibration with the specimens and the delays that remain grows\n");
  }
  if (stability.has_modes_beyond_step) {
    fmt::print("  modes above {:.4g} Hz are faster than the step can show; the integrator slows them down\n",
               1.0 / (std::numbers::pi * step_s));
  }
}

void print_delays(const SiteStability& stability, bool is_known) {
  const ForceDelay& delay = stability.delay;
  if (!is_known) {
    fmt::print("  critical delay      not known with modes faster than the step: look at a simulated run\n");
  } else if (std::isnan(stability.critical.delay_s)) {
    fmt::print("  critical delay      not computed: more than {} degrees of freedom. Simulate the test with this\n",
               kCriticalDelaySizeMax);
    fmt::print("                      transfer system, and look for motion that grows\n");
  } else if (std::isfinite(stability.critical.delay_s)) {
    fmt::print("  critical delay      {:.3f} ms, at {:.2f} Hz\n", 1e3 * stability.critical.delay_s,
               stability.critical.frequency_rad_per_s / (2.0 * std::numbers::pi));
  } else {
    fmt::print("  critical delay      none: stable at any delay\n");
  }
  fmt::print("  transfer system     {:.3f} ms delay at low frequency\n", 1e3 * delay.transfer_s);
  fmt::print("  compensated         {:.3f} ms by the command, {:.3f} ms by the force\n",
             1e3 * (delay.transfer_s - delay.after_command_s), 1e3 * (delay.after_command_s - delay.remaining_s));
  if (!is_known || !std::isfinite(stability.critical.delay_s)) return;
  fmt::print("  delay margin        {:.3f} ms", 1e3 * stability.margin_s());
  if (stability.is_unstable()) {
    fmt::print("   UNSTABLE: the motion will grow until an interlock ends the test\n");
  } else {
    fmt::print("{}\n", delay.is_learnt ? " at the start; the delay is learnt during the test" : "");
  }
}

void print_interlocks(const SiteLimits& limits) {
  fmt::print("  tracking error      {}\n", limits.tracking_error_m
                                               ? fmt::format("at most {:.4g} mm", 1e3 * *limits.tracking_error_m)
                                               : "not checked");
  if (!limits.stuck_samples) {
    fmt::print("  stuck sensors       not checked\n");
    return;
  }
  fmt::print("  stuck sensors       {} equal readings of {} after {:.4g} mm of motion\n", *limits.stuck_samples,
             limits.stuck_judges_force ? "displacement or force" : "displacement", 1e3 * limits.stuck_while_moving_m);
}

void print_site(const Scenario& scenario, const SiteStability& stability, bool delay_is_known) {
  const SiteScenario& site = stability.site->site;
  fmt::print("\nsite {}: {} rig\n", stability.site->id, site.rig_type);
  fmt::print("  control rate        {:.6g} Hz requested, {:.6g} Hz used ({} per step)\n", site.control_rate_hz,
             site.periods_per_step / (scenario.time.step_s * scenario.time.time_scale), site.periods_per_step);
  print_stiffness(stability);
  fmt::print("  stiffness share    ");
  for (const double share : stability.stiffness_share) fmt::print(" {:.1f} %", 100.0 * share);
  fmt::print(" of modes 1 to {}\n", stability.stiffness_share.size());
  print_delays(stability, delay_is_known);
  print_interlocks(site.loop.limits);
}

int check_site_file(const std::filesystem::path& file) {
  const SiteModelFile model = read_site_model(file);
  fmt::print(
      "{}: a valid site file, {} interface degree(s) of freedom. It is no test by itself: use it as\n"
      "  --model {} of `diagnose` and `replay`, or as `rig: {{model: {}}}` in a scenario\n",
      file.string(), model.dofs.size(), file.string(), file.filename().string());
  return kExitCompleted;
}

int check(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  if (is_site_file(file)) {
    if (!overrides.empty()) {
      throw ConfigError{"--set " + overrides.front() + ": a site file takes no overrides; change the file itself"};
    }
    return check_site_file(file);
  }
  const Scenario scenario = read_scenario(file, overrides);
  const VibrationModes modes = vibration_modes(scenario.structure);
  const TestStability stability = test_stability(scenario, modes);
  fmt::print("{}: valid, {} degrees of freedom, {} substructures, {} steps\n", scenario.name, scenario.dofs.size(),
             scenario.substructures.size(), scenario.time.last_step);
  fmt::print("{}", excitation_text(scenario, modes));
  print_modes(scenario, modes);
  print_step(scenario, stability);
  for (const SiteStability& site : stability.sites) print_site(scenario, site, !stability.has_modes_beyond_step);
  const bool is_unstable = stability.is_unstable(scenario.integrator_step_s);
  if (is_unstable) {
    fmt::print(
        "\nUNSTABLE: do not run this test with a specimen. Compensate the delay of each site to within its critical\n"
        "delay, correct its initial stiffness, or shorten the step.\n");
  }
  if (stability.has_wrong_stiffness()) {
    fmt::print("\nWRONG STIFFNESS: correct initial_stiffness_n_per_m, which is off by more than a factor of two.\n");
  }
  return is_unstable || stability.has_wrong_stiffness() ? kExitConfiguration : kExitCompleted;
}

}  // namespace

void add_check_command(CLI::App& app, CommandAction& action) {
  auto file = std::make_shared<std::filesystem::path>();
  auto overrides = std::make_shared<std::vector<std::string>>();
  CLI::App* command = app.add_subcommand(
      "check",
      "Check a scenario or a site file and list all its errors; of a scenario, print the ground motion, modes, the\n"
      "stability limit of the step, and the critical delay and delay margin of each site. An unstable test or\n"
      "a wrong stiffness of a simulated specimen is exit code 2");
  command->add_option("FILE", *file, "Scenario file (YAML)")->required();
  command->add_option("--set", *overrides, "Override one value of the scenario: key.path=value; repeatable");
  command->callback([file, overrides, &action] { action = [file, overrides] { return check(*file, *overrides); }; });
}

}  // namespace hybridtest
