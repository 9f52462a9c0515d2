#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/records.hpp"

namespace hybridtest {

/// Bounded queue of table rows between one control or network thread and the recorder.
///
/// One producer, one consumer, lock-free, no allocation after construction. A row that finds the
/// ring full is counted and dropped: the producer must not wait for a disk.
class RowRing final : public RowSink {
 public:
  /// @param row_width   values per row, at least 1.
  /// @param capacity    largest number of rows, at least 1; the rows of a pause of the disk must
  ///                    fit (at 4 kHz, two seconds are 8000 rows).
  RowRing(std::size_t row_width, std::size_t capacity);

  /// Producer. @param row   exactly `row_width` values.
  void append(std::span<const double> row) noexcept override;

  /// Consumer. Moves the oldest rows out, row after row.
  /// @param rows   room for at least one row.
  /// @return rows moved; 0 when empty.
  [[nodiscard]] std::size_t take(std::span<double> rows) noexcept;

  [[nodiscard]] std::size_t row_width() const noexcept { return row_width_; }
  [[nodiscard]] std::size_t capacity() const noexcept { return slots_ - 1; }
  /// Any thread; rows waiting, at the moment of the call.
  [[nodiscard]] std::size_t size() const noexcept;
  /// Any thread; rows dropped since construction.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  [[nodiscard]] std::size_t after(std::size_t slot) const noexcept { return slot + 1 == slots_ ? 0 : slot + 1; }

  std::size_t row_width_;
  std::size_t slots_;  // one more than the capacity, to tell full from empty
  std::vector<double> values_;
  alignas(64) std::atomic<std::size_t> head_{0};
  alignas(64) std::atomic<std::size_t> tail_{0};
  alignas(64) std::atomic<std::uint64_t> dropped_{0};
};

}  // namespace hybridtest
