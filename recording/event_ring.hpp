#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "core/messages.hpp"
#include "core/ports.hpp"
#include "core/spsc_ring.hpp"

namespace hybridtest {

/// Bounded queue of events from one producing thread to the recorder. A full queue drops and
/// counts the event. Lock-free, no allocation after construction.
class EventRing final : public Outbox<Event> {
 public:
  explicit EventRing(std::size_t capacity) : ring_{capacity} {}

  /// Producer. @return false when the event was dropped.
  bool send(const Event& event) noexcept override {
    if (ring_.push(event)) return true;
    dropped_.fetch_add(1, std::memory_order_relaxed);
    return false;
  }

  /// Consumer. @return false when empty.
  [[nodiscard]] bool take(Event& event) noexcept { return ring_.pop(event); }

  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  SpscRing<Event> ring_;
  std::atomic<std::uint64_t> dropped_{0};
};

}  // namespace hybridtest
