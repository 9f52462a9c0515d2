#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/config_error.hpp"
#include "core/exit_code.hpp"
#include "diagnosis/runs/diagnose_site.hpp"
#include "diagnosis/runs/run_records.hpp"
#include "launch/commands.hpp"
#include "runtime/executor.hpp"
#include "scenario/scenario_digest.hpp"
#include "validation/blind_batches/batch.hpp"
#include "validation/blind_batches/score/score.hpp"
#include "validation/studies/output_file.hpp"
#include "validation/studies/parallel_runs.hpp"
#include "validation/studies/study_progress.hpp"

namespace hybridtest {
namespace {

namespace fs = std::filesystem;

std::string hexadecimal_sha256(std::string_view text) {
  std::string digits;
  for (const std::uint8_t byte : sha256(text)) digits += fmt::format("{:02x}", byte);
  return digits;
}

/// `BATCH/` means `BATCH`.
fs::path without_slash(const fs::path& directory) {
  return directory.has_filename() ? directory : directory.parent_path();
}

fs::path beside(const fs::path& directory, const char* ending) {
  return fs::path{without_slash(directory).string() + ending};
}

/// On `threads` threads, with a progress line.
blind::ForEach in_parallel(unsigned threads) {
  return [threads](const std::vector<std::string>& names, const std::function<void(std::size_t)>& one) {
    StudyProgress progress{names.size(), stderr};
    run_in_parallel(names.size(), threads, [&](std::size_t i) {
      one(i);
      progress.completed(names[i]);
    });
  };
}

struct BlindOptions {
  blind::MakeSettings make;
  fs::path batch;
  std::vector<fs::path> batches;  // to be scored together
  fs::path key;
  fs::path answers;
  fs::path out;
  std::uint64_t seed = 1;
  unsigned threads = usable_threads();
};

int make(const BlindOptions& options) {
  blind::MakeSettings settings = options.make;
  settings.key = options.key.empty() ? beside(settings.directory, ".key.json") : options.key;
  blind::make_batch(settings, hexadecimal_sha256, in_parallel(options.threads));
  fmt::print("{} cases in {}, the key in {}\n", settings.cases, settings.directory.string(), settings.key.string());
  return kExitCompleted;
}

/// What `hybridtest diagnose` does with the same files.
void diagnose_case(const blind::CaseFiles& files, const fs::path& out, std::uint64_t seed) {
  const SiteModelFile model = read_site_model(files.site, {});
  std::vector<Recording> recordings;
  for (const fs::path& file : files.fit)
    recordings.push_back(read_recording(file, RecordingRole::fit, {}, time_base_of(model)));
  recordings.push_back(read_recording(files.held_out, RecordingRole::held_out, {}, time_base_of(model)));
  DiagnoseSettings settings;
  settings.seed = seed;
  settings.threads = 1;  // the cases themselves run side by side
  write_diagnosis(diagnose_site(model, recordings, settings), model, out);
}

/// How long the cases took; any thread may add to it.
class CaseTimes {
 public:
  void add(const std::string& name, Duration duration) {
    const std::scoped_lock lock{mutex_};
    times_.emplace_back(to_seconds(duration), name);
  }

  [[nodiscard]] std::string text() {
    if (times_.empty()) return "every case had been answered before";
    std::ranges::sort(times_);
    const auto& [longest_s, name] = times_.back();
    return fmt::format("{} cases diagnosed in {:.0f} s; a case took {:.1f} s in the median, {} {:.1f} s at most",
                       times_.size(), to_seconds(clock_.now().time_since_epoch()), times_[times_.size() / 2].first,
                       name, longest_s);
  }

  [[nodiscard]] Instant now() { return clock_.now(); }

