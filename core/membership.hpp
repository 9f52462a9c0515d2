#pragma once

#include "core/messages.hpp"
#include "core/node.hpp"
#include "core/ports.hpp"
#include "core/presence.hpp"

namespace hybridtest {

/// The ports of a substructure that takes part in a test, and its timeout.
struct MembershipPorts {
  Inbox<TestAnnouncement>& announcements;
  Inbox<TestControl>& control;
  Duration discovery_timeout;  // without a coordinator for this time the participant leaves
};

/// A request to a substructure from the coordinator, or from its loss.
enum class Request : std::uint8_t { none, arm, start, pause, resume, stop, emergency_stop };

/// A substructure's side of joining, arming, starting and leaving a test: agrees on the
/// scenario, binds to one coordinator, obeys no other, and notices its loss.
class Membership {
 public:
  Membership(Presence& presence, MembershipPorts ports) noexcept : presence_{presence}, ports_{ports} {}

  /// Call once per advance(), after Presence::advance(). @return at most one request; call
  /// again until `none`.
  [[nodiscard]] Request next_request(Instant now) noexcept;

  /// The coordinator whose commands are obeyed; 0 before one is found.
  [[nodiscard]] Incarnation coordinator() const noexcept { return coordinator_; }
  /// The reason of the last stop request.
  [[nodiscard]] StopReason stop_reason() const noexcept { return stop_reason_; }

 private:
  void look_for_coordinator(Instant now) noexcept;
  [[nodiscard]] Request stop_for(StopReason reason) noexcept;

  Presence& presence_;
  MembershipPorts ports_;
  Incarnation coordinator_ = 0;
  bool coordinator_was_seen_ = false;
  StopReason stop_reason_ = StopReason::none;
  TestAnnouncement announcement_;  // taken last; a member, because it is large
};

}  // namespace hybridtest
