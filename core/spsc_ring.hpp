#pragma once

#include <atomic>
#include <cstddef>
#include <vector>

#include "core/assert.hpp"

namespace hybridtest {

/// Bounded queue between one producing and one consuming thread; lock-free, no allocation
/// after construction.
template <class Value>
class SpscRing {
 public:
  /// @param capacity   at least 1; slots held at most.
  explicit SpscRing(std::size_t capacity) : slots_(capacity + 1) { HYBRIDTEST_ASSERT(capacity >= 1); }

  /// Producer. @return false when full.
  [[nodiscard]] bool push(const Value& value) noexcept {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    const std::size_t next = after(head);
    if (next == tail_.load(std::memory_order_acquire)) return false;
    slots_[head] = value;
    head_.store(next, std::memory_order_release);
    return true;
  }

  /// Consumer. @return false, leaving `value` alone, when empty.
  [[nodiscard]] bool pop(Value& value) noexcept {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return false;
    value = slots_[tail];
    tail_.store(after(tail), std::memory_order_release);
    return true;
  }

 private:
  [[nodiscard]] std::size_t after(std::size_t index) const noexcept {
    return index + 1 == slots_.size() ? 0 : index + 1;
  }

  std::vector<Value> slots_;
  alignas(64) std::atomic<std::size_t> head_{0};
  alignas(64) std::atomic<std::size_t> tail_{0};
};

}  // namespace hybridtest
