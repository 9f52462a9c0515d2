#include "runtime/participant_process.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <exception>
#include <iostream>
#include <iterator>
#include <memory>
#include <optional>

#include "core/assert.hpp"
#include "core/config_error.hpp"
#include "recording/recorder.hpp"
#include "recording/recorder_thread.hpp"
#include "recording/summary/run_summary.hpp"
#include "runtime/crash_report.hpp"
#include "runtime/deferring_transport.hpp"
#include "runtime/event_log.hpp"
#include "runtime/executor.hpp"
#include "runtime/incarnation.hpp"
#include "runtime/lead_process.hpp"
#include "runtime/live/live_signals.hpp"
#include "runtime/loop_thread.hpp"
#include "runtime/network_options.hpp"
#include "runtime/node_thread.hpp"
#include "runtime/participant.hpp"
#include "runtime/progress.hpp"
#include "runtime/recording_watch.hpp"
#include "runtime/refused_packets.hpp"
#include "runtime/resume.hpp"
#include "runtime/run_directory.hpp"
#include "runtime/version.hpp"
#include "transport/fast_dds/credentials.hpp"
#include "transport/fast_dds/fast_dds_transport.hpp"

namespace hybridtest {
namespace {

/// Capacity of the tables at control rate while the disk is busy: two minutes at 1 kHz.
constexpr std::size_t kRingRows = 1U << 17U;

/// For the others to hear the last word of this participant, with the rig at rest: longer than a discovery takes.
constexpr Duration kLinger = std::chrono::seconds{1};

/// In real time: how often what waits is sent and written.
constexpr Duration kDeskPeriod = std::chrono::milliseconds{2};

/// Threads of the network, and the node of a site beside its control loop, come after the thread with deadlines.
constexpr int kNetworkBelow = 5;

/// What a process that was started by hand shows on standard error: what it waits for, then how far the test is.
class ParticipantProgress {
 public:
  ParticipantProgress(const Scenario& scenario, const ParticipantProcessOptions& options, Role role)
      : progress_{scenario, stderr, heard_by(options, role)} {
    const char* what = role == Role::coordinator ? "the substructures" : "the coordinator";
    std::fprintf(stderr, "%s: test %s, DDS domain %u; waiting up to %.0f s for %s; Ctrl-C ends it\n",
                 options.id.c_str(), scenario.name.c_str(), static_cast<unsigned>(options.network.domain),
                 to_seconds(scenario.timeouts.discovery), what);
  }

  void show(const Presence& presence, Instant now) {
    // Called after every message: looks at the others far less often.
    if (now < next_look_) return;
    next_look_ = now + kLook;
    progress_.learn(presence.own_status());
    for (const Peer& peer : presence.peers()) progress_.learn(peer.status);
    progress_.set_completed(presence.own_status().last_step, now);
    progress_.show(now);
  }
  void print(const Event& event) { progress_.print(event); }
  void clear_line() { progress_.clear_line(); }

 private:
  static constexpr Duration kLook = std::chrono::milliseconds{50};

  /// All by the coordinator.
  static std::vector<std::string> heard_by(const ParticipantProcessOptions& options, Role role) {
    if (role == Role::coordinator) return {};
    return {std::string{kCoordinatorId}, options.id};
  }

  Progress progress_;
  Instant next_look_{};
};

/// What the thread of the node requests in real time. That of a site comes after its control loop.
RealTimeRequest real_time_of(const Scenario& scenario, const std::string& id, Role role) {
  if (role == Role::coordinator) return scenario.real_time.coordinator;
  RealTimeRequest request = scenario.find(id)->real_time;
  if (role == Role::experimental_site) request.priority = std::max(1, request.priority - kNetworkBelow);
  return request;
}

/// All parts of a process except its node.
class ProcessSurroundings {
 public:
  ProcessSurroundings(const Scenario& scenario, const ParticipantProcessOptions& options, Role role,
                      const std::vector<TableLayout>& tables, const ProcessClock& clock)
      : run_directory_{options.run_directory},
        is_restored_{options.resumes},
        incarnation_{draw_incarnation()},
        transport_{make_transport(scenario, options, role)},
        deferring_{scenario.time.mode == CouplingMode::real_time ? std::make_unique<DeferringTransport>(*transport_)
                                                                 : nullptr},
        network_events_{transport().event_outbox()},
        live_{options.id, incarnation_, transport_->signal_outbox()},
        recorder_{run_file(options.run_directory, options.id),
                  run_file_header(scenario, options.id, role, incarnation_, clock.zero_unix_s()), recorded(tables)},
        event_log_{*network_events_, recorder_.events(), options.run_directory, !options.shows_progress} {
    publish(scenario, options, role, tables);
    recorder_.set_observer(&live_);
    if (options.shows_progress) progress_.emplace(scenario, options, role);
  }

