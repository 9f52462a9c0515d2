#pragma once

#include <algorithm>
#include <mutex>
#include <vector>

#include "transport/fast_dds/dds_version.hpp"

namespace hybridtest::fast_dds {

/// The participants at the other ends of one port. Thread-safe.
class Matches {
 public:
  void change(const GuidPrefix& participant, int count_change) {
    const std::lock_guard lock{mutex_};
    if (count_change > 0) {
      participants_.push_back(participant);
    } else {
      const auto found = std::find(participants_.begin(), participants_.end(), participant);
      if (found != participants_.end()) participants_.erase(found);
    }
  }

  void clear() noexcept {
    const std::lock_guard lock{mutex_};
    participants_.clear();
  }

  [[nodiscard]] bool has(const GuidPrefix& participant) const noexcept {
    const std::lock_guard lock{mutex_};
    return std::find(participants_.begin(), participants_.end(), participant) != participants_.end();
  }

  /// Whether some participant is at the other end of both ports.
  [[nodiscard]] bool share_participant(const Matches& other) const noexcept {
    const std::scoped_lock lock{mutex_, other.mutex_};
    return std::any_of(participants_.begin(), participants_.end(), [&](const GuidPrefix& participant) {
      return std::find(other.participants_.begin(), other.participants_.end(), participant) !=
             other.participants_.end();
    });
  }

 private:
  mutable std::mutex mutex_;
  std::vector<GuidPrefix> participants_;
};

}  // namespace hybridtest::fast_dds
