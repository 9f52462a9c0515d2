#include <fmt/format.h>

#include "core/config_error.hpp"
#include "core/exit_code.hpp"
#include "launch/check_lines.hpp"
#include "launch/commands.hpp"
#include "scenario/scenario.hpp"
#include "scenario/site_model_file.hpp"

namespace hybridtest {
namespace {

struct CheckOptions {
  std::filesystem::path file;
  std::vector<std::string> overrides;
  std::filesystem::path json;
  bool is_quick = false;
};

int check_site_file(const std::filesystem::path& file) {
  const SiteModelFile model = read_site_model(file);
  fmt::print(
      "{}: a valid site file, {} interface degree(s) of freedom. It is no test by itself: use it as\n"
      "  --model {} of `diagnose` and `replay`, or as `rig: {{model: {}}}` in a scenario\n",
      file.string(), model.dofs.size(), file.string(), file.filename().string());
  return kExitCompleted;
}

int check(const CheckOptions& options) {
  if (is_site_file(options.file)) {
    if (!options.overrides.empty()) {
      throw ConfigError{"--set " + options.overrides.front() +
                        ": a site file takes no overrides; change the file itself"};
    }
    return check_site_file(options.file);
  }
  const Scenario scenario = read_scenario(options.file, options.overrides);
  // JSON alone where it goes to standard output.
  std::FILE* const out = options.json == "-" ? nullptr : stdout;
  if (out != nullptr) {
    fmt::print("{}: valid, {} degrees of freedom, {} substructures, {} steps\n", scenario.name, scenario.dofs.size(),
               scenario.substructures.size(), scenario.time.last_step);
    std::fflush(out);
  }
  CheckReport report{scenario.name};
  if (scenario.opensees) {
    check_led_test(scenario, report, out);
  } else {
    const TestStability stability = check_stability(scenario, report, out);
    // An unstable test has no peaks but those of its interlocks.
    if (!options.is_quick && !stability.is_unstable(scenario.integrator_step_s)) check_peaks(scenario, report, out);
  }
  if (out != nullptr) report.print_verdict(out);
  if (!options.json.empty()) report.write_json(options.json);
  return report.worst() == CheckVerdict::fail ? kExitConfiguration : kExitCompleted;
}

}  // namespace

void add_check_command(CLI::App& app, CommandAction& action) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* command = app.add_subcommand(
      "check",
      "Check a scenario or a site file and list all its errors; of a scenario, judge the ground motion, modes, step,\n"
      "critical delay, delay margin and noise of each site, and the peaks of a simulated run against limits and\n"
      "ratings. Each line is pass, caution or FAIL; a FAIL is exit code 2");
  command->add_option("FILE", options->file, "Scenario file (YAML)")->required();
  command->add_option("--set", options->overrides, "Override one value of the scenario: key.path=value; repeatable");
  command->add_flag("--quick", options->is_quick, "Leave out the simulated run, and with it the predicted peaks");
  command->add_option("--json", options->json, "Write the same lines to this file as JSON; -: standard output");
  command->callback([options, &action] { action = [options] { return check(*options); }; });
}

}  // namespace hybridtest
