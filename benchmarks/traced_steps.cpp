#include "benchmarks/traced_steps.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <fstream>
#include <memory>
#include <stdexcept>

#include "benchmarks/peer_processes.hpp"
#include "recording/recorder_thread.hpp"
#include "runtime/executor.hpp"
#include "runtime/incarnation.hpp"
#include "runtime/participant.hpp"
#include "runtime/run_directory.hpp"
#include "scenario/scenario.hpp"
#include "transport/fast_dds/fast_dds_transport.hpp"

namespace hybridtest::benchmarks {
namespace {

using Clock = std::chrono::steady_clock;

std::int64_t clock_ns() noexcept { return Clock::now().time_since_epoch().count(); }

/// Time stamps of one step and one substructure [ns], of the steady clock, which the processes of a host share.
struct Stamps {
  std::int64_t command_begun, command_sent;                        // coordinator
  std::int64_t peer_woken, peer_advances, answer_begun, answered;  // substructure
  std::int64_t woken, advances, taken;                             // coordinator
};

/// A table of stamps in a file that all participants have in their memory.
class SharedStamps {
 public:
  SharedStamps(const std::filesystem::path& file, int steps, int substructures)
      : substructures_{static_cast<std::size_t>(substructures)},
        count_{static_cast<std::size_t>(steps) * substructures_} {
    const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    const bool has_room = descriptor >= 0 && ::ftruncate(descriptor, static_cast<off_t>(bytes())) == 0;
    void* memory = has_room ? ::mmap(nullptr, bytes(), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, descriptor, 0)
                            : MAP_FAILED;
    if (descriptor >= 0) ::close(descriptor);
    if (memory == MAP_FAILED) throw std::runtime_error{"no room for the trace"};
    stamps_ = static_cast<Stamps*>(memory);
  }
  ~SharedStamps() { ::munmap(stamps_, bytes()); }
  SharedStamps(const SharedStamps&) = delete;
  SharedStamps& operator=(const SharedStamps&) = delete;

  /// A place to write to for a step beyond the end.
  [[nodiscard]] Stamps& at(Step step, std::size_t substructure) noexcept {
    const auto i = static_cast<std::size_t>(step) * substructures_ + substructure;
    return step >= 0 && i < count_ ? stamps_[i] : beyond_;
  }

 private:
  [[nodiscard]] std::size_t bytes() const noexcept { return count_ * sizeof(Stamps); }

  std::size_t substructures_;
  std::size_t count_;
  Stamps* stamps_ = nullptr;
  Stamps beyond_{};
};

/// Stamps what passes between a node and its transport.
class TracedTransport final : public Transport {
 public:
  TracedTransport(Transport& inner, SharedStamps& stamps) : inner_{inner}, stamps_{stamps} {}

  void woken() noexcept { woken_ns_ = clock_ns(); }
  void advances() noexcept { advances_ns_ = clock_ns(); }

  Waker& waker() noexcept override { return inner_.waker(); }
  std::unique_ptr<Outbox<TestAnnouncement>> announcement_outbox() override { return inner_.announcement_outbox(); }
  std::unique_ptr<Inbox<TestAnnouncement>> announcement_inbox() override { return inner_.announcement_inbox(); }
  std::unique_ptr<Outbox<ParticipantStatus>> status_outbox() override { return inner_.status_outbox(); }
  std::unique_ptr<Inbox<ParticipantStatus>> status_inbox() override { return inner_.status_inbox(); }
  std::unique_ptr<Outbox<TestControl>> control_outbox() override { return inner_.control_outbox(); }
  std::unique_ptr<Inbox<TestControl>> control_inbox() override { return inner_.control_inbox(); }
  std::unique_ptr<Outbox<Event>> event_outbox() override { return inner_.event_outbox(); }
  std::unique_ptr<Inbox<Event>> event_inbox() override { return inner_.event_inbox(); }
  std::unique_ptr<Outbox<SignalBlock>> signal_outbox() override { return inner_.signal_outbox(); }
  std::unique_ptr<Inbox<SignalBlock>> signal_inbox() override { return inner_.signal_inbox(); }
  bool reachable(SubstructureIndex substructure) const noexcept override { return inner_.reachable(substructure); }
  TransportCounters counters() const noexcept override { return inner_.counters(); }

