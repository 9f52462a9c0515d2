#pragma once

#include <CLI/CLI.hpp>
#include <functional>

/// The subcommands of `hybridtest`, one source each. Each function adds its subcommand to the command line
/// and sets the action to run when it is selected. The action returns the exit code.
namespace hybridtest {

using CommandAction = std::function<int()>;

void add_new_command(CLI::App& app, CommandAction& action);
void add_check_command(CLI::App& app, CommandAction& action);
void add_import_command(CLI::App& app, CommandAction& action);
void add_participants_command(CLI::App& app, CommandAction& action);
void add_run_command(CLI::App& app, CommandAction& action);
void add_simulate_command(CLI::App& app, CommandAction& action);
void add_watch_command(CLI::App& app, CommandAction& action);
void add_control_commands(CLI::App& app, CommandAction& action);
void add_effects_command(CLI::App& app, CommandAction& action);
void add_export_command(CLI::App& app, CommandAction& action);
void add_summary_command(CLI::App& app, CommandAction& action);
void add_diagnose_command(CLI::App& app, CommandAction& action);
void add_reference_command(CLI::App& app, CommandAction& action);
void add_report_command(CLI::App& app, CommandAction& action);
void add_runs_command(CLI::App& app, CommandAction& action);
void add_replay_command(CLI::App& app, CommandAction& action);
void add_study_command(CLI::App& app, CommandAction& action);
void add_doctor_command(CLI::App& app, CommandAction& action);
void add_discovery_server_command(CLI::App& app, CommandAction& action);
void add_blind_command(CLI::App& app, CommandAction& action);
void add_sweep_command(CLI::App& app, CommandAction& action);

}  // namespace hybridtest
