#include <fmt/format.h>

#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <iostream>

#include "core/config_error.hpp"
#include "core/exit_code.hpp"
#include "launch/commands.hpp"
#include "recording/summary/run_summary.hpp"
#include "runtime/run_directory.hpp"
#include "scenario/scenario.hpp"
#include "validation/reference/monolithic_response.hpp"
#include "validation/reference/opensees_model.hpp"
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
  std::string with;  // `opensees`, or empty
  std::string program;
  bool only_writes = false;
};

/// The scenario with a step that is `refine` times shorter.
Scenario refined(const ReferenceOptions& options) {
  Scenario scenario = read_scenario(options.scenario_file, options.overrides);
  if (options.refine == 1) return scenario;
  std::vector<std::string> overrides = options.overrides;
  overrides.push_back(fmt::format("time.step_s={:.17g}", scenario.time.step_s / options.refine));
  return read_scenario(options.scenario_file, overrides);
}

/// A line that is written over on a terminal.
void show_progress(const std::string& text, bool is_last) {
  const bool is_terminal = isatty(fileno(stderr)) == 1;
  if (is_terminal || is_last)
    fmt::print(stderr, "{}reference: {}{}", is_terminal ? "\r" : "", text, is_last ? "\n" : "");
}

ReferenceResponse in_process(const Scenario& scenario) {
  return monolithic_response(
      scenario, [](Step step, Step last) { show_progress(fmt::format("step {}/{}", step, last), step == last); });
}

/// The model, in `folder`.
fs::path written_model(const Scenario& scenario, const fs::path& folder) {
  fs::path script = folder / "opensees.tcl";
  std::ofstream file{script};
  file << opensees_model(scenario, fs::absolute(folder / "opensees.out"));
  if (!file.flush()) throw ConfigError{script.string() + ": cannot be written; check the folder and the disk"};
  return script;
}

ReferenceResponse with_opensees(const Scenario& scenario, const fs::path& folder, const std::string& program) {
  const fs::path script = written_model(scenario, folder);
  int looks = 0;
  run_opensees(script, program, [&] {
    // Five looks a second.
    if (++looks % 5 == 0) show_progress(fmt::format("OpenSees computes, {} s", looks / 5), false);
  });
  show_progress("OpenSees has finished", true);
  return read_opensees_response(scenario, folder / "opensees.out");
}

int make_reference(const ReferenceOptions& options) {
  const Scenario scenario = refined(options);
  const std::string name = options.with.empty() ? "in_process" : options.with;
  const fs::path folder = !options.out.empty()   ? options.out
                          : !options.run.empty() ? reference_folder(options.run)
                                                 : fs::path{scenario.name + "_reference"};
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) throw ConfigError{"--out " + folder.string() + ": cannot write there: " + failed.message()};
  if (options.only_writes) {
    fmt::print("{}\n", written_model(scenario, folder).string());
    return kExitCompleted;
  }
  const ReferenceResponse response =
      options.with.empty() ? in_process(scenario) : with_opensees(scenario, folder, options.program);
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
  command->add_option("--with", options->with, "Compute it with another program, from a model written for it")
      ->check(CLI::IsMember({"opensees"}));
  command->add_option("--program", options->program, "OpenSees: its path, or a name found in PATH")
      ->default_str("HYBRIDTEST_OPENSEES, else OpenSees");
  command->add_flag("--write-only", options->only_writes, "Write the model for OpenSees and stop");
  command->add_option("--set", options->overrides, "Override one value of the scenario: key.path=value; repeatable");
  command->callback([options, &action] { action = [options] { return make_reference(*options); }; });
}

}  // namespace hybridtest
