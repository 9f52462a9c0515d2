#include <fmt/format.h>

#include "core/exit_code.hpp"
#include "launch/commands.hpp"
#include "recording/csv_export.hpp"
#include "recording/error.hpp"

namespace hybridtest {
namespace {

struct ExportOptions {
  std::filesystem::path run;
  std::filesystem::path out;
};

int export_run(const ExportOptions& options) try {
  const std::filesystem::path out = options.out.empty() ? options.run / "csv" : options.out;
  for (const std::filesystem::path& file : export_csv(options.run, out)) fmt::print("{}\n", file.string());
  return kExitCompleted;
} catch (const RecordingError& error) {
  fmt::print(stderr, "{}\n", error.what());
  return kExitConfiguration;
}

}  // namespace

void add_export_command(CLI::App& app, CommandAction& action) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command = app.add_subcommand("export", "Write the recordings of a run as CSV, one file per table");
  command->add_option("RUN", options->run, "Run directory")->required()->check(CLI::ExistingDirectory);
  auto csv = std::make_shared<bool>(false);
  command->add_flag("--csv", *csv, "Write comma-separated values; required, because it is the only format so far")
      ->required();
  command->add_option("--out", options->out, "Directory for the CSV files")->default_str("RUN/csv");
  command->callback([options, csv, &action] { action = [options] { return export_run(*options); }; });
}

}  // namespace hybridtest
