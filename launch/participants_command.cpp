#include <fmt/format.h>

#include "core/exit_code.hpp"
#include "launch/commands.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {
namespace {

struct ParticipantsOptions {
  std::filesystem::path scenario_file;
  std::vector<std::string> overrides;
};

int print_participants(const ParticipantsOptions& options) {
  const Scenario scenario = read_scenario(options.scenario_file, options.overrides);
  fmt::print("test {}\ncoordinator {}\n", scenario.name, kCoordinatorId);
  for (const SubstructureScenario& substructure : scenario.substructures)
    fmt::print("substructure {}\n", substructure.id);
  return kExitCompleted;
}

}  // namespace

void add_participants_command(CLI::App& app, CommandAction& action) {
  auto options = std::make_shared<ParticipantsOptions>();
  CLI::App* command = app.add_subcommand(
      "participants",
      "List the test and its participants in the scenario's order, for scripts: kind and name, one a line");
  command->add_option("FILE", options->scenario_file, "Scenario file (YAML)")->required();
  command->add_option("--set", options->overrides, "Override one value of the scenario: key.path=value; repeatable");
  command->callback([options, &action] { action = [options] { return print_participants(*options); }; });
}

}  // namespace hybridtest
