#pragma once

#include <deque>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/participant.hpp"
#include "scenario/scenario.hpp"
#include "tests/support/kept_rows.hpp"
#include "transport/simulated/simulated_network.hpp"

namespace hybridtest {

/// Participants on a simulated network, added one by one: also combinations that a scenario does not
/// allow, such as two participants of one id.
class NodeBench {
 public:
  explicit NodeBench(const simulated::NetworkConditions& conditions = {}, std::uint64_t seed = 1)
      : network_{seed, conditions} {}

  struct Seat {
    std::string name;        // on the network; unlike the id unique
    std::size_t number = 0;  // in the order of joining the network
    Duration start{};
    std::unique_ptr<Transport> transport;
    std::unique_ptr<Outbox<Event>> events;
    std::map<std::string, KeptRows, std::less<>> tables;
    std::unique_ptr<Participant> participant;
    Instant wake{};

    [[nodiscard]] StopReason reason() const { return participant->stop_reason(); }
    [[nodiscard]] LifecycleState state() const { return participant->presence().state(); }
    [[nodiscard]] Incarnation incarnation() const { return participant->presence().identity().incarnation; }
  };

  /// @param scenario   outlives the bench.
  /// @param start      simulated time at which its clock starts and it runs first.
  Seat& add_coordinator(const Scenario& scenario, Duration start = {});
  Seat& add_substructure(const Scenario& scenario, std::string_view id, Duration start = {});
  /// A sender that is not a participant: an operator or an impostor.
  Transport& add_outsider();

  /// Runs all participants up to this simulated time.
  void run_until(Duration time);
  /// Runs until every participant has ended. @return false when one has not ended by then.
  [[nodiscard]] bool run_to_end(Duration time_limit);
  [[nodiscard]] Duration now() const noexcept { return now_.time_since_epoch(); }

  [[nodiscard]] const std::vector<Event>& events() const noexcept { return events_; }
  [[nodiscard]] std::size_t count(EventCode code, Incarnation source) const;

 private:
  template <class Make>
  Seat& join(std::string name, Duration start, Make make);
  void run_next(Instant next);

  simulated::SimulatedNetwork network_;
  std::deque<Seat> seats_;
  std::vector<std::unique_ptr<Transport>> outsiders_;
  std::vector<Event> events_;
  std::vector<std::size_t> arrived_;  // seats for whom something came
  Instant now_{};
};

}  // namespace hybridtest
