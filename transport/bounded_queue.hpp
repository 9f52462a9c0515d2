#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

#include "core/assert.hpp"

namespace hybridtest {

/// Queue with a limit between any number of threads; no allocation after construction.
///
/// Queued values stay: a new value that does not fit is dropped and counted (but see
/// push_displacing()).
template <class Value>
class BoundedQueue {
 public:
  /// @param capacity   at least 1.
  explicit BoundedQueue(std::size_t capacity) : slots_(capacity) { HYBRIDTEST_ASSERT(capacity >= 1); }

  /// @return false when full; the value is dropped and counted.
  [[nodiscard]] bool push(const Value& value) noexcept {
    const std::lock_guard lock{mutex_};
    if (size_ == slots_.size()) {
      ++turned_away_;
      return false;
    }
    slots_[(first_ + size_) % slots_.size()] = value;
    ++size_;
    return true;
  }

  /// For values that must not be dropped: when full, the oldest value is dropped and counted.
  void push_displacing(const Value& value) noexcept {
    const std::lock_guard lock{mutex_};
    if (size_ == slots_.size()) {
      ++turned_away_;
      first_ = (first_ + 1) % slots_.size();
      --size_;
    }
    slots_[(first_ + size_) % slots_.size()] = value;
    ++size_;
  }

  /// Oldest first. @return false, leaving `value` alone, when empty.
  [[nodiscard]] bool pop(Value& value) noexcept {
    const std::lock_guard lock{mutex_};
    if (size_ == 0) return false;
    value = slots_[first_];
    first_ = (first_ + 1) % slots_.size();
    --size_;
    return true;
  }

  [[nodiscard]] std::size_t capacity() const noexcept { return slots_.size(); }

  [[nodiscard]] std::uint64_t turned_away() const noexcept {
    const std::lock_guard lock{mutex_};
    return turned_away_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<Value> slots_;
  std::size_t first_ = 0;
  std::size_t size_ = 0;
  std::uint64_t turned_away_ = 0;
};

}  // namespace hybridtest