  [[nodiscard]] ParticipantSurroundings surroundings() {
    return {transport(),  event_log_,     [this](std::string_view table) -> RowSink& { return recorder_.sink(table); },
            incarnation_, run_directory_, is_restored_};
  }
  [[nodiscard]] Transport& transport() {
    if (deferring_) return *deferring_;
    return *transport_;
  }
  /// In real time: what the node left to another thread.
  void send_waiting() {
    if (deferring_) deferring_->send_waiting();
  }
  [[nodiscard]] Recorder& recorder() { return recorder_; }

  /// Writes the events that wait to `events.log` and to the terminal.
  void write_events() {
    event_log_.write([this](const Event& event) {
      if (progress_) progress_->print(event);
    });
  }
  void show_progress(const Presence& presence, Instant now) {
    if (progress_) progress_->show(presence, now);
  }
  /// At the end, before the recording is closed.
  void record_refused_packets() {
    counters_at_end_ = transport().counters();
    hybridtest::record_refused_packets(counters_at_end_, recorder_.sink(kRefusedPacketsTable));
  }
  /// Those that were recorded; nothing where there were none.
  void tell_refused_packets() {
    if (const std::string text = refused_packets_text(counters_at_end_); !text.empty()) print(text);
  }
  /// A line of this process alone on standard error.
  void print(const std::string& text) {
    if (progress_) progress_->clear_line();
    std::fprintf(stderr, "%s\n", text.c_str());
  }

 private:
  /// What live views get to see.
  void publish(const Scenario& scenario, const ParticipantProcessOptions& options, Role role,
               const std::vector<TableLayout>& tables) {
    for (std::size_t i = 0; i < tables.size(); ++i) {
      const TableLayout& table = tables[i];
      if (role == Role::coordinator) {
        if (table.name == "steps") {
          live_.add("structure", i, table, structure_signals(scenario, table));
          live_.add("pace", i, table, pace_signals(table));
        }
        if (table.name == "exchanges") {
          std::vector<std::string> ids;
          for (const SubstructureScenario& one : scenario.substructures) ids.push_back(one.id);
          live_.add_exchanges(i, table, std::move(ids), scenario.time.step_s);
        }
        continue;
      }
      const SubstructureScenario& substructure = *scenario.find(options.id);
      if (role == Role::numerical_substructure && table.name == "steps") {
        live_.add("steps", i, table, numerical_signals(substructure, table));
      }
      if (role == Role::experimental_site && table.name == "control") {
        live_.add("control", i, table, site_signals(substructure, table));
        live_.add("interlocks", i, table, interlock_signals(substructure, table));
      }
    }
  }

  /// In real time the threads of the network have to run when a message comes, too.
  static std::unique_ptr<Transport> make_transport(const Scenario& scenario, const ParticipantProcessOptions& options,
                                                   Role role) {
    const bool is_real_time = scenario.time.mode == CouplingMode::real_time;
    fast_dds::FastDdsSettings network = options.network;
    network.best_effort_coupling =
        is_real_time || std::ranges::all_of(scenario.substructures, [](const SubstructureScenario& substructure) {
          return substructure.interface_names.size() <= fast_dds::FastDdsSettings::kDofsInOnePacket;
        });
    std::optional<InheritedRealTime> inherited;
    if (is_real_time) inherited.emplace(real_time_of(scenario, options.id, role).priority);
    return fast_dds::make_fast_dds_transport(network, scenario.name);
  }

  static std::vector<RecordedTable> recorded(const std::vector<TableLayout>& tables) {
    std::vector<RecordedTable> result;
    for (const TableLayout& table : tables) result.push_back({table, kRingRows});
    result.push_back({refused_packets_table(), 1});
    return result;
  }

