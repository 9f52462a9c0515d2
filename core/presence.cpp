#include "core/presence.hpp"

#include <algorithm>
#include <bit>
#include <functional>
#include <string_view>

namespace hybridtest {
namespace {

[[nodiscard]] bool has_left(LifecycleState state) noexcept {
  return state == LifecycleState::finished || state == LifecycleState::refused || state == LifecycleState::lost;
}

/// Participants whose clocks differ by less count as started together.
constexpr Duration kStartedTogether = std::chrono::milliseconds{200};
/// Longer than the round trip of a status.
constexpr Duration kOnItsWay = std::chrono::milliseconds{50};
/// After a status that the transport did not take.
constexpr Duration kTellAgain = std::chrono::milliseconds{10};

[[nodiscard]] bool may_still_leave(LifecycleState state) noexcept {
  return state == LifecycleState::joining || state == LifecycleState::ready;
}

}  // namespace

Presence::Presence(const Identity& identity, Duration lease, Inbox<ParticipantStatus>& inbox,
                   Outbox<ParticipantStatus>& outbox, Outbox<Event>& events, std::size_t peers_at_most)
    : identity_{identity},
      lease_{lease},
      inbox_{inbox},
      outbox_{outbox},
      events_{events},
      places_(std::bit_ceil(2 * peers_at_most)) {
  peers_.reserve(peers_at_most);
  own_.id = identity.id;
  own_.role = identity.role;
  own_.incarnation = identity.incarnation;
  own_.scenario_digest = identity.scenario_digest;
}

Instant Presence::advance(Instant now) noexcept {
  bool has_heard = false;
  for (; inbox_.take(heard_); has_heard = true) learn(heard_, now);
  // Leases begin anew with a status and end at the time that was found: in between there is nothing to look at.
  if (has_heard || now >= next_lease_) check_leases(now);
  return tell(now);
}

Instant Presence::tell(Instant now) noexcept {
  if (status_changed_ || now >= next_heartbeat_) {
    own_.clock = now.time_since_epoch();
    const bool is_told = outbox_.send(own_);
    status_changed_ = !is_told;
    next_heartbeat_ = now + (is_told ? lease_ / 4 : std::min(kTellAgain, lease_ / 4));
  }
  return std::min(next_lease_, next_heartbeat_);
}

void Presence::check_leases(Instant now) noexcept {
  next_lease_ = kNever;
  for (Peer& peer : peers_) {
    if (has_left(peer.status.state)) continue;
    if (now - peer.last_seen >= lost_after_) {
      peer.status.state = LifecycleState::lost;
      ++changes_;
    } else {
      next_lease_ = std::min(next_lease_, peer.last_seen + lost_after_);
    }
  }
}

void Presence::set_state(LifecycleState state) noexcept {
  if (state == own_.state || has_left(own_.state)) return;
  own_.state = state;
  status_changed_ = true;
}

void Presence::raise(FaultFlags faults) noexcept {
  if ((own_.faults | faults) == own_.faults) return;
  own_.faults |= faults;
  status_changed_ = true;
  ++changes_;
}

std::size_t Presence::place_of(const ParticipantId& id) const noexcept {
  std::size_t place = std::hash<std::string_view>{}(id.view());
  for (;; ++place) {
    place &= places_.size() - 1;
    if (places_[place] == 0 || peers_[places_[place] - 1U].status.id == id) return place;
  }
}

const Peer* Presence::find(const ParticipantId& id) const noexcept {
  const std::uint16_t position = places_[place_of(id)];
  return position == 0 ? nullptr : &peers_[position - 1U];
}

bool Presence::is_alive(Incarnation incarnation) const noexcept {
  return std::ranges::any_of(peers_, [incarnation](const Peer& peer) {
    return peer.status.incarnation == incarnation && !has_left(peer.status.state);
  });
}

bool Presence::is_silent(const Peer& peer, Instant now) const noexcept {
  return !has_left(peer.status.state) && now - peer.last_seen >= lease_;
}

void Presence::report(Instant now, Severity severity, EventCode code, const ParticipantId& subject,
                      std::array<double, 2> values, Step step, double model_time_s) noexcept {
  Event event;
  event.source = identity_.id;
  event.incarnation = identity_.incarnation;
  event.severity = severity;
  event.code = code;
  event.step = step;
  event.model_time_s = model_time_s;
  event.subject = subject;
  event.values = values;
  event.clock = now.time_since_epoch();
  events_.send(event);
}

void Presence::learn(const ParticipantStatus& status, Instant now) noexcept {
  if (status.incarnation == identity_.incarnation) return;
  if (status.id == identity_.id) {
    judge_duplicate(status, now);
    return;
  }
  std::uint16_t& position = places_[place_of(status.id)];
  if (position == 0) {
    if (peers_.size() == peers_.capacity()) return;
    peers_.push_back(Peer{status, now});
    position = static_cast<std::uint16_t>(peers_.size());
    ++changes_;
    return;
  }
  Peer* const place = &peers_[position - 1U];
  const bool is_other_process = place->status.incarnation != status.incarnation;
  if (is_other_process) {
    // The known participant stays until it has left: a younger one with the same id must not replace
    // it, and the loss of another incarnation says nothing about it.
    if (!has_left(place->status.state) || has_left(status.state)) return;
  } else if (has_left(place->status.state) && place->status.state != LifecycleState::lost) {
    return;  // a late or repeated status of a participant that has left
  } else if (status.clock < place->status.clock && status.state != LifecycleState::lost) {
    return;  // an older status that arrived late: keep the newer state and faults
  }
  // A transport reports a loss with the last status it knows; an answered step stays answered.
  const Step last_step = is_other_process ? status.last_step : std::max(place->status.last_step, status.last_step);
  const ParticipantStatus& known = place->status;
  if (is_other_process || status.state != known.state || status.faults != known.faults) ++changes_;
  *place = Peer{status, now};
  place->status.last_step = last_step;
}

void Presence::judge_duplicate(const ParticipantStatus& other, Instant now) noexcept {
  if (has_left(other.state)) return;
  // The travel time of a status makes its sender look younger. Two participants that started together
  // would each take the other for the younger one and both stay; then the incarnation decides. The
  // margin makes sure that both see the tie when one does.
  const Duration older_by = other.clock - now.time_since_epoch();
  const bool started_together = older_by >= -(kStartedTogether + kOnItsWay) && older_by <= kStartedTogether;
  const bool other_is_older =
      started_together ? other.incarnation < identity_.incarnation : older_by > Duration::zero();
  // An armed participant does not leave for a newcomer; only the newcomer can leave.
  if (may_still_leave(own_.state) && (other_is_older || !may_still_leave(other.state))) is_duplicate_ = true;
  if (!duplicate_reported_) {
    duplicate_reported_ = true;
    report(now, Severity::warning, EventCode::duplicate_id, identity_.id);
  }
}

}  // namespace hybridtest
