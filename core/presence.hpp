#pragma once

#include <array>
#include <span>

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
  /// @param lease   a peer that sends nothing for this time is lost; heartbeats are sent four times per lease.
  Presence(const Identity& identity, Duration lease, Inbox<ParticipantStatus>& inbox, Outbox<ParticipantStatus>& outbox,
           Outbox<Event>& events) noexcept;

  /// Takes the statuses that wait, marks peers whose lease ran out as lost, sends the own status
  /// when it changed or is due. @return when the next heartbeat or lease is due.
  Instant advance(Instant now) noexcept;

  /// Sends the own status at the next advance(); a state once `refused` or `finished` stays.
  void set_state(LifecycleState state) noexcept;
  void set_last_step(Step step) noexcept { own_.last_step = step; }
  void raise(FaultFlags faults) noexcept;

  /// Everyone else ever heard of.
  [[nodiscard]] std::span<const Peer> peers() const noexcept { return std::span{peers_}.first(peer_count_); }
  [[nodiscard]] const ParticipantStatus& own_status() const noexcept { return own_; }
  [[nodiscard]] LifecycleState state() const noexcept { return own_.state; }
  [[nodiscard]] FaultFlags faults() const noexcept { return own_.faults; }
  [[nodiscard]] const Identity& identity() const noexcept { return identity_; }
  /// An older participant with this id is in the partition; this one must leave.
  [[nodiscard]] bool is_duplicate() const noexcept { return is_duplicate_; }

  /// The peer with this id, nullptr when never heard of.
  [[nodiscard]] const Peer* find(const ParticipantId& id) const noexcept;
  /// Whether exactly this incarnation was seen and has not been lost.
  [[nodiscard]] bool is_alive(Incarnation incarnation) const noexcept;

  /// Sends an event in this participant's name.
  void report(Instant now, Severity severity, EventCode code, const ParticipantId& subject = {},
              std::array<double, 2> values = {}, Step step = kNoStep, double model_time_s = 0.0) noexcept;

 private:
  void learn(const ParticipantStatus& status, Instant now) noexcept;
  void check_leases(Instant now) noexcept;
  void judge_duplicate(const ParticipantStatus& other, Instant now) noexcept;

  Identity identity_;
  Duration lease_;
  Inbox<ParticipantStatus>& inbox_;
  Outbox<ParticipantStatus>& outbox_;
  Outbox<Event>& events_;
  ParticipantStatus own_;
  bool status_changed_ = true;
  bool is_duplicate_ = false;
  bool duplicate_reported_ = false;
  Instant next_heartbeat_{};
  Instant next_lease_ = kNever;  // of those that are there
  std::array<Peer, kMaxSubstructures + 8> peers_{};
  std::size_t peer_count_ = 0;
};

}  // namespace hybridtest
