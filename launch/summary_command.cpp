#include "core/exit_code.hpp"
#include "launch/commands.hpp"
#include "launch/finish_run.hpp"

namespace hybridtest {

void add_summary_command(CLI::App& app, CommandAction& action) {
  auto directory = std::make_shared<std::filesystem::path>();
  CLI::App* command = app.add_subcommand(
      "summary", "Print the summary of a run and write its summary.json, from the recordings in its directory");
  command->add_option("RUN", *directory, "Run directory")->required()->check(CLI::ExistingDirectory);
  command->callback([directory, &action] { action = [directory] { return finish_run(*directory, kExitCompleted); }; });
}

}  // namespace hybridtest
