#pragma once

#include "core/time.hpp"

namespace hybridtest {

/// A state machine that receives the time: a coordinator, a substructure, a control loop.
///
/// A Node takes its messages from Inboxes and sends through Outboxes; it never reads a clock,
/// opens a socket, sleeps, logs or throws. So the same object runs on threads over DDS, in one
/// process under a simulated clock, and inside a replay.
class Node {
 public:
  virtual ~Node() = default;

  /// Does all work due at `now` without blocking.
  /// @param now   never earlier than in the call before.
  /// @return when the Node next wants to run if no message arrives before; kNever if only a
  ///         message can give it work. Calling earlier is harmless.
  [[nodiscard]] virtual Instant advance(Instant now) noexcept = 0;
};

}  // namespace hybridtest