  std::unique_ptr<Outbox<DisplacementCommand>> command_outbox(std::uint16_t count) override {
    return std::make_unique<Commands>(inner_.command_outbox(count), stamps_);
  }
  std::unique_ptr<Inbox<DisplacementCommand>> command_inbox(SubstructureIndex index) override {
    return std::make_unique<ReceivedCommands>(inner_.command_inbox(index), *this);
  }
  std::unique_ptr<Outbox<ForceMeasurement>> measurement_outbox(SubstructureIndex index) override {
    return std::make_unique<Answers>(inner_.measurement_outbox(index), stamps_);
  }
  std::unique_ptr<Inbox<ForceMeasurement>> measurement_inbox(std::uint16_t count) override {
    return std::make_unique<ReceivedAnswers>(inner_.measurement_inbox(count), *this);
  }

 private:
  struct Commands final : Outbox<DisplacementCommand> {
    Commands(std::unique_ptr<Outbox<DisplacementCommand>> to, SharedStamps& table)
        : inner{std::move(to)}, stamps{table} {}
    bool send(const DisplacementCommand& command) noexcept override {
      Stamps& at = stamps.at(command.newest().step, command.substructure);
      at.command_begun = clock_ns();
      const bool accepted = inner->send(command);
      at.command_sent = clock_ns();
      return accepted;
    }
    std::unique_ptr<Outbox<DisplacementCommand>> inner;
    SharedStamps& stamps;
  };
  struct ReceivedCommands final : Inbox<DisplacementCommand> {
    ReceivedCommands(std::unique_ptr<Inbox<DisplacementCommand>> from, TracedTransport& its_owner)
        : inner{std::move(from)}, owner{its_owner} {}
    bool take(DisplacementCommand& command) noexcept override {
      if (!inner->take(command)) return false;
      Stamps& at = owner.stamps_.at(command.newest().step, command.substructure);
      at.peer_woken = owner.woken_ns_;
      at.peer_advances = owner.advances_ns_;
      return true;
    }
    std::unique_ptr<Inbox<DisplacementCommand>> inner;
    TracedTransport& owner;
  };
  struct Answers final : Outbox<ForceMeasurement> {
    Answers(std::unique_ptr<Outbox<ForceMeasurement>> to, SharedStamps& table) : inner{std::move(to)}, stamps{table} {}
    bool send(const ForceMeasurement& measurement) noexcept override {
      Stamps& at = stamps.at(measurement.step, measurement.substructure);
      at.answer_begun = clock_ns();
      const bool accepted = inner->send(measurement);
      at.answered = clock_ns();
      return accepted;
    }
    std::unique_ptr<Outbox<ForceMeasurement>> inner;
    SharedStamps& stamps;
  };
  struct ReceivedAnswers final : Inbox<ForceMeasurement> {
    ReceivedAnswers(std::unique_ptr<Inbox<ForceMeasurement>> from, TracedTransport& its_owner)
        : inner{std::move(from)}, owner{its_owner} {}
    bool take(ForceMeasurement& measurement) noexcept override {
      if (!inner->take(measurement)) return false;
      Stamps& at = owner.stamps_.at(measurement.step, measurement.substructure);
      at.woken = owner.woken_ns_;
      at.advances = owner.advances_ns_;
      at.taken = clock_ns();
      return true;
    }
    std::unique_ptr<Inbox<ForceMeasurement>> inner;
    TracedTransport& owner;
  };

  Transport& inner_;
  SharedStamps& stamps_;
  std::int64_t woken_ns_ = 0;
  std::int64_t advances_ns_ = 0;
};

class TracedNode final : public Node {
 public:
  TracedNode(Node& inner, TracedTransport& trace) : inner_{inner}, trace_{trace} {}
  Instant advance(Instant now) noexcept override {
    trace_.advances();
    return inner_.advance(now);
  }

