#include "recording/row_ring.hpp"

#include <algorithm>

#include "core/assert.hpp"

namespace hybridtest {

RowRing::RowRing(std::size_t row_width, std::size_t capacity)
    : row_width_{row_width}, slots_{capacity + 1}, values_(row_width * (capacity + 1)) {
  HYBRIDTEST_ASSERT(row_width >= 1);
  HYBRIDTEST_ASSERT(capacity >= 1);
}

void RowRing::append(std::span<const double> row) noexcept {
  HYBRIDTEST_ASSERT(row.size() == row_width_);
  const std::size_t head = head_.load(std::memory_order_relaxed);
  const std::size_t next = after(head);
  if (next == tail_.load(std::memory_order_acquire)) {
    dropped_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  std::copy_n(row.data(), row_width_, values_.data() + head * row_width_);
  head_.store(next, std::memory_order_release);
}

std::size_t RowRing::take(std::span<double> rows) noexcept {
  const std::size_t room = rows.size() / row_width_;
  HYBRIDTEST_ASSERT(room >= 1);
  const std::size_t head = head_.load(std::memory_order_acquire);
  std::size_t tail = tail_.load(std::memory_order_relaxed);
  std::size_t taken = 0;
  while (taken < room && tail != head) {
    std::copy_n(values_.data() + tail * row_width_, row_width_, rows.data() + taken * row_width_);
    tail = after(tail);
    ++taken;
  }
  tail_.store(tail, std::memory_order_release);
  return taken;
}

std::size_t RowRing::size() const noexcept {
  const std::size_t tail = tail_.load(std::memory_order_acquire);
  const std::size_t head = head_.load(std::memory_order_acquire);
  return head >= tail ? head - tail : head + slots_ - tail;
}

}  // namespace hybridtest
