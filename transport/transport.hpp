#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "core/messages.hpp"
#include "core/ports.hpp"
#include "transport/waker.hpp"

namespace hybridtest {

/// Largest number of messages that wait in one inbox; further messages are dropped and counted.
/// Sized so that a thread which is late by a whole second of a fast test still loses nothing
/// that the protocol does not repeat.
template <class Message>
inline constexpr std::size_t kInboxCapacity = 64;
template <>
inline constexpr std::size_t kInboxCapacity<ForceMeasurement> = 256;
template <>
inline constexpr std::size_t kInboxCapacity<ParticipantStatus> = 256;
template <>
inline constexpr std::size_t kInboxCapacity<Event> = 1024;

/// What went wrong in the network layer since the transport was made.
struct TransportCounters {
  std::uint64_t overflowed = 0;        // dropped because an inbox of this participant was full
  std::uint64_t malformed = 0;         // dropped because the bytes were not a valid message
  std::uint64_t unsent = 0;            // send() returned false
  std::uint64_t deadlines_missed = 0;  // heartbeats of participants that came late
  // Packets that were refused before they were read (docs/security.md):
  std::uint64_t refused_harmful = 0;        // would hang or end the process
  std::uint64_t refused_in_plain_text = 0;  // with credentials: neither encrypted nor needed to find each other
  std::uint64_t refused_announcements = 0;  // with credentials: false, or in the name of another participant
  std::uint64_t refused_departures = 0;     // with credentials: that a participant has left; genuine ones, too
};

/// The connection of one participant to the test: makes the ports of its Node.
///
/// - Messages travel inside one test (partition) and never back to the participant that sent them.
/// - The order of one sender's messages is kept. send() never blocks.
/// - The newest announcement and status of each sender are kept for participants that join later.
/// - When a participant leaves without the status `finished` or `refused`, every status inbox of
///   the others yields its last status once more with state `lost`: when it leaves, or when its
///   liveliness lease runs out. In a full inbox a loss displaces the oldest status.
/// - Anything that arrives signals waker().
///
/// Ports may be made and destroyed at any time; each is used by one thread at a time. Methods
/// that make ports throw std::runtime_error when the network layer refuses.
class Transport {
 public:
  virtual ~Transport() = default;

  /// The waker that the thread of the participant waits on.
  [[nodiscard]] virtual Waker& waker() noexcept = 0;

  [[nodiscard]] virtual std::unique_ptr<Outbox<TestAnnouncement>> announcement_outbox() = 0;
  [[nodiscard]] virtual std::unique_ptr<Inbox<TestAnnouncement>> announcement_inbox() = 0;

  [[nodiscard]] virtual std::unique_ptr<Outbox<ParticipantStatus>> status_outbox() = 0;
  [[nodiscard]] virtual std::unique_ptr<Inbox<ParticipantStatus>> status_inbox() = 0;

  /// To substructures 0 .. count - 1; a command for another is not accepted.
  [[nodiscard]] virtual std::unique_ptr<Outbox<DisplacementCommand>> command_outbox(
      std::uint16_t substructure_count) = 0;
  /// Only commands for this substructure.
  [[nodiscard]] virtual std::unique_ptr<Inbox<DisplacementCommand>> command_inbox(SubstructureIndex substructure) = 0;

  /// Only measurements of this substructure.
  [[nodiscard]] virtual std::unique_ptr<Outbox<ForceMeasurement>> measurement_outbox(
      SubstructureIndex substructure) = 0;
  /// Measurements of substructures 0 .. count - 1.
  [[nodiscard]] virtual std::unique_ptr<Inbox<ForceMeasurement>> measurement_inbox(
      std::uint16_t substructure_count) = 0;

  [[nodiscard]] virtual std::unique_ptr<Outbox<TestControl>> control_outbox() = 0;
  [[nodiscard]] virtual std::unique_ptr<Inbox<TestControl>> control_inbox() = 0;

  [[nodiscard]] virtual std::unique_ptr<Outbox<Event>> event_outbox() = 0;
  [[nodiscard]] virtual std::unique_ptr<Inbox<Event>> event_inbox() = 0;

  /// Best effort: blocks may be lost without notice.
  [[nodiscard]] virtual std::unique_ptr<Outbox<SignalBlock>> signal_outbox() = 0;
  [[nodiscard]] virtual std::unique_ptr<Inbox<SignalBlock>> signal_inbox() = 0;

  /// True when one and the same other participant holds the opposite ports for the commands and the measurements of
  /// this substructure, as far as this end knows. When both ends know it, what is sent arrives. Either end may ask. A
  /// change signals waker().
  [[nodiscard]] virtual bool reachable(SubstructureIndex substructure) const noexcept = 0;

  [[nodiscard]] virtual TransportCounters counters() const noexcept = 0;
};

}  // namespace hybridtest
