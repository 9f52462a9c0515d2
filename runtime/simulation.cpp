#include "runtime/simulation.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "core/config_error.hpp"
#include "core/random.hpp"
#include "runtime/participant.hpp"
#include "runtime/wake_times.hpp"

namespace hybridtest {
namespace {

/// The observer gets a progress report after this number of runs of the coordinator ...
constexpr std::int64_t kProgressEvery = 512;
/// ... or, in a test of many substructures, after steps with this number of exchanges: each is a row of a recording.
constexpr Step kExchangesMost = 512 * kMaxSubstructures;

/// The clock of a participant: starts with the participant and has a small drift.
class DriftingClock {
 public:
  DriftingClock(Duration start, double drift) noexcept
      : start_{start}, rate_{1.0 + drift}, inverse_rate_{1.0 / rate_} {}

  [[nodiscard]] Instant local(Instant simulated) const noexcept {
    return Instant{scaled(simulated.time_since_epoch() - start_, rate_)};
  }
  /// The earliest simulated instant at which the local clock shows `local`.
  [[nodiscard]] Instant simulated(Instant local) const noexcept {
    if (local == kNever) return kNever;
    Instant instant{start_ + scaled(local.time_since_epoch(), inverse_rate_)};
    while (this->local(instant) < local) instant += Duration{1};
    return instant;
  }
  /// Not later than simulated(), and cheaper.
  [[nodiscard]] Instant not_before(Instant local) const noexcept {
    if (local == kNever) return kNever;
    const double about = static_cast<double>(local.time_since_epoch().count()) * inverse_rate_;
    return Instant{start_ + Duration{static_cast<std::int64_t>(about) - 1}};
  }
  [[nodiscard]] Duration start() const noexcept { return start_; }
  [[nodiscard]] double drift() const noexcept { return rate_ - 1.0; }

 private:
  static Duration scaled(Duration duration, double rate) noexcept {
    const double exact = static_cast<double>(duration.count()) * rate;
    const auto whole = static_cast<std::int64_t>(exact);
    return Duration{static_cast<double>(whole) > exact ? whole - 1 : whole};  // rounded down
  }

  Duration start_;
  double rate_;
  double inverse_rate_;
};

class ObservedEvents final : public Outbox<Event> {
 public:
  ObservedEvents(Outbox<Event>& network, const SimulationObserver& observer) : network_{network}, observer_{observer} {}
  bool send(const Event& event) noexcept override {
    observer_.event(event);
    return network_.send(event);
  }

 private:
  Outbox<Event>& network_;
  const SimulationObserver& observer_;
};

struct SimulatedParticipant {
  std::string id;
  DriftingClock clock;
  std::unique_ptr<Transport> transport;
  std::unique_ptr<Outbox<Event>> network_events;
  std::unique_ptr<ObservedEvents> events;
  std::unique_ptr<Participant> participant;
  bool was_killed = false;
  bool is_over = false;  // killed or done
};

/// When a participant wants to run, by its clock. Most are woken by a message before: the simulated time is found when
/// it is needed.
struct Wake {
  Instant local{};
  bool is_exact = true;  // the simulated time is found; otherwise it is known not to be earlier
};

class Simulation {
 public:
  Simulation(const Scenario& scenario, const SimulationSettings& settings, const SimulationObserver& observer)
      : scenario_{scenario},
        settings_{settings},
        observer_{observer},
        random_{settings.seed, 0x74657374},
        network_{settings.seed, settings.network},
        wake_times_{1 + scenario.substructures.size()} {
    join(std::string{kCoordinatorId}, {}, CoordinatorParticipant::tables(scenario),
         [&](const auto& surroundings) { return std::make_unique<CoordinatorParticipant>(scenario, surroundings); });
    // All hear the statuses of all where that is cheap: a status that wakes a substructure has it tell its own state
    // earlier, and the bytes of earlier versions of this software are kept.
    const bool hears_all = scenario.substructures.size() <= kMaxSubstructures;
    for (const SubstructureScenario& substructure : scenario.substructures) {
      join(substructure.id, hears_all ? "" : substructure.id, substructure_tables(substructure),
           [&](const auto& surroundings) {
             return make_substructure_participant(scenario, substructure, surroundings);
           });
    }
  }

