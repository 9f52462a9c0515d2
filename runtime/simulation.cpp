#include "runtime/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

#include "core/config_error.hpp"
#include "core/random.hpp"
#include "runtime/participant.hpp"

namespace hybridtest {
namespace {

/// The observer gets a progress report after this number of runs of the coordinator.
constexpr std::int64_t kProgressEvery = 512;

/// The clock of a participant: starts with the participant and has a small drift.
class DriftingClock {
 public:
  DriftingClock(Duration start, double drift) noexcept : start_{start}, rate_{1.0 + drift} {}

  [[nodiscard]] Instant local(Instant simulated) const noexcept {
    return Instant{scaled(simulated.time_since_epoch() - start_, rate_)};
  }
  /// The earliest simulated instant at which the local clock shows `local`.
  [[nodiscard]] Instant simulated(Instant local) const noexcept {
    if (local == kNever) return kNever;
    Instant instant{start_ + scaled(local.time_since_epoch(), 1.0 / rate_)};
    while (this->local(instant) < local) instant += Duration{1};
    return instant;
  }
  [[nodiscard]] Duration start() const noexcept { return start_; }

 private:
  static Duration scaled(Duration duration, double rate) noexcept {
    return Duration{static_cast<std::int64_t>(std::floor(static_cast<double>(duration.count()) * rate))};
  }

  Duration start_;
  double rate_;
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
  Instant wake{};  // simulated time
  bool was_killed = false;

  [[nodiscard]] bool is_over() const noexcept { return was_killed || participant->is_done(); }
};

class Simulation {
 public:
  Simulation(const Scenario& scenario, const SimulationSettings& settings, const SimulationObserver& observer)
      : scenario_{scenario},
        settings_{settings},
        observer_{observer},
        random_{settings.seed, 0x74657374},
        network_{settings.seed, settings.network} {
    join(std::string{kCoordinatorId}, CoordinatorParticipant::tables(scenario),
         [&](const auto& surroundings) { return std::make_unique<CoordinatorParticipant>(scenario, surroundings); });
    for (const SubstructureScenario& substructure : scenario.substructures) {
      join(substructure.id, substructure_tables(substructure), [&](const auto& surroundings) {
        return make_substructure_participant(scenario, substructure, surroundings);
      });
    }
  }

  [[nodiscard]] SimulationResult run() {
    while (!is_over()) {
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
  void join(const std::string& id, const std::vector<TableLayout>& tables, Make make) {
    const Duration start{static_cast<std::int64_t>(random_.below(100'000'000))};
    const double drift = random_.uniform(-1.0, 1.0) * settings_.clock_drift_ppm_max * 1e-6;
    SimulatedParticipant& joined = participants_.emplace_back(
        SimulatedParticipant{id, DriftingClock{start, drift}, network_.join(id), {}, {}, {}, Instant{start}, false});
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

  [[nodiscard]] bool is_over() const {
    return std::ranges::all_of(participants_, [](const auto& participant) { return participant.is_over(); });
  }

  [[nodiscard]] Instant next_instant() const {
    Instant next = network_.next_delivery();
    for (const SimulatedParticipant& participant : participants_) {
      if (!participant.is_over()) next = std::min(next, participant.wake);
    }
    for (const SimulatedKill& kill : settings_.kills) {
      if (Instant{kill.at} > now_) next = std::min(next, Instant{kill.at});
    }
    return next;
  }

  void apply_kills() {
    for (const SimulatedKill& kill : settings_.kills) {
      if (Instant{kill.at} > now_) continue;
      for (SimulatedParticipant& participant : participants_) {
        if (participant.id != kill.participant || participant.is_over()) continue;
        participant.was_killed = true;
        network_.kill(participant.id);
      }
    }
  }

  void advance_participants() {
    for (std::size_t i = 0; i < participants_.size(); ++i) {
      SimulatedParticipant& participant = participants_[i];
      const bool has_arrival = network_.take_arrival(i);
      const bool has_started = now_ >= Instant{participant.clock.start()};
      if (participant.is_over() || !has_started || (!has_arrival && participant.wake > now_)) continue;
      if (const Instant end = end_of_pause(participant.id); end > now_) {
        participant.wake = end;
        continue;
      }
      const Instant local = participant.clock.local(now_);
      const Instant wake = participant.participant->node().advance(local);
      // A node that is due at once runs a nanosecond later, so that time moves on.
      participant.wake = std::max(participant.clock.simulated(wake), now_ + Duration{1});
      if (i == 0 && ++coordinator_runs_ % kProgressEvery == 0) {
        keep_house();
        if (observer_.progress(report())) participant.participant->request_stop(StopReason::interrupted);
      }
    }
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
    for (SimulatedParticipant& participant : participants_) {
      if (participant.is_over()) continue;
      observer_.housekeeping(participant.id, participant.participant->presence(), participant.clock.local(now_));
    }
  }

  [[nodiscard]] CoordinatorReport report() const {
    return static_cast<const CoordinatorParticipant&>(*participants_.front().participant).report();
  }

  [[nodiscard]] SimulationResult result() {
    SimulationResult result;
    result.coordinator = report();
    for (const SimulatedParticipant& participant : participants_) {
      result.participants.push_back({participant.id, participant.was_killed, participant.participant->is_done(),
                                     participant.participant->stop_reason(),
                                     participant.participant->presence().faults()});
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
  std::deque<SimulatedParticipant> participants_;  // a deque: references to its elements must stay valid
  Instant now_{};
  std::int64_t coordinator_runs_ = 0;
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
