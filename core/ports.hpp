#pragma once

namespace hybridtest {

/// Where a Node takes messages of one type from; oldest first.
template <class Message>
class Inbox {
 public:
  virtual ~Inbox() = default;

  /// @return false, leaving `message` alone, when nothing waits. Never blocks.
  [[nodiscard]] virtual bool take(Message& message) noexcept = 0;
};

/// Where a Node puts messages of one type.
template <class Message>
class Outbox {
 public:
  virtual ~Outbox() = default;

  /// Hands the message over; the message is copied before the call returns. Never blocks.
  /// @return false when it could not be accepted (queue full, transport closed).
  virtual bool send(const Message& message) noexcept = 0;
};

}  // namespace hybridtest
