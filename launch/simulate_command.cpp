#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <iterator>
#include <map>
#include <tuple>
#include <utility>

#include "core/config_error.hpp"
#include "core/event_text.hpp"
#include "diagnosis/runs/diagnose_run.hpp"
#include "launch/check_lines.hpp"
#include "launch/commands.hpp"
#include "launch/diagnosis_progress.hpp"
#include "launch/finish_run.hpp"
#include "recording/error.hpp"
#include "recording/recorder.hpp"
#include "runtime/executor.hpp"
#include "runtime/incarnation.hpp"
#include "runtime/participant.hpp"
#include "runtime/progress.hpp"
#include "runtime/recording_watch.hpp"
#include "runtime/run_directory.hpp"
#include "runtime/simulation.hpp"
#include "transport/simulated/site_latencies.hpp"

namespace hybridtest {
namespace {

constexpr double kLatencyMost_us = 1e7;

struct SimulateOptions {
  std::filesystem::path scenario_file;
  std::vector<std::string> overrides;
  std::filesystem::path directory;
  bool diagnose = false;
  bool no_report = false;
  std::uint64_t seed = 0;
  double latency_us = 50.0;
  double latency_spread = 0.0;
  std::vector<std::string> site_latencies;
  double jitter_us = 0.0;
  double loss = 0.0;
  double duplication = 0.0;
  double reordering = 0.0;
  std::vector<std::string> outages;
  std::vector<std::string> kills;
  std::vector<std::string> pauses;
};

/// `id:number` or `id:number:number`, numbers in seconds of simulated time.
std::pair<std::string, std::vector<Duration>> id_and_times(const std::string& text, std::size_t times,
                                                           const Scenario& scenario, const std::string& option) {
  std::vector<std::string> parts = CLI::detail::split(text, ':');
  const auto fail = [&](const std::string& what) { throw ConfigError{option + " " + text + ": " + what}; };
  if (parts.size() != times + 1) fail("expected ID and " + std::to_string(times) + " times in s, separated by ':'");
  if (parts[0] != kCoordinatorId && scenario.find(parts[0]) == nullptr)
    fail("the scenario has no participant '" + parts[0] + "'");
  std::vector<Duration> durations;
  for (std::size_t i = 1; i < parts.size(); ++i) {
    double seconds = 0.0;
    if (!CLI::detail::lexical_cast(parts[i], seconds) || !(seconds >= 0.0) || seconds > 1e9) {
      fail("'" + parts[i] + "' is not a time; expected 0 to 1e9 s");
    }
    durations.push_back(from_seconds(seconds));
  }
  return {parts[0], durations};
}

/// `id:number`, in microseconds.
simulated::SiteLatency site_latency(const std::string& text, const Scenario& scenario) {
  const std::vector<std::string> parts = CLI::detail::split(text, ':');
  const auto fail = [&](const std::string& what) { throw ConfigError{"--site-latency " + text + ": " + what}; };
  if (parts.size() != 2) fail("expected ID:MICROSECONDS");
  if (scenario.find(parts[0]) == nullptr) fail("the scenario has no substructure '" + parts[0] + "'");
  double latency_us = 0.0;
  if (!CLI::detail::lexical_cast(parts[1], latency_us) || !(latency_us >= 0.0) || latency_us > kLatencyMost_us) {
    fail("'" + parts[1] + "' is not a latency; expected 0 to 1e7 us");
  }
  return {parts[0], from_seconds(latency_us * 1e-6)};
}

/// Drawn for all substructures, or none; and those that are given.
std::vector<simulated::SiteLatency> site_latencies(const SimulateOptions& options, const Scenario& scenario) {
  std::vector<simulated::SiteLatency> latencies;
  for (const std::string& text : options.site_latencies) latencies.push_back(site_latency(text, scenario));
  if (options.latency_spread == 0.0) return latencies;
  std::vector<std::string> sites;
  for (const SubstructureScenario& substructure : scenario.substructures) sites.push_back(substructure.id);
  const auto drawn = simulated::draw_site_latencies(options.seed, sites, from_seconds(options.latency_us * 1e-6),
                                                    options.latency_spread);
  latencies.insert(latencies.end(), drawn.begin(), drawn.end());  // of two for one site the first counts
  return latencies;
}

/// For the person at the screen: which sites are near and which are far.
void print_latencies(std::vector<simulated::SiteLatency> latencies) {
  if (latencies.empty()) return;
  std::ranges::sort(latencies, {}, &simulated::SiteLatency::latency);
  const auto told = [](const simulated::SiteLatency& one) {
    return fmt::format("{:.3g} ms ({})", to_seconds(one.latency) * 1e3, one.participant);
  };
  fmt::print(stderr, "one-way latencies of {} sites: least {}, median {}, largest {}\n", latencies.size(),
             told(latencies.front()), told(latencies[latencies.size() / 2]), told(latencies.back()));
}

SimulationSettings settings_from(const SimulateOptions& options, const Scenario& scenario) {
  SimulationSettings settings;
  settings.seed = options.seed;
  settings.network.latency = from_seconds(options.latency_us * 1e-6);
  settings.network.site_latencies = site_latencies(options, scenario);
  settings.network.jitter = from_seconds(options.jitter_us * 1e-6);
  settings.network.loss = options.loss;
  settings.network.duplication = options.duplication;
  settings.network.reordering = options.reordering;
  const auto id_and_span = [&](const std::string& text, const std::string& option) {
    auto [id, times] = id_and_times(text, 2, scenario, option);
    if (times[1] <= times[0]) {
      throw ConfigError{option + " " + text + ": the end is not after the begin; expected ID:BEGIN:END in s"};
    }
    return std::tuple{std::move(id), times[0], times[1]};
  };
  for (const std::string& text : options.outages) {
    const auto [id, begin, end] = id_and_span(text, "--outage");
    settings.network.outages.push_back({id, begin, end});
  }
  for (const std::string& text : options.pauses) {
    const auto [id, begin, end] = id_and_span(text, "--pause");
    settings.pauses.push_back({id, begin, end});
  }
  for (const std::string& text : options.kills) {
    const auto [id, times] = id_and_times(text, 1, scenario, "--kill");
    settings.kills.push_back({id, times[0]});
  }
  return settings;
}

/// Faults after the end of the test have no effect.
void warn_of_unreached(const SimulateOptions& options, const SimulationSettings& settings, Duration end) {
  const auto warn = [end](std::string_view option, const std::string& text) {
    fmt::print(
        stderr,
        "warning: {} {} had no effect: the test ended after {:.6g} s of simulated time, which is not model time\n",
        option, text, to_seconds(end));
  };
  for (std::size_t i = 0; i < settings.kills.size(); ++i) {
    if (settings.kills[i].at >= end) warn("--kill", options.kills[i]);
  }
  for (std::size_t i = 0; i < settings.pauses.size(); ++i) {
    if (settings.pauses[i].begin >= end) warn("--pause", options.pauses[i]);
  }
  for (std::size_t i = 0; i < settings.network.outages.size(); ++i) {
    if (settings.network.outages[i].begin >= end) warn("--outage", options.outages[i]);
  }
}

/// The process may open as many files as the recordings need and some more.
/// @throws ConfigError where the system does not allow it.
void allow_open_files(std::size_t recordings) {
  constexpr std::size_t kOthers = 32;  // standard streams, events.log, what libraries open
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= recordings + kOthers) return;
  const rlim_t allowed = limit.rlim_cur;
  limit.rlim_cur = std::min<rlim_t>(recordings + kOthers, limit.rlim_max);
  if (limit.rlim_cur == recordings + kOthers && ::setrlimit(RLIMIT_NOFILE, &limit) == 0) return;
  throw ConfigError{fmt::format(
      "{} participants have a recording each, and this process may open {} files; allow more with `ulimit -n {}`",
      recordings, allowed, recordings + kOthers)};
}

/// The recordings of all participants.
class SimulatedRecording {
 public:
  SimulatedRecording(const Scenario& scenario, const std::filesystem::path& directory, std::uint64_t seed) try
      : scenario_{scenario}, directory_{directory}, seed_{seed} {
    allow_open_files(scenario.substructures.size() + 1);
    make(std::string{kCoordinatorId}, Role::coordinator, CoordinatorParticipant::tables(scenario), 1);
    for (const SubstructureScenario& substructure : scenario.substructures) {
      make(substructure.id, substructure.role, substructure_tables(substructure), substructure.site.periods_per_step);
    }
  } catch (const RecordingError& error) {
    throw ConfigError{"--out " + directory.string() + ": cannot record there: " + error.what()};
  }