  std::filesystem::path run_directory_;
  bool is_restored_;
  Incarnation incarnation_;
  std::unique_ptr<Transport> transport_;
  std::unique_ptr<DeferringTransport> deferring_;  // in real time
  std::unique_ptr<Outbox<Event>> network_events_;
  LiveSignals live_;  // used by the recorder until it is closed
  Recorder recorder_;
  EventLog event_log_;
  TransportCounters counters_at_end_;
  std::optional<ParticipantProgress> progress_;  // none is shown for a child of `hybridtest run`
};

/// Runs after each advance() of the node: passes on stop requests, writes events, checks the recording.
class Housekeeping {
 public:
  Housekeeping(Participant& participant, ProcessSurroundings& process, bool may_wait)
      : participant_{participant}, process_{process}, may_wait_{may_wait} {}

  void operator()(Instant now) {
    if (stop_was_requested() && !stop_passed_on_) {
      stop_passed_on_ = true;
      process_.print(participant_.presence().identity().id.text() + ": received " + stop_signal() +
                     ": stopping safely");
      participant_.request_stop(StopReason::interrupted);
    }
    watch_recording(now);
    process_.write_events();
    process_.show_progress(participant_.presence(), now);
    // Lockstep has no deadlines: it waits for the disk so that no record is lost.
    if (may_wait_) wait_while([&] { return process_.recorder().should_drain() && !process_.recorder().failed(); });
  }

 private:
  void watch_recording(Instant now) {
    if (watch_.look(process_.recorder(), participant_.presence(), now)) {
      process_.print("the recording failed: " + process_.recorder().error_text());
    }
  }

  Participant& participant_;
  ProcessSurroundings& process_;
  bool may_wait_;
  bool stop_passed_on_ = false;
  RecordingWatch watch_;
};

/// Runs after each advance() of a node with deadlines: what may neither wait nor write.
class DeadlineHousekeeping {
 public:
  DeadlineHousekeeping(Participant& participant, const Recorder& recorder)
      : participant_{participant}, recorder_{recorder} {}

  /// By the thread of the node.
  void operator()(Instant now) noexcept {
    if (stop_was_requested() && !std::exchange(stop_passed_on_, true)) {
      participant_.request_stop(StopReason::interrupted);
    }
    if (watch_.look(recorder_, participant_.presence(), now)) recording_failed_ = true;
  }
  /// By the other one.
  [[nodiscard]] bool take_recording_failure() noexcept { return recording_failed_.exchange(false); }

