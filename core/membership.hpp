#pragma once

#include "core/messages.hpp"
#include "core/node.hpp"
#include "core/ports.hpp"
#include "core/presence.hpp"

namespace hybridtest {

/// The ports of a substructure that takes part in a test, and its timeouts.
struct MembershipPorts {
  Inbox<TestAnnouncement>& announcements;
  Inbox<TestControl>& control;
  Duration discovery_timeout;  // without a coordinator for this time the participant leaves
  /// How long a running participant waits for the successor of a coordinator that is lost; 0: it ends the test.
  Duration resume_timeout{};
  /// The state of a test that is resumed was restored in this process: it joins that test and no new one.
  bool is_restored = false;
};

/// A request to a substructure from the coordinator, or from its loss.
enum class Request : std::uint8_t { none, arm, start, pause, resume, stop, emergency_stop };

/// A substructure's side of joining, arming, starting and leaving a test: agrees on the
/// scenario, binds to one coordinator, obeys no other, and notices its loss. While it waits for a successor of a lost
/// one, it accepts only who resumes the same test with the same scenario; it is then armed until that one starts it.
class Membership {
 public:
  Membership(Presence& presence, MembershipPorts ports) noexcept : presence_{presence}, ports_{ports} {}

  /// Call once per advance(), after Presence::advance(). @return at most one request; call
  /// again until `none`.
  [[nodiscard]] Request next_request(Instant now) noexcept;

  /// The coordinator whose commands are obeyed; 0 before one is found.
  [[nodiscard]] Incarnation coordinator() const noexcept { return coordinator_; }
  /// The coordinator was lost and another one took its place: it may ask for steps again that were imposed.
  [[nodiscard]] bool has_successor() const noexcept { return first_coordinator_ != coordinator_; }
  /// The reason of the last stop request.
  [[nodiscard]] StopReason stop_reason() const noexcept { return stop_reason_; }

 private:
  void look_for_coordinator(Instant now) noexcept;
  [[nodiscard]] bool may_join() const noexcept;
  [[nodiscard]] Request watch_coordinator(Instant now) noexcept;
  [[nodiscard]] Request await_successor(Instant now) noexcept;
  [[nodiscard]] Request give_up(Instant now) noexcept;
  [[nodiscard]] Request stop_for(StopReason reason) noexcept;

  Presence& presence_;
  MembershipPorts ports_;
  Incarnation coordinator_ = 0;
  Incarnation first_coordinator_ = 0;  // of the test; another one where it was resumed
  Incarnation successor_ = 0;          // announced; 0 without one
  Instant waits_since_{};
  bool coordinator_was_seen_ = false;
  std::uint64_t judged_ = 0;  // Presence::changes() at which the coordinator was there
  StopReason stop_reason_ = StopReason::none;
  TestAnnouncement announcement_;  // taken last; a member, because it is large
};

}  // namespace hybridtest