  [[nodiscard]] RowSink& sink(const std::string& participant, std::string_view table) {
    return parts_.at(participant).recorder->sink(table);
  }
  void keep(const Event& event) {
    Part& part = parts_.at(event.source.text());
    part.recorder->events().send(event);
    part.has_events = true;
  }
  /// Writes what waits, often enough that a full disk loses the newest rows alone, and reports failures.
  void keep_house(const std::string& participant, Presence& presence, Instant now) {
    Part& part = parts_.at(participant);
    const bool is_due = part.calls++ % calls_per_drain() == 0 || part.has_events || part.recorder->should_drain();
    if (!is_due) return;
    part.has_events = false;
    part.recorder->drain();
    if (part.watch.look(*part.recorder, presence, now)) failures_.push_back(part.recorder->error_text());
  }
  /// Closes the files, so that they can be repaired. @return why recordings failed.
  [[nodiscard]] std::vector<std::string> close(const SimulationResult& result) {
    Recorder& coordinator = *parts_.at(std::string{kCoordinatorId}).recorder;
    write_test_tables(scenario_, result.coordinator, exit_code_for(result.coordinator.reason),
                      [&](std::string_view table) -> RowSink& { return coordinator.sink(table); });
    for (auto& [id, part] : parts_) {
      const bool had_failed = part.recorder->failed();
      part.recorder->close();
      if (!had_failed && part.recorder->failed()) failures_.push_back(part.recorder->error_text());
    }
    parts_.clear();
    return failures_;
  }