 private:
  Participant& participant_;
  const Recorder& recorder_;
  bool stop_passed_on_ = false;
  RecordingWatch watch_;
  std::atomic<bool> recording_failed_{false};
};

/// Last words and exit code of the process, after its records are closed. A completed part is valid only with all its
/// records.
int end_of(const Participant& participant, ProcessSurroundings& process) {
  process.tell_refused_packets();
  const int exit_code = exit_code_for(participant.stop_reason());
  const bool has_holes = process.recorder().failed() || process.recorder().dropped() > 0;
  return exit_code == kExitCompleted && has_holes ? kExitDataInvalid : exit_code;
}

/// Others may discover this participant only now: the tool that sent an emergency stop then hears that it obeyed, and
/// the coordinator that it refuses.
void stay_to_be_heard(StopReason reason, const ProcessClock& clock) {
  const bool is_news =
      reason == StopReason::emergency_stop || reason == StopReason::refused || reason == StopReason::resume_refused;
  if (is_news) rest_until(clock, clock.now() + kLinger);
}

/// What is left to write once the node is done, while the recording is open.
void write_the_rest(const Participant& participant, ProcessSurroundings& process, const ProcessClock& clock,
                    const std::function<void()>& at_the_end) {
  process.write_events();
  stay_to_be_heard(participant.stop_reason(), clock);
  at_the_end();
  process.record_refused_packets();
}

/// @param meanwhile    called after each advance() of the node.
/// @param at_the_end   called before the recording is closed, for its last rows.
void run_to_the_end(
    Participant& participant, ProcessSurroundings& process, const ProcessClock& clock, const Scenario& scenario,
    const std::function<void(Instant)>& meanwhile = [](Instant) {}, const std::function<void()>& at_the_end = [] {}) {
  RecorderThread recording{process.recorder()};
  Housekeeping housekeeping{participant, process, scenario.time.mode == CouplingMode::lockstep};
  run_until(
      participant.node(), process.transport().waker(), clock, [&] { return participant.is_done(); },
      [&](Instant now) {
        housekeeping(now);
        meanwhile(now);
      });
  write_the_rest(participant, process, clock, at_the_end);
}

void report_grant(Presence& presence, Instant now, const RealTimeRequest& request, const RealTimeGrant& grant) {
  const auto report = [&](const char* what, int error, double asked_for) {
    if (error == 0) {
      presence.report(now, Severity::information, EventCode::real_time_granted, what, {asked_for, 0.0});
    } else {
      presence.report(now, Severity::warning, EventCode::real_time_refused, what,
                      {static_cast<double>(error), asked_for});
    }
  };
  report("scheduling", grant.scheduling_error, request.priority);
  if (grant.affinity_error) report("affinity", *grant.affinity_error, *request.cpu);
  report("memory", grant.memory_error, 0.0);
}

/// @throws ConfigError when a request was refused and the scenario insists on it.
void require_grant(const Presence& presence, const RealTimeRequest& request, const RealTimeGrant& grant) {
  if (grant.is_complete() || request.allow_degraded) return;
  throw ConfigError{
      presence.identity().id.text() +
      ": the operating system did not grant all of `real_time`, see the lines above; raise the limits, or set "
      "real_time.allow_degraded: true to start without them"};
}

/// As run_to_the_end(), with the node on a thread of its own.
/// @throws ConfigError when the operating system does not grant what the scenario insists on.
void run_in_real_time(
    Participant& participant, ProcessSurroundings& process, const ProcessClock& clock, const RealTimeRequest& request,
    const std::function<void()>& at_the_end = [] {}) {
  RecorderThread recording{process.recorder()};
  DeadlineHousekeeping housekeeping{participant, process.recorder()};
  {
    NodeThread thread{request};
    report_grant(participant.presence(), clock.now(), request, thread.grant());
    process.write_events();
    require_grant(participant.presence(), request, thread.grant());
    thread.run(
        participant.node(), process.transport().waker(), clock, [&] { return participant.is_done(); },
        [&](Instant now) { housekeeping(now); });
    bool told_stop = false;
    while (!thread.is_over()) {
      process.send_waiting();
      process.write_events();
      if (housekeeping.take_recording_failure()) {
        process.print("the recording failed: " + process.recorder().error_text());
      }
      if (stop_was_requested() && !std::exchange(told_stop, true)) {
        process.print("received " + stop_signal() + ": stopping safely");
      }
      rest_until(clock, clock.now() + kDeskPeriod);
    }
  }
  process.send_waiting();
  write_the_rest(participant, process, clock, at_the_end);
}

/// The recording of the process whose place this one takes; nothing in a new test.
class ResumedFile {
 public:
  explicit ResumedFile(const ParticipantProcessOptions& options) {
    if (options.resumes) aside_ = std::make_unique<FileSetAside>(options.run_directory, options.id);
  }
  void keep() const noexcept { aside_->keep(); }

