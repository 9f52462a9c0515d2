#include "diagnosis/workers.hpp"

#include <exception>
#include <thread>
#include <vector>

namespace hybridtest {

Workers::Workers(std::size_t threads) {
  if (threads > 1) idle_ = std::make_shared<std::atomic<std::ptrdiff_t>>(static_cast<std::ptrdiff_t>(threads) - 1);
}

namespace {

/// Takes one of the idle threads, if there is one.
bool take_one(std::atomic<std::ptrdiff_t>& idle) {
  std::ptrdiff_t count = idle;
  while (count > 0) {
    if (idle.compare_exchange_weak(count, count - 1)) return true;
  }
  return false;
}

}  // namespace

void Workers::for_each(std::size_t count, const std::function<void(std::size_t)>& work) const {
  if (!idle_ || count < 2) {
    for (std::size_t i = 0; i < count; ++i) work(i);
    return;
  }
  std::vector<std::exception_ptr> thrown(count);
  std::atomic<std::size_t> next = 0;
  const auto run_next = [&] {
    const std::size_t i = next++;
    if (i >= count) return false;
    try {
      work(i);
    } catch (...) {
      thrown[i] = std::current_exception();
    }
    return true;
  };
  {
    std::vector<std::jthread> others;
    do {
      while (next + 1 < count && take_one(*idle_)) {
        others.emplace_back([&] {
          while (run_next()) continue;
          ++*idle_;
        });
      }
    } while (run_next());
    // While it waits for the others this thread has nothing to do either: one more may help them.
    ++*idle_;
  }
  --*idle_;
  for (const std::exception_ptr& exception : thrown) {
    if (exception) std::rethrow_exception(exception);
  }
}

}  // namespace hybridtest
