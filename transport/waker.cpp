#include "transport/waker.hpp"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <ctime>

namespace hybridtest {
namespace {

constexpr std::uint32_t kIdle = 0;
constexpr std::uint32_t kSignalled = 1;
constexpr std::uint32_t kWaiting = 2;

// steady_clock of libstdc++ on Linux is CLOCK_MONOTONIC, the clock FUTEX_WAIT_BITSET measures with.
timespec to_timespec(std::chrono::steady_clock::time_point deadline) noexcept {
  using std::chrono::duration_cast;
  using std::chrono::nanoseconds;
  using std::chrono::seconds;
  const nanoseconds since_boot = std::max(duration_cast<nanoseconds>(deadline.time_since_epoch()), nanoseconds{0});
  const seconds whole = duration_cast<seconds>(since_boot);
  timespec result{};
  result.tv_sec = static_cast<time_t>(whole.count());
  result.tv_nsec = static_cast<long>((since_boot - whole).count());
  return result;
}

// False only when the deadline passed. In all other cases (woken, state changed, interrupted) the
// caller checks the state again.
bool sleep_while(std::atomic<std::uint32_t>& state, std::uint32_t value, const timespec* deadline) noexcept {
  const long result = ::syscall(SYS_futex, reinterpret_cast<std::uint32_t*>(&state), FUTEX_WAIT_BITSET_PRIVATE, value,
                                deadline, nullptr, FUTEX_BITSET_MATCH_ANY);
  return result == 0 || errno != ETIMEDOUT;
}

}  // namespace

void Waker::signal() noexcept {
  if (state_.exchange(kSignalled, std::memory_order_acq_rel) != kWaiting) return;
  const int saved_errno = errno;
  if (reception_ != nullptr) {
    reception_->interrupt();
  } else {
    ::syscall(SYS_futex, reinterpret_cast<std::uint32_t*>(&state_), FUTEX_WAKE_PRIVATE, 1, nullptr, nullptr, 0);
  }
  errno = saved_errno;
}

bool Waker::wait_until(std::chrono::steady_clock::time_point deadline) noexcept {
  const bool endless = deadline == std::chrono::steady_clock::time_point::max();
  const timespec until = endless ? timespec{} : to_timespec(deadline);
  bool in_time = true;
  while (true) {
    std::uint32_t expected = kIdle;
    if (!state_.compare_exchange_strong(expected, kWaiting, std::memory_order_acq_rel)) {
      // Whoever is always signalled must receive as well.
      if (reception_ != nullptr) reception_->receive();
      // Signalled before. Read and written in one operation, so that the caller sees the data of a
      // signal that arrives at this moment.
      state_.exchange(kIdle, std::memory_order_acq_rel);
      return true;
    }
    if (in_time) {
      in_time = reception_ != nullptr ? reception_->await(deadline)
                                      : sleep_while(state_, kWaiting, endless ? nullptr : &until);
    }
    if (state_.exchange(kIdle, std::memory_order_acq_rel) == kSignalled) return true;
    if (reception_ != nullptr) {
      // This thread does not wait now: the signal of a message that it receives itself wakes nobody.
      reception_->receive();
      if (state_.exchange(kIdle, std::memory_order_acq_rel) == kSignalled) return true;
    }
    if (!in_time) return false;
  }
}

}  // namespace hybridtest
