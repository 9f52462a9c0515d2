#include <fmt/format.h>

#include <memory>

#include "core/exit_code.hpp"
#include "launch/commands.hpp"
#include "scenario/catalogue/documentation.hpp"

namespace hybridtest {

void add_effects_command(CLI::App& app, CommandAction& action) {
  CLI::App* command = app.add_subcommand(
      "effects", "List all effects of simulated rigs: equation, source, parameters, units, bounds, defaults");
  auto markdown = std::make_shared<bool>(false);
  command->add_flag("--markdown", *markdown, "Print the tables of docs/scenario.md");
  command->callback([markdown, &action] {
    action = [markdown] {
      fmt::print("{}", *markdown ? effects_markdown() : effects_text());
      return kExitCompleted;
    };
  });
}

}  // namespace hybridtest