  [[nodiscard]] SimulationResult run() {
    while (running_ > 0) {
      const Instant next = next_instant();
      if (next == kNever || next.time_since_epoch() > settings_.time_limit) break;
      now_ = std::max(now_, next);
      network_.advance_to(now_);
      apply_kills();
      advance_participants();
    }
    return result();
  }

 private:
  template <class Make>
  void join(const std::string& id, const std::string& substructure_id, const std::vector<TableLayout>& tables,
            Make make) {
    const Duration start{static_cast<std::int64_t>(random_.below(100'000'000))};
    const double drift = random_.uniform(-1.0, 1.0) * settings_.clock_drift_ppm_max * 1e-6;
    SimulatedParticipant& joined =
        *participants_.emplace_back(std::make_unique<SimulatedParticipant>(SimulatedParticipant{
            id, DriftingClock{start, drift}, network_.join(id, substructure_id), {}, {}, {}, false, false}));
    ++running_;
    wake_times_.set(wakes_.size(), Instant{start});
    wakes_.emplace_back();
    joined.network_events = joined.transport->event_outbox();
    joined.events = std::make_unique<ObservedEvents>(*joined.network_events, observer_);
    const ParticipantSurroundings surroundings{*joined.transport, *joined.events,
                                               [&](std::string_view table) -> RowSink& {
                                                 const auto layout =
                                                     std::ranges::find(tables, table, &TableLayout::name);
                                                 return observer_.sink(id, *layout);
                                               },
                                               random_.bits() | 1U};
    joined.participant = make(surroundings);
  }

  [[nodiscard]] Instant next_instant() {
    Instant next = network_.next_delivery();
    for (const SimulatedKill& kill : settings_.kills) {
      if (Instant{kill.at} > now_) next = std::min(next, Instant{kill.at});
    }
    while (wake_times_.earliest() <= next) {
      if (!was_made_exact(wake_times_.first())) return wake_times_.earliest();
    }
    return next;
  }

  /// @return false when the wake was exact.
  bool was_made_exact(std::size_t i) {
    if (std::exchange(wakes_[i].is_exact, true)) return false;
    wake_times_.set(i, std::max(wake_times_.at(i), participants_[i]->clock.simulated(wakes_[i].local)));
    return true;
  }

  void apply_kills() {
    for (const SimulatedKill& kill : settings_.kills) {
      if (Instant{kill.at} > now_) continue;
      for (std::size_t i = 0; i < participants_.size(); ++i) {
        SimulatedParticipant& participant = *participants_[i];
        if (participant.id != kill.participant || participant.is_over) continue;
        participant.was_killed = true;
        leave(i);
        network_.kill(participant.id);
      }
    }
  }

  /// Whoever something arrived for is due.
  void wake_receivers() {
    network_.take_arrivals(arrived_);
    for (const std::size_t i : arrived_) {
      const SimulatedParticipant& participant = *participants_[i];
      if (!participant.is_over && now_ >= Instant{participant.clock.start()}) wake_at(i, now_);
    }
  }

  void advance_participants() {
    wake_receivers();
    wake_times_.find_due(now_, due_);
    for (const std::size_t i : due_) {
      if (was_made_exact(i) && wake_times_.at(i) > now_) continue;
      SimulatedParticipant& participant = *participants_[i];
      if (const Instant end = end_of_pause(participant.id); end > now_) {
        wake_at(i, end);
        continue;
      }
      const Instant local = participant.clock.local(now_);
      const Instant wake = participant.participant->node().advance(local);
      // A node that is due at once runs a nanosecond later, so that time moves on.
      wake_times_.set(i, std::max(participant.clock.not_before(wake), now_ + Duration{1}));
      wakes_[i] = {.local = wake, .is_exact = false};
      if (participant.participant->is_done()) leave(i);
      if (i == 0 && progress_is_due()) {
        keep_house();
        if (observer_.progress(report())) participant.participant->request_stop(StopReason::interrupted);
      }
    }
  }