 private:
  std::unique_ptr<FileSetAside> aside_;
};

int run_coordinator(const Scenario& scenario, const ParticipantProcessOptions& options, const ProcessClock& clock) {
  std::vector<TableLayout> tables = CoordinatorParticipant::tables(scenario);
  std::ranges::move(test_tables(), std::back_inserter(tables));
  const ResumedFile before{options};
  ProcessSurroundings process{scenario, options, Role::coordinator, tables, clock};
  CoordinatorParticipant participant{scenario, process.surroundings()};
  if (options.resumes) {
    const RunFileReader recorded = interrupted_recording(options.run_directory);
    restore_coordinator(participant.coordinator(), scenario, recorded,
                        first_coordinator(options.run_directory, recorded), process.recorder(), clock.zero_unix_s());
    before.keep();
  }
  wake_on_stop(process.transport().waker());
  std::optional<LeadProcess> lead;
  if (scenario.opensees) lead.emplace(*scenario.opensees, options.run_directory);
  const auto watch_lead = [&](Instant now) {
    if (!lead || participant.report().reason != StopReason::none || !lead->has_left(now)) return;
    process.print(lead->end_text());
    participant.lead_has_left();
  };
  const auto finish = [&] {
    const CoordinatorReport report = participant.report();
    if (lead) {
      const bool is_completed = report.reason == StopReason::completed;
      if (const std::string told = lead->finish(is_completed, scenario.timeouts.stop); !told.empty())
        process.print(told);
    }
    write_test_tables(scenario, report, exit_code_for(report.reason),
                      [&](std::string_view table) -> RowSink& { return process.recorder().sink(table); });
  };
  if (scenario.time.mode == CouplingMode::real_time) {
    run_in_real_time(participant, process, clock, scenario.real_time.coordinator, finish);
  } else {
    run_to_the_end(participant, process, clock, scenario, watch_lead, finish);
  }
  return end_of(participant, process);
}

int run_numerical(const Scenario& scenario, const SubstructureScenario& substructure,
                  const ParticipantProcessOptions& options, const ProcessClock& clock) {
  const ResumedFile before{options};
  ProcessSurroundings process{scenario, options, substructure.role, substructure_tables(substructure), clock};
  NumericalParticipant participant{scenario, substructure, process.surroundings()};
  if (options.resumes) {
    restore_numerical(participant.numerical(), scenario, substructure, interrupted_recording(options.run_directory),
                      process.recorder());
    before.keep();
  }
  wake_on_stop(process.transport().waker());
  if (scenario.time.mode == CouplingMode::real_time) {
    run_in_real_time(participant, process, clock, real_time_of(scenario, options.id, substructure.role));
  } else {
    run_to_the_end(participant, process, clock, scenario);
  }
  if (const std::string text = participant.failure_text(); !text.empty()) process.print(text);
  return end_of(participant, process);
}

/// Runs the link on this thread and the control loop on its own thread.
void run_site_with_loop_thread(SiteParticipant& participant, ProcessSurroundings& process, const ProcessClock& clock,
                               const Scenario& scenario, const SubstructureScenario& substructure) {
  const RealTimeRequest& request = substructure.real_time;
  LoopThread loop{participant.control_loop(), clock, request,
                  from_seconds(scenario.time.step_s * scenario.time.time_scale / substructure.site.periods_per_step)};
  report_grant(participant.presence(), clock.now(), request, loop.grant());
  process.write_events();
  require_grant(participant.presence(), request, loop.grant());
  const auto finish = [&] {
    loop.stop();
    record_loop_timing(loop.timing(), request, loop.grant(), process.recorder().sink("loop_timing"),
                       process.recorder().sink("loop_start_lateness"));
  };
  if (scenario.time.mode == CouplingMode::real_time) {
    run_in_real_time(participant, process, clock, real_time_of(scenario, substructure.id, substructure.role), finish);
  } else {
    run_to_the_end(
        participant, process, clock, scenario, [](Instant) {}, finish);
  }
}

int run_site(const Scenario& scenario, const SubstructureScenario& substructure,
             const ParticipantProcessOptions& options, const ProcessClock& clock) {
  const bool has_loop_thread = scenario.time.mode != CouplingMode::lockstep;
  std::vector<TableLayout> tables = substructure_tables(substructure);
  if (has_loop_thread) std::ranges::move(loop_timing_tables(), std::back_inserter(tables));
  ProcessSurroundings process{scenario, options, substructure.role, tables, clock};
  SiteParticipant participant{scenario, substructure, process.surroundings(), !has_loop_thread};
  set_assert_action([](void* rig) noexcept { static_cast<Rig*>(rig)->stop_motion(); }, &participant.rig());
  wake_on_stop(process.transport().waker());
  if (has_loop_thread) {
    run_site_with_loop_thread(participant, process, clock, scenario, substructure);
  } else {
    run_to_the_end(participant, process, clock, scenario);
  }
  set_assert_action(nullptr, nullptr);
  return end_of(participant, process);
}

/// @throws ConfigError when the scenario has no substructure of this id and role.
void require_substructure(const Scenario& scenario, const std::string& id, Role role) {
  const SubstructureScenario* substructure = scenario.find(id);
  if (substructure == nullptr) {
    std::string known;
    for (const auto& other : scenario.substructures) known += (known.empty() ? "" : ", ") + other.id;
    throw ConfigError{"--id " + id + ": the scenario has no such substructure; expected one of " + known};
  }
  if (substructure->role != role) {
    throw ConfigError{"--id " + id + ": this substructure is served by the program " +
                      std::string{name(substructure->role)}};
  }
}

/// @throws ConfigError for a site.
void require_restorable(const std::string& id, Role role) {
  if (role != Role::experimental_site) return;
  throw ConfigError{"--resume: the site '" + id +
                    "' cannot be restarted in the middle of a test: what its specimen has gone through cannot be "
                    "restored. Start a new test"};
}

int run_role(const Scenario& scenario, const ParticipantProcessOptions& options, Role role, const ProcessClock& clock) {
  if (role == Role::coordinator) return run_coordinator(scenario, options, clock);
  const SubstructureScenario& substructure = *scenario.find(options.id);
  return role == Role::experimental_site ? run_site(scenario, substructure, options, clock)
                                         : run_numerical(scenario, substructure, options, clock);
}

}  // namespace

void require_distributable(const Scenario& scenario) {
  if (scenario.substructures.size() <= kMaxSubstructures) return;
  throw ConfigError{scenario.name + ": " + std::to_string(scenario.substructures.size()) +
                    " substructures; a test whose participants are processes has at most " +
                    std::to_string(kMaxSubstructures) + ". Use `hybridtest simulate`, which takes up to " +
                    std::to_string(kMaxSimulatedSubstructures)};
}

int run_participant_process(const ParticipantProcessOptions& options, Role role) noexcept {
  catch_stop_signals();
  const ProcessClock clock;
  try {
    const Scenario scenario = read_scenario(options.scenario_file, options.overrides);
    require_distributable(scenario);
    ParticipantProcessOptions effective = options;
    if (role == Role::coordinator) effective.id = kCoordinatorId;
    effective.network.lease = scenario.timeouts.silence_most();
    effective.network.heartbeat_deadline = scenario.timeouts.silence_most();
    effective.network.repair_period = fast_dds::FastDdsSettings::repair_period_for(scenario.substructures.size());
    if (role != Role::coordinator) {
      require_substructure(scenario, effective.id, role);
      effective.network.substructure_id = effective.id;
    }
    if (const auto& credentials = effective.network.credentials) {
      fast_dds::require_own_credentials(*credentials, scenario.name, effective.id);
    }
    // Also refuses settings that cannot be used.
    if (const std::string text = fast_dds::unfiltered_text(effective.network); !text.empty()) {
      std::fprintf(stderr, "%s: %s\n", effective.id.c_str(), text.c_str());
    }
    if (effective.run_directory.empty()) effective.run_directory = default_run_directory(scenario.name);
    if (effective.resumes) {
      require_resumable(effective.run_directory, scenario);
      require_restorable(effective.id, role);
    } else {
      require_new_run(effective.run_directory, effective.id);
      prepare_run_directory(effective.run_directory, scenario);
    }
    const int exit_code = run_role(scenario, effective, role, clock);
    if (role == Role::coordinator && options.shows_progress) {
      // The files of the others may still be open, or on other hosts.
      print_summary(summarise(effective.run_directory, {.only = std::string{kCoordinatorId}}), std::cout);
    }
    return exit_code;
  } catch (const ConfigError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return kExitConfiguration;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "could not run: %s\n", error.what());
    return kExitInternal;
  }
}

