#include "validation/studies/parallel_runs.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace hybridtest {

void run_in_parallel(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& run) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto work = [&] {
    for (std::size_t index = next++; index < count; index = next++) {
      try {
        run(index);
      } catch (...) {
        const std::scoped_lock lock{failure_mutex};
        if (!failure) failure = std::current_exception();
        next = count;
      }
    }
  };
  {
    std::vector<std::jthread> workers;
    for (unsigned i = 1; i < std::min<std::size_t>(threads, count); ++i) workers.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
}

unsigned usable_threads() { return std::max(1U, std::thread::hardware_concurrency()); }

}  // namespace hybridtest
