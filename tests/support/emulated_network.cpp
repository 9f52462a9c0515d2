#include "tests/support/emulated_network.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <stdexcept>

namespace hybridtest {
namespace {

constexpr std::size_t kLargestPacket = 65'536;

/// IPv4, network byte order, where the header has it.
struct Destination {
  std::uint8_t first = 0;
  std::uint8_t last = 0;
};

std::optional<Destination> destination_of(std::span<const std::uint8_t> packet) {
  constexpr std::size_t kAt = 16;
  if (packet.size() < 20 || packet[0] >> 4U != 4U) return {};
  return Destination{packet[kAt], packet[kAt + 3]};
}

bool happens(Random& random, double probability) { return probability > 0.0 && random.uniform() < probability; }

}  // namespace

EmulatedNetwork::EmulatedNetwork(std::vector<EmulatedHost> hosts, std::uint64_t seed, bool has_multicast)
    : hosts_{std::move(hosts)},
      has_multicast_{has_multicast},
      links_(hosts_.size() * hosts_.size()),
      end_{::eventfd(0, EFD_CLOEXEC)} {
  if (end_.get() < 0) throw std::runtime_error{"no eventfd"};
  for (std::size_t i = 0; i < links_.size(); ++i) links_[i].random = Random{seed, i};
  thread_ = std::thread{[this] { forward(); }};
}

EmulatedNetwork::~EmulatedNetwork() {
  const std::uint64_t one = 1;
  static_cast<void>(::write(end_.get(), &one, sizeof one));
  thread_.join();
}

void EmulatedNetwork::set(std::size_t from, std::size_t to, const LinkConditions& conditions) {
  const std::lock_guard lock{mutex_};
  link(from, to).conditions = conditions;
}

void EmulatedNetwork::set_all(const LinkConditions& conditions) {
  const std::lock_guard lock{mutex_};
  for (Link& one : links_) one.conditions = conditions;
}

void EmulatedNetwork::cut(std::size_t host, bool is_cut) {
  const std::lock_guard lock{mutex_};
  for (std::size_t other = 0; other < hosts_.size(); ++other) {
    link(host, other).conditions.is_cut = is_cut;
    link(other, host).conditions.is_cut = is_cut;
  }
}

LinkCounters EmulatedNetwork::counters(std::size_t from, std::size_t to) const {
  const std::lock_guard lock{mutex_};
  return link(from, to).counters;
}

LinkCounters EmulatedNetwork::counters() const {
  const std::lock_guard lock{mutex_};
  LinkCounters sum;
  for (const Link& one : links_) {
    sum.taken += one.counters.taken;
    sum.lost += one.counters.lost;
    sum.cut += one.counters.cut;
    sum.overflowed += one.counters.overflowed;
    sum.forwarded += one.counters.forwarded;
    sum.doubled += one.counters.doubled;
    sum.reordered += one.counters.reordered;
  }
  return sum;
}

void EmulatedNetwork::forward() {
  std::vector<pollfd> files;
  for (const EmulatedHost& host : hosts_) files.push_back({.fd = host.tunnel(), .events = POLLIN, .revents = 0});
  files.push_back({.fd = end_.get(), .events = POLLIN, .revents = 0});
  while ((files.back().revents & POLLIN) == 0) {
    timespec patience{1, 0};
    if (!waiting_.empty()) {
      const auto left = std::max(Clock::duration{0}, waiting_.top().due - Clock::now());
      const auto whole_s = std::chrono::duration_cast<std::chrono::seconds>(left);
      patience = {static_cast<time_t>(whole_s.count()), static_cast<long>((left - whole_s).count())};
    }
    static_cast<void>(::ppoll(files.data(), files.size(), &patience, nullptr));
    for (std::size_t from = 0; from < hosts_.size(); ++from) {
      if ((files[from].revents & POLLIN) != 0) take_packets(from);
    }
    deliver_due();
  }
}

void EmulatedNetwork::take_packets(std::size_t from) {
  // Not without end: the others and what is due have their turn.
  constexpr int kAtOnce = 64;
  Packet packet(kLargestPacket);
  for (int i = 0; i < kAtOnce; ++i) {
    packet.resize(kLargestPacket);
    const ssize_t size = ::read(hosts_[from].tunnel(), packet.data(), packet.size());
    if (size <= 0) return;
    packet.resize(static_cast<std::size_t>(size));
    route(from, packet, Clock::now());
  }
}

void EmulatedNetwork::route(std::size_t from, const Packet& packet, Clock::time_point now) {
  const auto destination = destination_of(packet);
  if (!destination) return;  // IPv6, which nobody here asked for
  const bool is_multicast = destination->first >> 4U == 14U;
  if (is_multicast && !has_multicast_) return;
  const auto shared = std::make_shared<const Packet>(packet);
  const std::lock_guard lock{mutex_};
  for (std::size_t to = 0; to < hosts_.size(); ++to) {
    if (to != from && (is_multicast || destination->last == hosts_[to].number())) pass(from, to, shared, now);
  }
}

void EmulatedNetwork::pass(std::size_t from, std::size_t to, const std::shared_ptr<const Packet>& packet,
                           Clock::time_point now) {
  Link& on = link(from, to);
  const LinkConditions& conditions = on.conditions;
  ++on.counters.taken;
  if (conditions.is_cut) {
    ++on.counters.cut;
    return;
  }
  on.is_bad = on.is_bad ? !happens(on.random, conditions.bursts.to_good) : happens(on.random, conditions.bursts.to_bad);
  const bool is_lost_in_burst = on.is_bad && happens(on.random, conditions.bursts.loss);
  if (happens(on.random, conditions.loss) || is_lost_in_burst) {
    ++on.counters.lost;
    return;
  }
  Clock::time_point sent = now;
  if (conditions.rate_bit_per_s > 0.0) {
    sent = std::max(now, on.sent_until) +
           from_seconds(8.0 * static_cast<double>(packet->size()) / conditions.rate_bit_per_s);
    if (sent - now > conditions.queue_most) {
      ++on.counters.overflowed;
      return;
    }
    on.sent_until = sent;
  }
  Clock::time_point due = sent + conditions.delay;
  if (conditions.jitter > Duration{0}) due += from_seconds(on.random.uniform() * to_seconds(conditions.jitter));
  due = on.last_due = std::max(due, on.last_due);
  ++on.counters.forwarded;
  if (happens(on.random, conditions.reordering)) {
    ++on.counters.reordered;
    due += conditions.reordered_by;
  }
  waiting_.push({due, number_++, to, packet});
  if (happens(on.random, conditions.duplication)) {
    ++on.counters.doubled;
    waiting_.push({due, number_++, to, packet});
  }
}

void EmulatedNetwork::deliver_due() {
  while (!waiting_.empty() && waiting_.top().due <= Clock::now()) {
    const Waiting& next = waiting_.top();
    // A device that does not take it is a full receive queue: lost, as on a real host.
    static_cast<void>(::write(hosts_[next.to].tunnel(), next.packet->data(), next.packet->size()));
    waiting_.pop();
  }
}

}  // namespace hybridtest