int participant_main(int argc, char** argv, Role role) {
  report_crashes();
  CLI::App app{"One participant of a hybrid test: " + std::string{name(role)}, std::string{name(role)}};
  app.set_version_flag("--version", app.get_name() + " " + std::string{software_version()});
  ParticipantProcessOptions options;
  NetworkOptions network;
  auto* scenario =
      app.add_option("--scenario", options.scenario_file, "The test's scenario file, the same for every participant");
  auto* id = app.add_option("--id", options.id, "Which substructure of the scenario this is");
  if (role != Role::coordinator) id->required();
  app.add_option("--set", options.overrides, "Override one value of the scenario, key.path=value; repeatable");
  auto* out = app.add_option("--out", options.run_directory, "Directory for the records of this participant")
                  ->default_str("runs/<name>_<time>");
  std::filesystem::path resumed;
  auto* resume = app.add_option("--resume", resumed,
                                "Take the place of a participant of this run directory that died; see docs/resume.md")
                     ->excludes(scenario)
                     ->excludes(out);
  bool is_quiet = false;
  app.add_flag("--quiet", is_quiet, "Print events only: no progress, no summary");
  network.add_to(app);
  app.footer(
      "Exit codes: 0 completed, 2 configuration or participant missing, 3 ended early, 4 data invalid, 70 "
      "internal error.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? 0 : kExitConfiguration;
  }
  if (resume->count() == 0 && scenario->count() == 0) {
    std::fprintf(stderr, "--scenario is required\nRun with --help for more information.\n");
    return kExitConfiguration;
  }
  if (resume->count() > 0) {
    options.resumes = true;
    options.scenario_file = resumed / "scenario.yaml";
    options.run_directory = resumed;
  }
  options.shows_progress = !is_quiet;
  try {
    options.network = network.settings(role == Role::coordinator ? std::string{kCoordinatorId} : options.id);
  } catch (const ConfigError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return kExitConfiguration;
  }
  return run_participant_process(options, role);
}

}  // namespace hybridtest
