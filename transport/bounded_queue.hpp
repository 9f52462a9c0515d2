#pragma once

#include <cstddef>
#include <mutex>
#include <vector>

#include "core/assert.hpp"

namespace hybridtest {

/// Queue with a limit between any number of threads; no allocation after construction.
///
/// A full queue refuses a new value, except by push_displacing().
template <class Value>
class BoundedQueue {
 public:
  /// @param capacity   at least 1.
  explicit BoundedQueue(std::size_t capacity) : slots_(capacity) { HYBRIDTEST_ASSERT(capacity >= 1); }

  /// @return false when full; the value is then lost.
  [[nodiscard]] bool push(const Value& value) noexcept {
    const std::lock_guard lock{mutex_};
    if (size_ == slots_.size()) return false;
    slots_[(first_ + size_) % slots_.size()] = value;
    ++size_;
    return true;
  }

  /// For a value that must not be refused: a full queue drops its oldest value.
  void push_displacing(const Value& value) noexcept {
    const std::lock_guard lock{mutex_};
    if (size_ == slots_.size()) {
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

 private:
  std::mutex mutex_;
  std::vector<Value> slots_;
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

}  // namespace hybridtest
