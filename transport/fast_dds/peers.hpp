#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "core/messages.hpp"
#include "transport/fast_dds/dds_version.hpp"

namespace hybridtest::fast_dds {

/// Who was heard on participant_status and must be reported when gone. Thread-safe.
class Peers {
 public:
  Peers();

  /// A status arrived from a participant, in an instance of the topic (one per id).
  void heard(const GuidPrefix& prefix, const InstanceHandle& instance, const ParticipantStatus& status);

  /// The participant left or its lease ran out.
  /// @return its last status with state `lost`, the first time and unless it took its leave.
  [[nodiscard]] std::optional<ParticipantStatus> gone(const GuidPrefix& prefix);

  /// No status came in the instance within the deadline. Statuses may rightly pause while
  /// nothing can move (a rig that takes its time to connect): then it is no loss.
  [[nodiscard]] std::optional<ParticipantStatus> silent(const InstanceHandle& instance);

 private:
  struct Peer {
    GuidPrefix prefix;
    InstanceHandle instance;
    ParticipantStatus last;
    bool reported = false;
  };

  static std::optional<ParticipantStatus> report(Peer& peer);

  std::mutex mutex_;
  std::vector<Peer> peers_;
};

}  // namespace hybridtest::fast_dds