 private:
  Node& inner_;
  TracedTransport& trace_;
};

/// The rows of the steps, and how long each took.
class TracedSink final : public RowSink {
 public:
  explicit TracedSink(RowSink& inner) : inner_{inner} { times_us.reserve(1U << 17U); }
  void append(std::span<const double> row) noexcept override {
    const std::int64_t begun = clock_ns();
    inner_.append(row);
    if (times_us.size() < times_us.capacity()) times_us.push_back(static_cast<double>(clock_ns() - begun) * 1e-3);
  }
  std::vector<double> times_us;

 private:
  RowSink& inner_;
};

std::filesystem::path directory_of(int run) {
  return std::filesystem::temp_directory_path() / ("traced_steps_" + std::to_string(run));
}

std::string storey(int number) { return "storey_" + std::to_string(number); }

/// Everything around a node.
class TracedProcess {
 public:
  TracedProcess(const EchoSettings& settings, int run, const std::string& id)
      : scenario{read_scenario(directory_of(run) / "scenario.yaml", {})},
        stamps{directory_of(run) / "stamps", static_cast<int>(scenario.time.last_step) + 1, settings.peers},
        inner_{join(settings, run)},
        transport{*inner_, stamps},
        events_{transport.event_outbox()},
        id_{id},
        run_{run} {}

  /// Runs the participant to its end.
  template <class Make>
  StopReason run(Role role, const std::vector<TableLayout>& tables, const Make& make) {
    std::vector<RecordedTable> recorded;
    for (const TableLayout& table : tables) recorded.push_back({table});
    Recorder recorder{directory_of(run_) / (id_ + ".h5"),
                      run_file_header(scenario, id_, role, incarnation_, clock_.zero_unix_s()), recorded};
    TracedSink steps{recorder.sink("steps")};
    const auto sink = [&](std::string_view table) -> RowSink& {
      return table == "steps" ? static_cast<RowSink&>(steps) : recorder.sink(table);
    };
    const auto participant = make(ParticipantSurroundings{transport, *events_, sink, incarnation_, directory_of(run_)});
    TracedNode node{participant->node(), transport};
    RecorderThread recording{recorder};
    run_until(
        node, transport.waker(), clock_, [&] { return participant->is_done(); }, [](Instant) {});
    recording_us = std::move(steps.times_us);
    return participant->stop_reason();
  }

  const Scenario scenario;
  SharedStamps stamps;
  std::vector<double> recording_us;

 private:
  std::unique_ptr<Transport> join(const EchoSettings& settings, int run) {
    fast_dds::FastDdsSettings network;
    network.domain = settings.domain;
    network.loopback_only = true;
    network.best_effort_coupling = settings.best_effort;
    network.receives_in_waiting_thread = settings.receive == "waiting";
    network.busy_poll = std::chrono::microseconds{settings.busy_poll_us};
    network.when_woken = [this] { transport.woken(); };
    return fast_dds::make_fast_dds_transport(network, "traced" + std::to_string(run));
  }

  std::unique_ptr<Transport> inner_;

 public:
  TracedTransport transport;

