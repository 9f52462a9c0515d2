#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "core/messages.hpp"
#include "transport/fast_dds/dds_version.hpp"

namespace hybridtest::fast_dds {

/// The participants whose status was received; each must be reported when it is lost. Thread-safe.
class Peers {
 public:
  Peers();

  /// A status arrived from a participant, in an instance of the topic (one per id).
  void heard(const GuidPrefix& prefix, const InstanceHandle& instance, const ParticipantStatus& status);

  /// The participant left or its lease ran out.
  /// @return its last status with state `lost`, once, and only if it had not left properly.
  [[nodiscard]] std::optional<ParticipantStatus> gone(const GuidPrefix& prefix);

  /// No status arrived in the instance within the deadline. While nothing can move (a rig that takes
  /// long to connect), statuses may pause; then it is not a loss.
  [[nodiscard]] std::optional<ParticipantStatus> silent(const InstanceHandle& instance);

 private:
  struct Peer {
    GuidPrefix prefix;
    InstanceHandle instance;
    ParticipantStatus last;
    bool reported = false;
  };

  static std::optional<ParticipantStatus> report(Peer& peer);
  static bool is_missed(const Peer& peer) noexcept;

  std::mutex mutex_;
  std::vector<Peer> peers_;
};

}  // namespace hybridtest::fast_dds
