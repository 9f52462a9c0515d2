#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>

namespace hybridtest {

/// Threads that all fits of a diagnosis share. Work is divided among those that have nothing to do at the moment, also
/// work within other work: where one long fit is left at the end, the others take part in it. Copies share the threads.
class Workers {
 public:
  /// The calling thread alone.
  Workers() = default;
  /// @param threads   the calling one among them; none counts as one.
  explicit Workers(std::size_t threads);

  /// Runs `work(i)` for every i below `count`, and returns when all are done. Where each i writes to its own place, the
  /// result does not depend on the number of threads.
  /// @throws what the first i throws that throws anything; the others are run nevertheless.
  void for_each(std::size_t count, const std::function<void(std::size_t)>& work) const;

 private:
  std::shared_ptr<std::atomic<std::ptrdiff_t>> idle_;  // null: no others
};

}  // namespace hybridtest