 private:
  /// More rows than one step can append between two calls of keep_house().
  static constexpr std::size_t kRingRows = 1U << 16U;

  /// The same where memory for as many would be wasted: on many participants, and on tables with a row for each command
  /// or answer. Memory that is never written to costs time too: it is set to zero.
  [[nodiscard]] std::size_t ring_rows(std::string_view table, Role role, int periods_per_step) const {
    constexpr std::size_t kCommands = 1024;  // twice those between two calls: a ring is drained when it is half full
    const std::size_t substructures = scenario_.substructures.size();
    if (substructures <= kMaxSubstructures) {
      constexpr std::size_t kUntilDrained = 2 * kCommands * kCallsPerDrain;  // so that no drain comes earlier
      if (table == "steps") return kUntilDrained;
      return table == "exchanges" ? std::min(kRingRows, kUntilDrained * substructures) : kRingRows;
    }
    if (role != Role::coordinator) return kCommands * static_cast<std::size_t>(periods_per_step);
    return table == "steps" ? kCommands : kCommands * substructures;  // one row for each of them
  }
  /// A substructure tells little; the coordinator of many tells something of each.
  [[nodiscard]] std::size_t ring_events(Role role) const {
    constexpr std::size_t kUsual = 1024;
    constexpr std::size_t kOfOne = 64;
    if (scenario_.substructures.size() <= kMaxSubstructures) return kUsual;
    return role == Role::coordinator ? kOfOne * scenario_.substructures.size() : kOfOne;
  }

  /// Calls of keep_house() from one drain to the next where no event waits and no ring is half full. A drain flushes
  /// the file, and a flush writes the unfinished chunks once more.
  static constexpr int kCallsPerDrain = 8;

  /// A flush looks at everything that HDF5 has open: of many files it is rarer, so that each row costs the same.
  [[nodiscard]] int calls_per_drain() const {
    const auto substructures = static_cast<int>(scenario_.substructures.size());
    return kCallsPerDrain * std::max(1, substructures / kMaxSubstructures);
  }

  struct Part {
    std::unique_ptr<Recorder> recorder;
    int calls = 0;
    bool has_events = false;
    RecordingWatch watch;
  };

  void make(const std::string& id, Role role, std::vector<TableLayout> tables, int periods_per_step) {
    if (role == Role::coordinator) std::ranges::move(test_tables(), std::back_inserter(tables));
    std::vector<RecordedTable> recorded;
    for (const TableLayout& table : tables) {
      recorded.push_back({table, ring_rows(table.name, role, periods_per_step)});
    }
    parts_[id].recorder = std::make_unique<Recorder>(run_file(directory_, id),
                                                     run_file_header(scenario_, id, role, seed_, begin_.zero_unix_s()),
                                                     recorded, 1, ring_events(role));
  }

