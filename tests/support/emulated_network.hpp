#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <queue>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "core/random.hpp"
#include "core/time.hpp"
#include "tests/support/emulated_hosts.hpp"

namespace hybridtest {

/// Losses in bursts (Gilbert, 1960; Elliott, 1963): the link changes between a good and a bad state with each packet,
/// and loses packets in the bad one. The share of packets in the bad state is `to_bad / (to_bad + to_good)`, and the
/// mean burst is `1 / to_good` packets long.
struct LossBursts {
  double to_bad = 0.0;   // [1] probability per packet in the good state
  double to_good = 1.0;  // [1] probability per packet in the bad state, above 0
  double loss = 1.0;     // [1] share of packets lost in the bad state
};

/// What a link does to the packets of one direction.
struct LinkConditions {
  Duration delay{};          // of each packet
  Duration jitter{};         // added at random, evenly from 0 to this; packets keep their order
  double loss = 0.0;         // [1] share of packets lost, each by itself
  LossBursts bursts{};       // in addition
  double duplication = 0.0;  // [1] share of packets that arrive twice
  double reordering = 0.0;   // [1] share of packets that arrive later by `reordered_by`, others overtake them
  Duration reordered_by = std::chrono::milliseconds{2};
  double rate_bit_per_s = 0.0;                           // 0: no limit
  Duration queue_most = std::chrono::milliseconds{200};  // of a limited rate; what would wait longer is lost
  bool is_cut = false;                                   // a partition: everything is lost
};

/// Of one direction of a link. Each packet that was taken is one of lost, cut, overflowed and forwarded.
struct LinkCounters {
  std::uint64_t taken = 0;
  std::uint64_t lost = 0;        // by `loss` and `bursts`
  std::uint64_t cut = 0;         // by `is_cut`
  std::uint64_t overflowed = 0;  // of the queue of a limited rate
  std::uint64_t forwarded = 0;
  std::uint64_t doubled = 0;
  std::uint64_t reordered = 0;
};

/// Joins hosts by links with a given behaviour, each direction of a pair on its own. It forwards IPv4 packets on a
/// thread of its own. A seed repeats what happens to the packets of each link in their order.
class EmulatedNetwork {
 public:
  /// @param has_multicast   packets to a multicast address reach all other hosts; else none.
  EmulatedNetwork(std::vector<EmulatedHost> hosts, std::uint64_t seed, bool has_multicast);
  ~EmulatedNetwork();
  EmulatedNetwork(const EmulatedNetwork&) = delete;
  EmulatedNetwork& operator=(const EmulatedNetwork&) = delete;

  [[nodiscard]] const EmulatedHost& host(std::size_t index) const { return hosts_.at(index); }

  /// Of one direction, by the indices of the hosts, from the next packet on.
  void set(std::size_t from, std::size_t to, const LinkConditions& conditions);
  /// Of all links.
  void set_all(const LinkConditions& conditions);
  /// Cuts all links of a host, or restores them with their other conditions.
  void cut(std::size_t host, bool is_cut);

  [[nodiscard]] LinkCounters counters(std::size_t from, std::size_t to) const;
  /// The sum over all links.
  [[nodiscard]] LinkCounters counters() const;

 private:
  using Clock = std::chrono::steady_clock;
  using Packet = std::vector<std::uint8_t>;

  struct Link {
    LinkConditions conditions;
    LinkCounters counters;
    Random random{0};
    bool is_bad = false;
    Clock::time_point sent_until{};  // of a limited rate
    Clock::time_point last_due{};
  };
  struct Waiting {
    Clock::time_point due;
    std::uint64_t number = 0;  // breaks ties in the order of arrival
    std::size_t to = 0;
    std::shared_ptr<const Packet> packet;
    friend bool operator>(const Waiting& a, const Waiting& b) noexcept {
      return std::pair{a.due, a.number} > std::pair{b.due, b.number};
    }
  };

  void forward();
  void take_packets(std::size_t from);
  void route(std::size_t from, const Packet& packet, Clock::time_point now);
  void pass(std::size_t from, std::size_t to, const std::shared_ptr<const Packet>& packet, Clock::time_point now);
  void deliver_due();
  [[nodiscard]] Link& link(std::size_t from, std::size_t to) { return links_[from * hosts_.size() + to]; }
  [[nodiscard]] const Link& link(std::size_t from, std::size_t to) const { return links_[from * hosts_.size() + to]; }

  std::vector<EmulatedHost> hosts_;
  bool has_multicast_;
  std::vector<Link> links_;                                                     // by from and to
  std::priority_queue<Waiting, std::vector<Waiting>, std::greater<>> waiting_;  // of the forwarding thread
  std::uint64_t number_ = 0;
  OwnedFile end_;             // written at the end
  mutable std::mutex mutex_;  // for links_
  std::thread thread_;
};

}  // namespace hybridtest
