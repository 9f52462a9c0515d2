#include "tests/simulation/node_bench.hpp"

#include <algorithm>

namespace hybridtest {
namespace {

class KeptEvents final : public Outbox<Event> {
 public:
  explicit KeptEvents(std::vector<Event>& events) : events_{events} {}
  bool send(const Event& event) noexcept override {
    events_.push_back(event);
    return true;
  }

 private:
  std::vector<Event>& events_;
};

constexpr Incarnation kFirstIncarnation = 1001;

}  // namespace

template <class Make>
NodeBench::Seat& NodeBench::join(std::string name, Duration start, Make make) {
  const std::size_t number = seats_.size() + outsiders_.size();
  Seat& seat = seats_.emplace_back();
  seat.number = number;
  seat.name = std::move(name) + "#" + std::to_string(seats_.size());
  seat.start = start;
  seat.wake = Instant{start};
  seat.transport = network_.join(seat.name);
  seat.events = std::make_unique<KeptEvents>(events_);
  seat.participant = make(seat);
  return seat;
}

NodeBench::Seat& NodeBench::add_coordinator(const Scenario& scenario, Duration start) {
  return join("coordinator", start, [&](Seat& seat) {
    for (const TableLayout& table : CoordinatorParticipant::tables(scenario))
      seat.tables.try_emplace(table.name, table);
    return std::make_unique<CoordinatorParticipant>(
        scenario,
        ParticipantSurroundings{*seat.transport, *seat.events,
                                [&seat](std::string_view table) -> RowSink& { return seat.tables.find(table)->second; },
                                kFirstIncarnation + seats_.size()});
  });
}

NodeBench::Seat& NodeBench::add_substructure(const Scenario& scenario, std::string_view id, Duration start) {
  const SubstructureScenario& substructure = *scenario.find(id);
  return join(std::string{id}, start, [&](Seat& seat) {
    for (const TableLayout& table : substructure_tables(substructure)) seat.tables.try_emplace(table.name, table);
    return make_substructure_participant(
        scenario, substructure,
        ParticipantSurroundings{*seat.transport, *seat.events,
                                [&seat](std::string_view table) -> RowSink& { return seat.tables.find(table)->second; },
                                kFirstIncarnation + seats_.size()});
  });
}

Transport& NodeBench::add_outsider() {
  return *outsiders_.emplace_back(network_.join("outsider#" + std::to_string(outsiders_.size())));
}

void NodeBench::run_next(Instant next) {
  now_ = std::max(now_, next);
  network_.advance_to(now_);
  network_.take_arrivals(arrived_);
  for (Seat& seat : seats_) {
    const bool has_arrival = std::ranges::find(arrived_, seat.number) != arrived_.end();
    if (seat.participant->is_done() || now_ < Instant{seat.start} || (!has_arrival && seat.wake > now_)) continue;
    const Instant wake = seat.participant->node().advance(now_ - seat.start);
    seat.wake = wake == kNever ? kNever : std::max(wake + seat.start, now_ + Duration{1});
  }
}

void NodeBench::run_until(Duration time) {
  for (;;) {
    Instant next = network_.next_delivery();
    for (const Seat& seat : seats_) {
      if (!seat.participant->is_done()) next = std::min(next, seat.wake);
    }
    if (next > Instant{time}) break;
    run_next(next);
  }
  now_ = std::max(now_, Instant{time});
  network_.advance_to(now_);
}

bool NodeBench::run_to_end(Duration time_limit) {
  const auto is_over = [&] {
    return std::ranges::all_of(seats_, [](const Seat& seat) { return seat.participant->is_done(); });
  };
  while (!is_over() && now() < time_limit) run_until(now() + std::chrono::milliseconds{10});
  return is_over();
}

std::size_t NodeBench::count(EventCode code, Incarnation source) const {
  return static_cast<std::size_t>(std::ranges::count_if(
      events_, [&](const Event& event) { return event.code == code && event.incarnation == source; }));
}

}  // namespace hybridtest