  const Scenario& scenario_;
  std::filesystem::path directory_;
  std::uint64_t seed_;
  ProcessClock begin_;  // of simulated time
  std::map<std::string, Part> parts_;
  std::vector<std::string> failures_;
};

void write_event(std::FILE* log, const Event& event) {
  fmt::print(log, "{:.6f} {} {}: {}\n", to_seconds(event.clock),
             event.severity == Severity::fault     ? "error"
             : event.severity == Severity::warning ? "warning"
                                                   : "info",
             event.source.view(), describe(event));
}

int simulate_scenario(SimulateOptions options) {
  const Scenario scenario = read_scenario(options.scenario_file, options.overrides);
  const SimulationSettings settings = settings_from(options, scenario);
  require_simulable(scenario);
  if (options.diagnose) require_models(scenario);
  require_stable_test(scenario, true);
  say_nominal_inputs(scenario);
  if (options.directory.empty()) options.directory = default_run_directory(scenario.name + "_simulated");
  require_new_run(options.directory, kCoordinatorId);
  prepare_run_directory(options.directory, scenario);
  fmt::print(stderr, "{}: {} steps of {} s under simulated time, seed {}, recordings in {}\n", scenario.name,
             scenario.time.last_step, scenario.time.step_s, options.seed, options.directory.string());

  print_latencies(settings.network.site_latencies);

  SimulatedRecording recording{scenario, options.directory, options.seed};
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> log{std::fopen((options.directory / "events.log").c_str(), "w"),
                                                            std::fclose};
  if (!log) throw ConfigError{"--out " + options.directory.string() + ": cannot write events.log"};
  catch_stop_signals();
  const ProcessClock clock;
  SimulationResult result;
  {
    Progress progress{scenario, stderr};
    SimulationObserver observer;
    observer.sink = [&](const std::string& participant, const TableLayout& table) -> RowSink& {
      return recording.sink(participant, table.name);
    };
    observer.event = [&](const Event& event) {
      recording.keep(event);
      write_event(log.get(), event);
      progress.print(event);
    };
    observer.housekeeping = [&](const std::string& participant, Presence& presence, Instant now) {
      recording.keep_house(participant, presence, now);
    };
    observer.progress = [&](const CoordinatorReport& report) {
      progress.set_completed(report.completed_steps - 1, clock.now());
      progress.show(clock.now());
      return stop_was_requested();
    };
    result = simulate(scenario, settings, observer);
    result.coordinator.running_time = clock.now().time_since_epoch();
  }
  for (const std::string& why : recording.close(result)) fmt::print(stderr, "the recording failed: {}\n", why);
  warn_of_unreached(options, settings, result.simulated_time);
  const int exit_code = finish_run(options.directory, exit_code_for(result.coordinator.reason), {},
                                   options.no_report ? ReportWish::without : ReportWish::with);
  if (options.diagnose) show_diagnosis(scenario, options.directory);
  return exit_code;
}

}  // namespace

void add_simulate_command(CLI::App& app, CommandAction& action) {
  auto options = std::make_shared<SimulateOptions>();
  const CLI::Range probability{0.0, 0.9};
  CLI::App* command =
      app.add_subcommand("simulate", "Run a test in one process under simulated time and a simulated network");
  command->add_option("FILE", options->scenario_file, "Scenario file (YAML)")->required();
  command
      ->add_option("--seed", options->seed,
                   "Seed of the simulated network and clocks; the same seed gives the same results")
      ->required();
  command->add_option("--out", options->directory, "Run directory to create")
      ->default_str("runs/<name>_simulated_<time>");
  command->add_flag("--diagnose", options->diagnose,
                    "After the test, diagnose every site against the `model` beside its rig; results in RUN/diagnosis");
  command->add_flag("--no-report", options->no_report, "Do not write RUN/report.html");
  command->add_option("--set", options->overrides, "Override one value of the scenario: key.path=value; repeatable");
  command->add_option("--latency-us", options->latency_us, "Latency of every message, in microseconds")
      ->check(CLI::Range(0.0, kLatencyMost_us))
      ->capture_default_str();
  command
      ->add_option("--latency-spread", options->latency_spread,
                   "Every substructure gets a latency of its own, log-normal by the seed: --latency-us is the median, "
                   "this the standard deviation of the natural logarithm; 0.6 is like the internet")
      ->check(CLI::Range(0.0, 3.0))
      ->capture_default_str();
  command->add_option("--site-latency", options->site_latencies,
                      "ID:MICROSECONDS: latency of the messages from and to this substructure; repeatable");
  command
      ->add_option("--jitter-us", options->jitter_us,
                   "Largest additional latency, in microseconds; uniformly distributed from 0")
      ->check(CLI::Range(0.0, 1e7))
      ->capture_default_str();
  command->add_option("--loss", options->loss, "Probability that a message is lost")
      ->check(probability)
      ->capture_default_str();
  command->add_option("--duplication", options->duplication, "Probability that a message arrives twice")
      ->check(probability)
      ->capture_default_str();
  command->add_option("--reordering", options->reordering, "Probability that later messages overtake a message")
      ->check(probability)
      ->capture_default_str();
  command->add_option("--outage", options->outages,
                      "ID:BEGIN:END: no message from or to this participant arrives between these two times, in s of "
                      "simulated time; repeatable");
  command->add_option("--pause", options->pauses,
                      "ID:BEGIN:END: the process of this participant does nothing between these two times, as if its "
                      "machine were busy, in s of simulated time; repeatable");
  command->add_option("--kill", options->kills,
                      "ID:AT: this participant is killed at this time, in s of simulated time; repeatable");
  command->footer(
      "Simulated time starts with the processes and is not model time. With mode lockstep a step takes as long as\n"
      "its messages travel; with mode paced it takes step_s x time_scale,\n"
      "and in real time step_s.");
  command->callback([options, &action] { action = [options] { return simulate_scenario(*options); }; });
}

}  // namespace hybridtest
