#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "core/messages.hpp"
#include "core/ports.hpp"
#include "core/time.hpp"

namespace hybridtest {

/// Who a participant is, fixed for the life of its process.
struct Identity {
  ParticipantId id;
  Role role = Role::numerical_substructure;
  Incarnation incarnation = 0;
  ScenarioDigest scenario_digest{};
};

/// What a participant knows about another one.
struct Peer {
  ParticipantStatus status;
  Instant last_seen{};
};

/// A participant's own status and what it knows of the others: heartbeats, leases, and the rule
/// that of two participants with one id the younger leaves; of two that started together, the
/// one with the higher incarnation.
///
/// The clock of a participant starts at its start, so that the `clock` in a status tells its age.
class Presence {
 public:
  /// @param lease           a peer that sends nothing for this time is lost; heartbeats are sent four times per lease.
  /// @param peers_at_most   more are not taken note of.
  Presence(const Identity& identity, Duration lease, Inbox<ParticipantStatus>& inbox, Outbox<ParticipantStatus>& outbox,
           Outbox<Event>& events, std::size_t peers_at_most = kMaxSubstructures + kOthers);

  /// Besides the substructures: operators who look on, and second participants with one id.
  static constexpr std::size_t kOthers = 8;

  /// How long a silent peer is waited for before it is lost: its link may be down. Without effect below the lease.
  void wait_for_links(Duration patience) noexcept { lost_after_ = std::max(lease_, patience); }

  /// Takes the statuses that wait, marks peers whose lease ran out as lost, sends the own status
  /// when it changed or is due. @return when the next heartbeat or lease is due.
  Instant advance(Instant now) noexcept;
  /// Sends the own status when it changed or is due. Nothing may wake this participant for a quarter of a lease:
  /// whoever changes the state after advance() calls this before the next sleep. What the transport does not take is
  /// sent again soon. @return as advance().
  Instant tell(Instant now) noexcept;

  /// Sends the own status at the next advance() or tell(); a state once `refused` or `finished` stays.
  void set_state(LifecycleState state) noexcept;
  void set_last_step(Step step) noexcept { own_.last_step = step; }
  void raise(FaultFlags faults) noexcept;

  /// Everyone else ever heard of.
  [[nodiscard]] std::span<const Peer> peers() const noexcept { return peers_; }
  [[nodiscard]] const ParticipantStatus& own_status() const noexcept { return own_; }
  [[nodiscard]] LifecycleState state() const noexcept { return own_.state; }
  [[nodiscard]] FaultFlags faults() const noexcept { return own_.faults; }
  [[nodiscard]] const Identity& identity() const noexcept { return identity_; }
  /// An older participant with this id is in the partition; this one must leave.
  [[nodiscard]] bool is_duplicate() const noexcept { return is_duplicate_; }

  /// The peer with this id, nullptr when never heard of.
  [[nodiscard]] const Peer* find(const ParticipantId& id) const noexcept;
  /// Changes whenever the process, the state or the faults of another participant have changed, or the own faults: who
  /// has looked at all of it need not look again before. A heartbeat that says the same again is no change.
  [[nodiscard]] std::uint64_t changes() const noexcept { return changes_; }
  /// Whether exactly this incarnation was seen and has not been lost.
  [[nodiscard]] bool is_alive(Incarnation incarnation) const noexcept;

  /// Whether the peer is waited for: there, but silent for longer than the lease.
  [[nodiscard]] bool is_silent(const Peer& peer, Instant now) const noexcept;
  /// How long it is waited for.
  [[nodiscard]] Duration silence_most() const noexcept { return lost_after_; }

  /// Sends an event in this participant's name.
  void report(Instant now, Severity severity, EventCode code, const ParticipantId& subject = {},
              std::array<double, 2> values = {}, Step step = kNoStep, double model_time_s = 0.0) noexcept;

 private:
  void learn(const ParticipantStatus& status, Instant now) noexcept;
  void check_leases(Instant now) noexcept;
  /// Where this id is, or would be, in `places_`.
  [[nodiscard]] std::size_t place_of(const ParticipantId& id) const noexcept;
  void judge_duplicate(const ParticipantStatus& other, Instant now) noexcept;

  Identity identity_;
  Duration lease_;
  Duration lost_after_ = lease_;
  Inbox<ParticipantStatus>& inbox_;
  Outbox<ParticipantStatus>& outbox_;
  Outbox<Event>& events_;
  ParticipantStatus own_;
  ParticipantStatus heard_;  // taken last; a member, because it is large
  std::uint64_t changes_ = 1;
  bool status_changed_ = true;
  bool is_duplicate_ = false;
  bool duplicate_reported_ = false;
  Instant next_heartbeat_{};
  Instant next_lease_ = kNever;  // of those that are there
  std::vector<Peer> peers_;      // in the order of hearing; has memory for all from the start
  /// Positions in `peers_` from 1, by a hash of the id; 0 is free. A power of two, at least half of it free.
  std::vector<std::uint16_t> places_;
};

}  // namespace hybridtest
