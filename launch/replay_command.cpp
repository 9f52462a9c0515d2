#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <optional>

#include "core/config_error.hpp"
#include "core/exit_code.hpp"
#include "diagnosis/identification/continuation.hpp"
#include "diagnosis/replay.hpp"
#include "diagnosis/runs/diagnose_site.hpp"
#include "diagnosis/runs/run_records.hpp"
#include "launch/commands.hpp"
#include "scenario/site_model_file.hpp"

namespace hybridtest {
namespace {

struct ReplayOptions {
  std::filesystem::path model;
  std::string site;
  std::filesystem::path recording;
  std::filesystem::path after;
  std::filesystem::path out;
};

void print_gaps(const std::vector<std::vector<ReplayedChannel>>& replays) {
  fmt::print("  {:<18} {:<28} {:<28} {:>8} {:>8} {:>7}\n", "interface", "from", "to", "NRMSE", "floor", "share");
  for (std::size_t dof = 0; dof < replays.size(); ++dof) {
    if (replays.size() > 1) fmt::print("  degree of freedom {}\n", dof + 1);
    for (const ReplayedChannel& channel : replays[dof]) {
      fmt::print("  {:<18} {:<28} {:<28} {:>8.4f} {:>8.4f} {:>5.1f} %\n", channel.interface, column_name(channel.from),
                 column_name(channel.to), channel.nrmse, channel.floor_nrmse, 100.0 * channel.share);
    }
  }
}

/// The recording before the one to replay, if it was given.
std::optional<Recording> recording_before(const ReplayOptions& options, const SiteModelFile& model,
                                          const Recording& recording) {
  if (options.after.empty()) return {};
  Recording before = read_recording(options.after, RecordingRole::held_out, options.site, time_base_of(model));
  require_match(model, {&before, 1});
  for (std::size_t dof = 0; dof < model.dofs.size(); ++dof) {
    if (continues(before, recording, dof)) continue;
    throw ConfigError{
        "--after " + before.file + ": " + recording.file +
        " does not continue it; expected a first time stamp or step, and a displacement, that go on where "
        "it ends"};
  }
  return before;
}

int replay_recording(const ReplayOptions& options) {
  const SiteModelFile model = read_model_for({&options.recording, 1}, options.model, options.site);
  const Recording recording =
      read_recording(options.recording, RecordingRole::held_out, options.site, time_base_of(model));
  require_match(model, {&recording, 1});
  const std::optional<Recording> before = recording_before(options, model, recording);
  std::vector<std::vector<ReplayedChannel>> replays;
  std::size_t channels = 0;
  for (std::size_t dof = 0; dof < model.dofs.size(); ++dof) {
    replays.push_back(replay(model.dofs[dof], recording, dof, before ? &*before : nullptr));
    channels += replays.back().size();
  }
  if (channels == 0) {
    fmt::print(
        stderr,
        "{}: no channels to compare. Expected the columns command_displacement_m and measured_displacement_m; or "
        "measured_displacement_m and measured_force_n, with a specimen in the model\n",
        recording.file);
    return kExitDataInvalid;
  }
  print_gaps(replays);
  std::ofstream file{options.out, std::ios::binary};
  file << replay_csv(recording, replays);
  if (!file.flush())
    throw ConfigError{"--out " + options.out.string() +
                      ": this file cannot be written; check the folder and its permissions"};
  fmt::print("  written to {}\n", options.out.string());
  return kExitCompleted;
}

}  // namespace

void add_replay_command(CLI::App& app, CommandAction& action) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App* command = app.add_subcommand(
      "replay",
      "Compute each stage of a site model with the recorded input of that stage, and print the gap of each interface.\n"
      "Exit code 4: the recording has no channels to compare.");
  command->add_option("--model", options->model, "Model of the site: a site file, or a scenario")->required();
  command->add_option("--site", options->site, "Id of the site; required if the scenario or run has several sites");
  command->add_option("--recording", options->recording, "CSV file or run directory")->required();
  command->add_option("--after", options->after,
                      "CSV file that the recording continues: the specimen begins with its history");
  command->add_option("--out", options->out, "CSV file to write: recorded and predicted channels")->required();
  command->callback([options, &action] { action = [options] { return replay_recording(*options); }; });
}

}  // namespace hybridtest
