#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "core/config_error.hpp"
#include "core/exit_code.hpp"
#include "launch/commands.hpp"
#include "runtime/version.hpp"

int main(int argc, char** argv) {
  CLI::App app{
      "Distributed hybrid tests: structures stepped through an earthquake, part of them computed, part of\n"
      "them a specimen in a laboratory or its simulation.",
      "hybridtest"};
  app.set_version_flag("--version", "hybridtest " + std::string{hybridtest::software_version()});
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 completed, 2 configuration or participant missing, 3 ended early (interlock, participant\n"
      "lost, stopped by hand), 4 data invalid, 70 internal error.");
  hybridtest::CommandAction action;
  hybridtest::add_check_command(app, action);
  hybridtest::add_run_command(app, action);
  hybridtest::add_simulate_command(app, action);
  hybridtest::add_control_commands(app, action);
  hybridtest::add_effects_command(app, action);
  hybridtest::add_export_command(app, action);
  hybridtest::add_summary_command(app, action);
  hybridtest::add_diagnose_command(app, action);
  hybridtest::add_replay_command(app, action);
  hybridtest::add_study_command(app, action);
  hybridtest::add_blind_command(app, action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? hybridtest::kExitCompleted : hybridtest::kExitConfiguration;
  }
  try {
    return action();
  } catch (const hybridtest::ConfigError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return hybridtest::kExitConfiguration;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "hybridtest: %s\n", error.what());
    return hybridtest::kExitInternal;
  }
}
