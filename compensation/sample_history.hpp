#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace hybridtest {

/// The last samples of a signal. Before as many have been pushed as it holds, the older ones read
/// as the first: a signal is taken to have stood still before it was known.
class SampleHistory {
 public:
  /// @param capacity   at least 1.
  explicit SampleHistory(std::size_t capacity) : samples_(capacity, 0.0) {}

  void push(double value) noexcept {
    if (!is_filled_) {
      std::fill(samples_.begin(), samples_.end(), value);
      is_filled_ = true;
    }
    newest_ = newest_ == 0 ? samples_.size() - 1 : newest_ - 1;
    samples_[newest_] = value;
  }

  /// @param age   in samples, 0 is the newest; below capacity.
  [[nodiscard]] double operator[](std::size_t age) const noexcept {
    const std::size_t place = newest_ + age;
    return samples_[place < samples_.size() ? place : place - samples_.size()];
  }

  [[nodiscard]] std::size_t capacity() const noexcept { return samples_.size(); }

  void clear() noexcept {
    std::fill(samples_.begin(), samples_.end(), 0.0);
    newest_ = 0;
    is_filled_ = false;
  }

 private:
  std::vector<double> samples_;
  std::size_t newest_ = 0;
  bool is_filled_ = false;
};

}  // namespace hybridtest
