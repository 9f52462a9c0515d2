#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>

#include "core/exit_code.hpp"
#include "diagnosis/blind/make_batch.hpp"
#include "launch/commands.hpp"
#include "launch/scenario_digest.hpp"
#include "launch/studies/parallel_runs.hpp"
#include "launch/studies/study_progress.hpp"

namespace hybridtest {
namespace {

namespace fs = std::filesystem;

std::string hexadecimal_sha256(std::string_view text) {
  std::string digits;
  for (const std::uint8_t byte : sha256(text)) digits += fmt::format("{:02x}", byte);
  return digits;
}

struct MakeOptions {
  blind::MakeSettings settings;
  unsigned threads = usable_threads();
};

int make(MakeOptions options) {
  fs::path& directory = options.settings.directory;
  if (!directory.has_filename()) directory = directory.parent_path();
  if (options.settings.key.empty()) options.settings.key = directory.string() + ".key.json";
  {
    StudyProgress progress{options.settings.cases, stderr};
    make_batch(options.settings, hexadecimal_sha256, [&](std::size_t count, const auto& one) {
      run_in_parallel(count, options.threads, [&](std::size_t i) {
        one(i);
        progress.completed(blind::case_name(i));
      });
    });
  }
  fmt::print("{} cases in {}, the key in {}\n", options.settings.cases, directory.string(),
             options.settings.key.string());
  return kExitCompleted;
}

void add_make(CLI::App& commands, CommandAction& action) {
  const auto options = std::make_shared<MakeOptions>();
  CLI::App* command = commands.add_subcommand("make", "Draw sites, recordings and what is wrong with them");
  command->add_option("--cases", options->settings.cases, "How many")->required()->check(CLI::Range(1, 9999));
  command->add_option("--seed", options->settings.seed, "The same seed gives the same files")->required();
  command->add_option("--out", options->settings.directory, "New directory of the batch")->required();
  command->add_option("--key", options->settings.key, "File for the truth")->default_str("<out>.key.json");
  command->add_option("--threads", options->threads, "Cases at a time; the files do not depend on it")
      ->check(CLI::Range(1U, 1024U))
      ->capture_default_str();
  command->callback([options, &action] { action = [options] { return make(*options); }; });
}

}  // namespace

void add_blind_command(CLI::App& app, CommandAction& action) {
  CLI::App* commands =
      app.add_subcommand("blind", "Check the diagnosis on recordings whose effect is withheld from it");
  commands->require_subcommand(1);
  add_make(*commands, action);
}

}  // namespace hybridtest
