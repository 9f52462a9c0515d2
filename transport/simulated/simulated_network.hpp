#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/random.hpp"
#include "core/time.hpp"
#include "transport/transport.hpp"

namespace hybridtest::simulated {

/// Nothing from or to this participant arrives while it lasts.
struct Outage {
  std::string participant;
  Duration begin{};  // simulated time
  Duration end{};
};

/// The properties of a simulated network, the same on every link.
struct NetworkConditions {
  Duration latency = std::chrono::microseconds{50};
  Duration jitter{};         // uniform, added to the latency
  double loss = 0.0;         // probability per message and receiver
  double duplication = 0.0;  // likewise
  double reordering = 0.0;   // likewise: the message is overtaken by later ones
  std::vector<Outage> outages;
};

/// What happened to messages so far.
struct NetworkCounters {
  std::uint64_t delivered = 0;
  std::uint64_t lost = 0;
  std::uint64_t duplicated = 0;
  std::uint64_t reordered = 0;
};

struct NetworkState;

/// A network under simulated time: the same seed and the same sends give the same deliveries.
///
/// Commands, measurements, statuses, control messages and events can be lost, repeated and
/// reordered; the nodes must repair losses that a reliable transport would repair. The
/// announcement is never lost: it represents the transient-local sample that DDS delivers when
/// possible. Single-threaded.
class SimulatedNetwork {
 public:
  SimulatedNetwork(std::uint64_t seed, NetworkConditions conditions);
  ~SimulatedNetwork();
  SimulatedNetwork(const SimulatedNetwork&) = delete;
  SimulatedNetwork& operator=(const SimulatedNetwork&) = delete;

  /// @param participant   for outages; unique.
  [[nodiscard]] std::unique_ptr<Transport> join(std::string_view participant);

  /// Removes the participant from the network, as kill -9 does; the others notice it by their leases.
  void kill(std::string_view participant);

  /// Time at which the next message arrives; kNever when there is none.
  [[nodiscard]] Instant next_delivery() const noexcept;
  /// Advances simulated time and puts the messages that have arrived into the inboxes.
  void advance_to(Instant now);
  /// Whether something arrived for a participant since the last call. @param participant   in the order of joining.
  [[nodiscard]] bool take_arrival(std::size_t participant) noexcept;

  [[nodiscard]] const NetworkCounters& counters() const noexcept;

 private:
  std::unique_ptr<NetworkState> state_;
};

}  // namespace hybridtest::simulated
