#include <fmt/format.h>

#include <unistd.h>

#include <cstdio>
#include <iostream>

#include "core/config_error.hpp"
#include "core/exit_code.hpp"
#include "launch/commands.hpp"
#include "recording/summary/run_summary.hpp"
#include "runtime/run_directory.hpp"
#include "scenario/scenario.hpp"
#include "validation/reference/monolithic_response.hpp"
#include "validation/reference/response_comparison.hpp"

namespace hybridtest {
namespace {

namespace fs = std::filesystem;

struct ReferenceOptions {
  fs::path scenario_file;
  std::vector<std::string> overrides;
  fs::path run;
  fs::path out;
  int refine = 1;
};

/// The scenario with a step that is `refine` times shorter.
Scenario refined(const ReferenceOptions& options) {
  const Scenario scenario = read_scenario(options.scenario_file, options.overrides);
  if (options.refine == 1) return scenario;
  std::vector<std::string> overrides = options.overrides;
  overrides.push_back(fmt::format("time.step_s={:.17g}", scenario.time.step_s / options.refine));
  return read_scenario(options.scenario_file, overrides);
}

int make_reference(const ReferenceOptions& options) {
  const Scenario scenario = refined(options);
  const std::string name = "in_process";
  const fs::path folder = !options.out.empty()   ? options.out
                          : !options.run.empty() ? reference_folder(options.run)
                                                 : fs::path{scenario.name + "_reference"};
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) throw ConfigError{"--out " + folder.string() + ": cannot write there: " + failed.message()};
  const bool is_terminal = isatty(fileno(stderr)) == 1;
  const auto show = [&](Step step, Step last) {
    if (is_terminal || step == last)
      fmt::print(stderr, "{}reference: step {}/{}{}", is_terminal ? "\r" : "", step, last, step == last ? "\n" : "");
  };
  const ReferenceResponse response = monolithic_response(scenario, show);
  write_response(scenario, response, folder / (name + ".csv"));
  fmt::print("{}: {} steps of {:.6g} s without coupling, in {}\n", scenario.name, scenario.time.last_step,
             response.step_s, (folder / (name + ".csv")).string());
  if (options.run.empty()) {
    for (std::size_t i = 0; i < scenario.dofs.size(); ++i) {
      fmt::print("    {:<26}peak {:.3f} mm\n", scenario.dofs[i],
                 1e3 * response.displacement_m.row(static_cast<Eigen::Index>(i)).cwiseAbs().maxCoeff());
    }
    return kExitCompleted;
  }
  const ReferenceComparison comparison = compare_run(options.run, scenario, response, name);
  write_reference_comparison(comparison, folder / (name + ".json"));
  print_comparisons({comparison}, std::cout);
  if (folder == reference_folder(options.run)) {
    write_summary_json(summarise(options.run), options.run / "summary.json");
  }
  return kExitCompleted;
}

}  // namespace

void add_reference_command(CLI::App& app, CommandAction& action) {
  auto options = std::make_shared<ReferenceOptions>();
  CLI::App* command = app.add_subcommand(
      "reference",
      "Compute a test without coupling: the laws of models and specimens in one process, each step iterated to\n"
      "equilibrium, no actuators, sensors or network. Compare a run with it; `summary` then shows the comparison");
  command->add_option("FILE", options->scenario_file, "Scenario file (YAML)")->required();
  command->add_option("--run", options->run, "Run directory to compare with")->check(CLI::ExistingDirectory);
  command->add_option("--out", options->out, "Folder for the results")
      ->default_str("RUN/reference, or NAME_reference without --run");
  command->add_option("--refine", options->refine, "Divide the step of the test by this number")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--set", options->overrides, "Override one value of the scenario: key.path=value; repeatable");
  command->callback([options, &action] { action = [options] { return make_reference(*options); }; });
}

}  // namespace hybridtest