  /// After a run of the coordinator.
  [[nodiscard]] bool progress_is_due() {
    const Step steps = report().completed_steps;
    ++runs_since_progress_;
    const Step exchanges = (steps - steps_at_progress_) * std::ssize(scenario_.substructures);
    if (runs_since_progress_ < kProgressEvery && exchanges < kExchangesMost) return false;
    runs_since_progress_ = 0;
    steps_at_progress_ = steps;
    return true;
  }

  void wake_at(std::size_t i, Instant at) {
    wake_times_.set(i, at);
    wakes_[i].is_exact = true;
  }

  /// Nothing wakes a participant that is over.
  void leave(std::size_t participant) {
    participants_[participant]->is_over = true;
    wake_at(participant, kNever);
    --running_;
  }

  /// Of the one that lasts now; an earlier instant without one.
  [[nodiscard]] Instant end_of_pause(const std::string& id) const {
    Instant end{};
    for (const SimulatedPause& pause : settings_.pauses) {
      if (pause.participant == id && Instant{pause.begin} <= now_) end = std::max(end, Instant{pause.end});
    }
    return end;
  }

  void keep_house() {
    for (const auto& participant : participants_) {
      if (participant->is_over) continue;
      observer_.housekeeping(participant->id, participant->participant->presence(), participant->clock.local(now_));
    }
  }

  [[nodiscard]] CoordinatorReport report() const {
    return static_cast<const CoordinatorParticipant&>(*participants_.front()->participant).report();
  }

  [[nodiscard]] SimulationResult result() {
    SimulationResult result;
    result.coordinator = report();
    for (const auto& participant : participants_) {
      result.participants.push_back({participant->id, participant->was_killed, participant->participant->is_done(),
                                     participant->participant->stop_reason(),
                                     participant->participant->presence().faults(), participant->clock.start(),
                                     participant->clock.drift()});
    }
    result.network = network_.counters();
    result.simulated_time = now_.time_since_epoch();
    return result;
  }

  const Scenario& scenario_;
  const SimulationSettings& settings_;
  const SimulationObserver& observer_;
  Random random_;
  simulated::SimulatedNetwork network_;
  std::vector<std::unique_ptr<SimulatedParticipant>> participants_;  // pointers: what refers to them stays valid
  std::vector<Wake> wakes_;                                          // of the participants
  WakeTimes wake_times_;                                             // likewise, in simulated time
  std::vector<std::size_t> arrived_;                                 // those for whom something came
  std::vector<std::size_t> due_;                                     // those who run now
  std::size_t running_ = 0;                                          // participants that are not over
  Instant now_{};
  std::int64_t runs_since_progress_ = 0;  // of the coordinator
  Step steps_at_progress_ = 0;
};

}  // namespace

void require_simulable(const Scenario& scenario) {
  if (scenario.opensees) {
    throw ConfigError{scenario.name +
                      ": OpenSees leads this test; it runs outside this process and cannot follow simulated time; use "
                      "`hybridtest run`"};
  }
  for (const SubstructureScenario& substructure : scenario.substructures) {
    if (!substructure.site.rig_is_elsewhere) continue;
    throw ConfigError{"the rig of " + substructure.id + " is of type " + substructure.site.rig_type +
                      ": it runs outside this process and cannot follow simulated time; choose another type, "
                      "such as `simulated`, or use `hybridtest run`"};
  }
}

SimulationResult simulate(const Scenario& scenario, const SimulationSettings& settings,
                          const SimulationObserver& observer) {
  require_simulable(scenario);
  return Simulation{scenario, settings, observer}.run();
}

}  // namespace hybridtest
