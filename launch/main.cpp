#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "core/config_error.hpp"
#include "core/exit_code.hpp"
#include "launch/commands.hpp"
#include "runtime/crash_report.hpp"
#include "runtime/version.hpp"

int main(int argc, char** argv) {
  hybridtest::report_crashes();
  CLI::App app{
      "Distributed hybrid tests: one part of a structure is computed, the rest is a specimen in a laboratory\n"
      "or a simulated specimen; both are coupled at every step of an earthquake.\n"
      "'hybridtest COMMAND --help' describes the options of a command.",
      "hybridtest"};
  app.set_version_flag("--version", "hybridtest " + std::string{hybridtest::software_version()});
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 completed; 2 configuration error, or a participant missing or refused; 3 ended early\n"
      "(interlock, lost participant, stopped by the operator); 4 data missing or invalid; 70 internal error.");
  hybridtest::CommandAction action;
  hybridtest::add_new_command(app, action);
  hybridtest::add_check_command(app, action);
  hybridtest::add_import_command(app, action);
  hybridtest::add_participants_command(app, action);
  hybridtest::add_run_command(app, action);
  hybridtest::add_simulate_command(app, action);
  hybridtest::add_doctor_command(app, action);
  hybridtest::add_discovery_server_command(app, action);
  hybridtest::add_watch_command(app, action);
  hybridtest::add_control_commands(app, action);
  hybridtest::add_effects_command(app, action);
  hybridtest::add_export_command(app, action);
  hybridtest::add_summary_command(app, action);
  hybridtest::add_report_command(app, action);
  hybridtest::add_runs_command(app, action);
  hybridtest::add_diagnose_command(app, action);
  hybridtest::add_replay_command(app, action);
  hybridtest::add_reference_command(app, action);
  hybridtest::add_study_command(app, action);
  hybridtest::add_blind_command(app, action);
  hybridtest::add_sweep_command(app, action);
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
