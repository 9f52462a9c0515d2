#pragma once

#include "core/messages.hpp"
#include "core/ports.hpp"

namespace hybridtest {

/// The coordinator that takes the place of a lost one.
inline constexpr Incarnation kSuccessor = 78;

/// Its first words: whose place it takes, of which test, and a status.
inline void announce_successor(Outbox<TestAnnouncement>& announcements, Outbox<ParticipantStatus>& statuses,
                               Incarnation succeeds, const ScenarioDigest& digest = {}) {
  TestAnnouncement announcement;
  announcement.coordinator = kSuccessor;
  announcement.succeeds = succeeds;
  announcement.scenario_digest = digest;
  announcements.send(announcement);
  ParticipantStatus status;
  status.id = "coordinator";
  status.role = Role::coordinator;
  status.incarnation = kSuccessor;
  statuses.send(status);
}

}  // namespace hybridtest
