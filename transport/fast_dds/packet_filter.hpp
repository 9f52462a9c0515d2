#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

namespace hybridtest::fast_dds {

/// Which packets this participant hands to Fast DDS.
enum class Admission {
  /// All but those that Fast DDS 2.9 would be busy with for ever, or that end the process.
  plain,
  /// With credentials: what is encrypted, and the few packets by which participants find and authenticate each other.
  secured,
  /// As `secured`, but any packet of discovery: a discovery server speaks more of the protocol in plain text.
  secured_by_server,
};

/// How many packets were refused, and why. Counted by the threads that receive, read by any.
struct RefusedPackets {
  std::atomic<std::uint64_t> harmful{0};        // would keep Fast DDS busy for ever, or end the process
  std::atomic<std::uint64_t> in_plain_text{0};  // with credentials: neither encrypted nor needed to find each other
  // With credentials: an announcement or a message of the authentication with false lengths, or other contents than
  // those of its participant. While it is open which are its own, all of them but the first.
  std::atomic<std::uint64_t> announcements{0};
  // With credentials: that a participant has left. Fast DDS sends them for genuine participants, too.
  std::atomic<std::uint64_t> departures{0};
};

/// Looks at each packet before Fast DDS does, and keeps out those that no participant of a test sends.
///
/// Fast DDS 2.9 also takes in what is not encrypted when all should be: notices that a participant has left
/// (CVE-2023-50257), announcements of a known participant with other addresses, and announcements with wrong lengths
/// that make it ask for all memory (CVE-2025-62599, -62600, -62602, -62603).
/// With credentials no notice of leaving is admitted, because none is signed: statuses tell who has left.
/// RTPS 2.3 section 9.4, DDS Security 1.1 section 8.4.2.4. Packets of discovery by one thread at a time.
class PacketFilter {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Bytes = std::span<const std::uint8_t>;

  /// A participant repeats its announcement. One is believed that was heard so much more often than any other in the
  /// same name: who has no credentials can be the first, and send many, yet each other contents.
  static constexpr int kLead = 2;
  /// It is believed, and no other, until it has not been heard for this time.
  static constexpr std::chrono::seconds kSilence{10};
  /// Contents that are counted in one name, before counting begins again.
  static constexpr std::size_t kContentsMax = 1000;
  /// Participants whose announcements are compared with those before.
  static constexpr std::size_t kParticipantsMax = 1000;
  /// A range of messages that are not there, or that still are, has never been longer: 4 hours at 1 kHz.
  static constexpr std::uint64_t kRangeMax = std::uint64_t{1} << 24U;
  /// Messages of a writer are counted from 1, 1000 a second for 30 years.
  static constexpr std::uint64_t kSequenceMax = std::uint64_t{1} << 40U;
  /// The largest message of a test has 200 kB. Fast DDS sets aside as many bytes as a fragment of one says.
  static constexpr std::uint64_t kMessageMax = std::uint64_t{1} << 20U;

  /// @param refused   counts what is not admitted.
  explicit PacketFilter(Admission admission,
                        std::shared_ptr<RefusedPackets> refused = std::make_shared<RefusedPackets>())
      : admission_{admission}, refused_{std::move(refused)} {}

  /// @param packet   one datagram that arrived at the port of the messages of users.
  [[nodiscard]] bool admits_message(Bytes packet) const noexcept;
  /// @param packet   one datagram that arrived at a port of discovery, or one message that arrived where discovery and
  ///                 messages of users share a port, as over TCP: what is encrypted, it admits as well.
  [[nodiscard]] bool admits_discovery(Bytes packet, Time now);

 private:
  using Prefix = std::array<std::uint8_t, 12>;  // of the GUIDs of a participant
  /// In the name of one participant.
  struct Announcements {
    std::vector<std::uint8_t> believed;               // none yet when empty
    Time heard;                                       // that one, or any while there is none
    std::unordered_map<std::size_t, int> times = {};  // how often each was heard, by its hash, while there is none
  };
  enum class Belief { believed, unrepeated, contradicted };

  [[nodiscard]] Belief belief_in(const Prefix& prefix, Bytes announcement, Time now);

  const Admission admission_;
  const std::shared_ptr<RefusedPackets> refused_;
  std::map<Prefix, Announcements> announcements_;
};

}  // namespace hybridtest::fast_dds
