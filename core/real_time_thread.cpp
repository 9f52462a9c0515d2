#include "core/real_time_thread.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <array>
#include <cerrno>
#include <cstddef>

namespace hybridtest {
namespace {

/// The control path needs a few kilobytes; this is far more, and far less than a thread has.
constexpr std::size_t kTouchedStack = std::size_t{256} << 10U;
constexpr std::size_t kPage = 4096;

[[gnu::noinline]] void touch_stack() noexcept {
  std::array<std::byte, kTouchedStack> stack;
  for (std::size_t i = 0; i < stack.size(); i += kPage) static_cast<volatile std::byte&>(stack[i]) = std::byte{1};
}

/// Locks pages that are in use, and later pages when they are first used. Locking everything at once
/// would also load the stacks of threads outside the control path.
int lock_memory() noexcept { return mlockall(MCL_CURRENT | MCL_ONFAULT) == 0 ? 0 : errno; }

int stay_on(int cpu) noexcept {
  if (cpu < 0 || cpu >= CPU_SETSIZE) return EINVAL;
  cpu_set_t cpus;
  CPU_ZERO(&cpus);
  CPU_SET(static_cast<unsigned>(cpu), &cpus);
  return pthread_setaffinity_np(pthread_self(), sizeof cpus, &cpus);
}

}  // namespace

RealTimeGrant enter_real_time(const RealTimeRequest& request) noexcept {
  RealTimeGrant grant;
  touch_stack();
  grant.memory_error = lock_memory();
  if (request.cpu) grant.affinity_error = stay_on(*request.cpu);
  const sched_param parameters{.sched_priority = request.priority};
  grant.scheduling_error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  // The timers of ordinary threads are rounded to 50 us; this switches the rounding off if SCHED_FIFO was refused.
  static_cast<void>(prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL));
  return grant;
}

InheritedRealTime::InheritedRealTime(int priority) noexcept {
  sched_param before{};
  if (pthread_getschedparam(pthread_self(), &policy_before_, &before) != 0) return;
  priority_before_ = before.sched_priority;
  const sched_param wanted{.sched_priority = priority};
  is_changed_ = pthread_setschedparam(pthread_self(), SCHED_FIFO, &wanted) == 0;
}

InheritedRealTime::~InheritedRealTime() {
  if (!is_changed_) return;
  const sched_param before{.sched_priority = priority_before_};
  static_cast<void>(pthread_setschedparam(pthread_self(), policy_before_, &before));
}

}  // namespace hybridtest
