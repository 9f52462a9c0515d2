#pragma once

#include <cstddef>

#include "core/ports.hpp"
#include "core/spsc_ring.hpp"

namespace hybridtest {

/// A lock-free queue with an Outbox at one end and an Inbox at the other, between two nodes on
/// one thread or on two.
template <class Message>
class RingPort final : public Inbox<Message>, public Outbox<Message> {
 public:
  explicit RingPort(std::size_t capacity) : ring_{capacity} {}

  [[nodiscard]] bool take(Message& message) noexcept override { return ring_.pop(message); }
  bool send(const Message& message) noexcept override { return ring_.push(message); }

 private:
  SpscRing<Message> ring_;
};

}  // namespace hybridtest
