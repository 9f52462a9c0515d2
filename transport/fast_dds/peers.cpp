#include "transport/fast_dds/peers.hpp"

#include <algorithm>

namespace hybridtest::fast_dds {
namespace {

bool took_leave(LifecycleState state) noexcept {
  return state == LifecycleState::finished || state == LifecycleState::refused;
}

bool can_move(LifecycleState state) noexcept {
  return state == LifecycleState::armed || state == LifecycleState::running || state == LifecycleState::stopping ||
         state == LifecycleState::waiting;
}

}  // namespace

Peers::Peers() { peers_.reserve(64); }

void Peers::heard(const GuidPrefix& prefix, const InstanceHandle& instance, const ParticipantStatus& status) {
  const std::lock_guard lock{mutex_};
  const auto known =
      std::find_if(peers_.begin(), peers_.end(), [&](const Peer& peer) { return peer.prefix == prefix; });
  if (known == peers_.end()) {
    peers_.push_back({prefix, instance, status});
  } else {
    known->last = status;
    known->reported = false;  // back after an outage
  }
}

std::optional<ParticipantStatus> Peers::gone(const GuidPrefix& prefix) {
  const std::lock_guard lock{mutex_};
  const auto known =
      std::find_if(peers_.begin(), peers_.end(), [&](const Peer& peer) { return peer.prefix == prefix; });
  if (known == peers_.end()) return std::nullopt;
  const std::optional<ParticipantStatus> loss = report(*known);
  peers_.erase(known);  // heard() adds it again if it returns
  return loss;
}

std::optional<ParticipantStatus> Peers::silent(const InstanceHandle& instance) {
  const std::lock_guard lock{mutex_};
  const auto known = std::find_if(peers_.begin(), peers_.end(),
                                  [&](const Peer& peer) { return peer.instance == instance && is_missed(peer); });
  return known == peers_.end() ? std::nullopt : report(*known);
}

bool Peers::is_missed(const Peer& peer) noexcept { return can_move(peer.last.state) && !peer.reported; }

std::optional<ParticipantStatus> Peers::report(Peer& peer) {
  if (peer.reported || took_leave(peer.last.state)) return std::nullopt;
  peer.reported = true;
  ParticipantStatus lost = peer.last;
  lost.state = LifecycleState::lost;
  return lost;
}

}  // namespace hybridtest::fast_dds
