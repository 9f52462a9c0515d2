#include <fmt/format.h>

#include "core/exit_code.hpp"
#include "launch/commands.hpp"
#include "launch/run_report.hpp"
#include "recording/summary/run_summary.hpp"

namespace hybridtest {

void add_report_command(CLI::App& app, CommandAction& action) {
  struct Options {
    std::filesystem::path run;
    std::filesystem::path out;
    std::vector<std::filesystem::path> compare;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "report",
      "Write one page about a run: verdict, histories, loops, tracking, margins, timing; opens without network");
  command->add_option("RUN", options->run, "Run directory")->required()->check(CLI::ExistingDirectory);
  command->add_option("--out", options->out, "File to write")->default_str("RUN/report.html");
  command
      ->add_option("--compare", options->compare,
                   "Draw another recording over it and list the differences: a run directory, a CSV file of\n"
                   "`hybridtest reference`, or the folder of a diagnosis; repeatable")
      ->check(CLI::ExistingPath);
  command->callback([options, &action] {
    action = [options] {
      const std::filesystem::path file = options->out.empty() ? report_file(options->run) : options->out;
      write_run_report(options->run, options->compare, summarise(options->run), file);
      fmt::print("{}\n", file.string());
      return kExitCompleted;
    };
  });
}

}  // namespace hybridtest
