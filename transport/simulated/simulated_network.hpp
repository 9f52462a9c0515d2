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

/// How far away a participant is.
struct SiteLatency {
  std::string participant;
  Duration latency{};
};

/// The properties of a simulated network, the same on every link but for the latency.
struct NetworkConditions {
  Duration latency = std::chrono::microseconds{50};
  /// Of links to and from these participants instead; between two of them the longer one.
  std::vector<SiteLatency> site_latencies{};
  Duration jitter{};         // uniform, added to the latency
  double loss = 0.0;         // probability per message and receiver
  double duplication = 0.0;  // likewise
  double reordering = 0.0;   // likewise: the message is overtaken by later ones
  std::vector<Outage> outages;
};

/// What happened to messages so far.
struct NetworkCounters {
  std::uint64_t sent = 0;      // to one receiver each, before what the network does to them
  std::uint64_t coupling = 0;  // those of them that are commands and measurements
  std::uint64_t delivered = 0;
  std::uint64_t lost = 0;
  std::uint64_t duplicated = 0;
  std::uint64_t reordered = 0;
};

/// Places of an inbox for each member of the network, where that is more than kInboxCapacity.
inline constexpr std::size_t kInboxPerMember = 4;

struct NetworkState;

/// A network under simulated time: the same seed and the same sends give the same deliveries.
///
/// Commands, measurements, statuses, control messages and events can be lost, repeated and
/// reordered; the nodes must repair losses that a reliable transport would repair. The
/// announcement is never lost: it represents the transient-local sample that DDS delivers when
/// possible. An inbox of a network with many members holds more messages than kInboxCapacity:
/// kInboxPerMember for each member. Single-threaded.
class SimulatedNetwork {
 public:
  SimulatedNetwork(std::uint64_t seed, NetworkConditions conditions);
  ~SimulatedNetwork();
  SimulatedNetwork(const SimulatedNetwork&) = delete;
  SimulatedNetwork& operator=(const SimulatedNetwork&) = delete;

  /// @param participant       for outages and latencies; unique.
  /// @param substructure_id   of a substructure: of statuses it hears those of the coordinator, of tools and of other
  ///                          participants with this id, as over DDS. Empty for others, which hear all.
  [[nodiscard]] std::unique_ptr<Transport> join(std::string_view participant, std::string_view substructure_id = {});

  /// Removes the participant from the network, as kill -9 does; the others notice it by their leases.
  void kill(std::string_view participant);

  /// Time at which the next message arrives; kNever when there is none.
  [[nodiscard]] Instant next_delivery() const noexcept;
  /// Advances simulated time and puts the messages that have arrived into the inboxes.
  void advance_to(Instant now);
  /// For whom something arrived since the last call: numbers in the order of joining, each once, not sorted.
  void take_arrivals(std::vector<std::size_t>& participants);

  [[nodiscard]] const NetworkCounters& counters() const noexcept;

 private:
  std::unique_ptr<NetworkState> state_;
};

}  // namespace hybridtest::simulated
