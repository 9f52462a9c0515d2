#include <fmt/format.h>

#include <fstream>

#include "core/config_error.hpp"
#include "core/exit_code.hpp"
#include "launch/commands.hpp"
#include "report/run_index/run_index.hpp"

namespace hybridtest {
namespace {

struct RunsOptions {
  std::filesystem::path folder = "runs";
  std::filesystem::path page;
  bool writes_page = false;
  bool json = false;
  RunFilter filter;
};

void write_page(const RunsOptions& options, const std::vector<RunEntry>& runs) {
  const std::filesystem::path file = options.page.empty() ? options.folder / "index.html" : options.page;
  std::ofstream stream{file};
  // Both absolute: a link from one folder to another needs their common begin.
  const std::filesystem::path folder = std::filesystem::absolute(file).lexically_normal().parent_path();
  std::vector<RunEntry> absolute_runs = runs;
  for (RunEntry& run : absolute_runs) {
    const auto make_absolute = [](std::filesystem::path& path) {
      path = std::filesystem::absolute(path).lexically_normal();
    };
    make_absolute(run.directory);
    if (run.report) make_absolute(*run.report);
    for (auto& page : run.diagnosis_pages) make_absolute(page);
  }
  stream << runs_page(absolute_runs, folder);
  stream.close();
  if (!stream) throw ConfigError{"--page " + file.string() + ": cannot be written; choose another place"};
  fmt::print(stderr, "page: {}\n", file.string());
}

int list_runs(const RunsOptions& options) {
  if (!std::filesystem::is_directory(options.folder)) {
    throw ConfigError{options.folder.string() + ": no such folder; expected one with run directories, such as `runs`"};
  }
  const std::vector<RunEntry> runs = find_runs(options.folder, options.filter);
  if (options.json) {
    fmt::print("{}", runs_json(runs));
  } else if (runs.empty()) {
    fmt::print("no runs below {}{}\n", options.folder.string(),
               options.filter.test_name.empty() && !options.filter.only_failed ? "" : " that were asked for");
  } else {
    fmt::print("{}", runs_text(runs));
  }
  if (options.writes_page) write_page(options, runs);
  return kExitCompleted;
}

}  // namespace

void add_runs_command(CLI::App& app, CommandAction& action) {
  auto options = std::make_shared<RunsOptions>();
  CLI::App* command = app.add_subcommand(
      "runs", "List the runs below a folder, newest first: when, scenario, verdict, peak, data, diagnosis");
  command->add_option("DIR", options->folder, "Folder with run directories, at any depth")->capture_default_str();
  command->add_option("--scenario", options->filter.test_name, "Only runs of the scenario with this name");
  command->add_flag("--failed", options->filter.only_failed, "Only runs that did not complete with valid data");
  command->add_flag("--json", options->json, "Print JSON");
  CLI::Option* page =
      command
          ->add_option("--page", options->page,
                       "Also write a page with links to the reports and diagnoses; default DIR/index.html")
          ->expected(0, 1);
  command->callback([options, page, &action] {
    options->writes_page = page->count() > 0;
    action = [options] { return list_runs(*options); };
  });
}

}  // namespace hybridtest