 private:
  ProcessClock clock_;
  std::mutex mutex_;
  std::vector<std::pair<double, std::string>> times_;
};

int run(const BlindOptions& options) {
  const fs::path answers = options.answers.empty() ? beside(options.batch, ".answers") : options.answers;
  CaseTimes times;
  const blind::RunOutcome outcome = blind::run_batch(
      options.batch, answers,
      [&](const blind::CaseFiles& files, const fs::path& out) {
        const Instant begin = times.now();
        diagnose_case(files, out, options.seed);
        times.add(files.name, times.now() - begin);
      },
      hexadecimal_sha256, in_parallel(options.threads));
  for (const std::string& failure : outcome.failures) fmt::print(stderr, "not answered: {}\n", failure);
  fmt::print("{}\n{} answers in {}, sealed\n", times.text(), outcome.answered, answers.string());
  return outcome.failures.empty() ? kExitCompleted : kExitDataInvalid;
}

int score(const BlindOptions& options) {
  if (options.batches.size() > 1 && (!options.answers.empty() || !options.key.empty())) {
    throw ConfigError{
        "--answers and --key: several batches are given; expected them for one batch only. Give several batches "
        "their <batch>.answers and <batch>.key.json"};
  }
  std::vector<blind::AnsweredBatch> batches;
  for (const fs::path& given : options.batches) {
    const fs::path batch = without_slash(given);
    batches.push_back({batch, options.answers.empty() ? beside(batch, ".answers") : options.answers,
                       options.key.empty() ? beside(batch, ".key.json") : options.key});
  }
  const blind::BatchScore scored = blind::score_batches(batches, hexadecimal_sha256);
  const char* name = batches.size() > 1 ? "pooled_score.json" : "score.json";
  const fs::path out = options.out.empty() ? batches.front().answers / name : options.out;
  fmt::print("{}", scored.text);
  write_output_file(out, scored.json);
  fmt::print("\nWritten to {}\n", out.string());
  return kExitCompleted;
}

CLI::App* add(CLI::App& commands, const char* name, const char* what, const std::shared_ptr<BlindOptions>& options,
              int (*act)(const BlindOptions&), CommandAction& action) {
  CLI::App* command = commands.add_subcommand(name, what);
  command->callback([options, act, &action] {
    action = [options, act] {
      try {
        return act(*options);
      } catch (const ConfigError&) {
        throw;
      } catch (const std::runtime_error& error) {  // a batch, key or answer that changed or cannot be read
        fmt::print(stderr, "{}\n", error.what());
        return kExitDataInvalid;
      }
    };
  });
  return command;
}

void add_threads(CLI::App& command, const std::shared_ptr<BlindOptions>& options) {
  command.add_option("--threads", options->threads, "Number of cases at the same time; the files do not depend on it")
      ->check(CLI::Range(1U, 1024U))
      ->capture_default_str();
}

}  // namespace

void add_blind_command(CLI::App& app, CommandAction& action) {
  CLI::App* commands = app.add_subcommand(
      "blind", "Measure how often the diagnosis is right, on recordings whose effect is withheld from it");
  commands->require_subcommand(1);
  const auto options = std::make_shared<BlindOptions>();

  CLI::App* making =
      add(*commands, "make", "Make a batch: sites, recordings with hidden effects, and a key with the answers", options,
          make, action);
  making->add_option("--cases", options->make.cases, "Number of cases")->required()->check(CLI::Range(1, 9999));
  making->add_option("--seed", options->make.seed, "Seed of the batch; the same seed gives the same files")->required();
  making->add_option("--out", options->make.directory, "Directory to create for the batch")->required();
  making->add_option("--key", options->key, "File to write the key to")->default_str("<out>.key.json");
  add_threads(*making, options);

  CLI::App* running =
      add(*commands, "run", "Diagnose every case that has no answer yet, without the key", options, run, action);
  running->add_option("BATCH", options->batch, "Directory of the batch")->required()->check(CLI::ExistingDirectory);
  running->add_option("--out", options->answers, "Directory for the answers")->default_str("<batch>.answers");
  running->add_option("--seed", options->seed, "Seed of the diagnosis")->capture_default_str();
  add_threads(*running, options);

  CLI::App* scoring = add(*commands, "score", "Open the key and score the answers, of several batches together",
                          options, score, action);
  scoring->add_option("BATCH", options->batches, "Directories of the batches")
      ->required()
      ->check(CLI::ExistingDirectory);
  scoring->add_option("--answers", options->answers, "Directory with <case>/diagnosis.json")
      ->default_str("<batch>.answers")
      ->check(CLI::ExistingDirectory);
  scoring->add_option("--key", options->key, "File with the key")->default_str("<batch>.key.json");
  scoring->add_option("--out", options->out, "File to write the score to")
      ->default_str("score.json in the directory of the answers; pooled_score.json in the first of several");
}

}  // namespace hybridtest