 private:
  std::unique_ptr<Outbox<Event>> events_;
  const std::string id_;
  const int run_;
  const ProcessClock clock_;
  const Incarnation incarnation_ = draw_incarnation();
};

/// Of the substructure that answered last.
const Stamps& last_answered(SharedStamps& stamps, Step step, int substructures) {
  const Stamps* last = &stamps.at(step, 0);
  for (int i = 1; i < substructures; ++i) {
    const Stamps& other = stamps.at(step, static_cast<std::size_t>(i));
    if (other.taken >= last->taken) last = &other;
  }
  return *last;
}

StepTrace trace_of(SharedStamps& stamps, const EchoSettings& settings) {
  StepTrace trace;
  for (const char* stage :
       {"commands encoded and written", "to the substructure: kernel, thread wakes", "received by Fast DDS, decoded",
        "substructure computes", "answer encoded and written", "to the coordinator: kernel, thread wakes",
        "received by Fast DDS, decoded ", "ledger, integrator, next command"}) {
    trace.stages_us.emplace_back(stage, std::vector<double>{});
  }
  for (Step step = settings.warm_up; step + 1 < settings.warm_up + settings.samples; ++step) {
    const Stamps& path = last_answered(stamps, step, settings.peers);
    const std::int64_t begun = stamps.at(step, 0).command_begun;
    const std::int64_t next = stamps.at(step + 1, 0).command_begun;
    // A thread of Fast DDS that woke first leaves no stamp.
    const std::int64_t peer_woken = path.peer_woken == 0 ? path.peer_advances : path.peer_woken;
    const std::int64_t woken = path.woken == 0 ? path.advances : path.woken;
    const std::int64_t points[] = {
        begun, path.command_sent, peer_woken, path.peer_advances, path.answer_begun, path.answered,
        woken, path.advances,     next};
    trace.step_us.push_back(static_cast<double>(next - begun) * 1e-3);
    for (std::size_t i = 0; i + 1 < std::size(points); ++i) {
      trace.stages_us[i].second.push_back(static_cast<double>(points[i + 1] - points[i]) * 1e-3);
    }
  }
  return trace;
}

}  // namespace

void write_storeys(const std::filesystem::path& file, int storeys, int steps) {
  std::ofstream text{file};
  text << "schema: hybridtest/1\nname: storeys\ntime: {mode: lockstep, step_s: 0.001, duration_s: "
       << static_cast<double>(steps) * 1e-3 << "}\nexcitation: {ground_motion: " HYBRIDTEST_SOURCE_DIR
       << "/launch/scenarios/ground_motions/design_ec8_c.AT2}\nstructure:\n  degrees_of_freedom: [";
  for (int i = 1; i <= storeys; ++i) text << (i == 1 ? "" : ", ") << "floor_" << i;
  text << "]\n  mass_kg: {";
  for (int i = 1; i <= storeys; ++i) text << (i == 1 ? "" : ", ") << "floor_" << i << ": 20.0e3";
  text << "}\n  damping: {type: rayleigh, ratio: 0.02, modes: [1, 2]}\nintegrator: {type: central_difference}\n"
       << "substructures:\n";
  for (int i = 1; i <= storeys; ++i) {
    text << "  - id: " << storey(i) << "\n    kind: numerical\n    interface: [{dof: floor_" << i;
    if (i > 1) text << ", relative_to: floor_" << i - 1;
    text << "}]\n    model: {type: elastic, stiffness_n_per_m: 4.0e6}\n";
  }
}

int traced_peer(const EchoSettings& settings, int index, int run) {
  TracedProcess process{settings, run, storey(index + 1)};
  const SubstructureScenario& substructure = *process.scenario.find(storey(index + 1));
  const StopReason reason = process.run(
      substructure.role, substructure_tables(substructure), [&](const ParticipantSurroundings& surroundings) {
        return make_substructure_participant(process.scenario, substructure, surroundings);
      });
  return reason == StopReason::completed ? 0 : 1;
}

StepTrace traced_steps(const EchoSettings& settings) {
  static int runs = 0;
  const int run = static_cast<int>(::getpid()) * 100 + runs++ % 100;
  std::filesystem::create_directories(directory_of(run));
  write_storeys(directory_of(run) / "scenario.yaml", settings.peers, settings.warm_up + settings.samples);
  StepTrace trace;
  {
    TracedProcess process{settings, run, std::string{kCoordinatorId}};
    PeerProcesses peers;
    for (int i = 0; i < settings.peers; ++i) peers.start(echo_peer_arguments("nodes", i, run, settings));
    const StopReason reason =
        process.run(Role::coordinator, CoordinatorParticipant::tables(process.scenario),
                    [&](const ParticipantSurroundings& surroundings) {
                      return std::make_unique<CoordinatorParticipant>(process.scenario, surroundings);
                    });
    if (reason != StopReason::completed) throw std::runtime_error{"the traced test did not complete"};
    trace = trace_of(process.stamps, settings);
    trace.recording_us = std::move(process.recording_us);
  }
  std::filesystem::remove_all(directory_of(run));
  return trace;
}

}  // namespace hybridtest::benchmarks
