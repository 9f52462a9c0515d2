#include "runtime/executor.hpp"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <thread>

namespace hybridtest {
namespace {

std::atomic<bool> stop_requested{false};
std::atomic<Waker*> waker_to_signal{nullptr};

extern "C" void request_stop(int) {
  stop_requested.store(true);
  if (Waker* waker = waker_to_signal.load()) waker->signal();
}

}  // namespace

void run_until(Node& node, Waker& waker, const ProcessClock& clock, const std::function<bool()>& is_done,
               const std::function<void(Instant)>& between) {
  while (true) {
    const Instant now = clock.now();
    const Instant wake = node.advance(now);
    between(now);
    if (is_done()) return;
    if (wake > now) static_cast<void>(waker.wait_until(clock.deadline(wake)));
  }
}

void rest_until(const ProcessClock& clock, Instant instant) noexcept {
  // steady_clock of libstdc++ on Linux is CLOCK_MONOTONIC.
  const auto since_boot =
      std::chrono::duration_cast<std::chrono::nanoseconds>(clock.deadline(instant).time_since_epoch());
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(since_boot);
  const timespec deadline{static_cast<time_t>(seconds.count()), static_cast<long>((since_boot - seconds).count())};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr) == EINTR) {
  }
}

void wait_while(const std::function<bool()>& condition) {
  while (condition()) std::this_thread::sleep_for(std::chrono::milliseconds{1});
}

void stop_on_signals(Waker& waker) {
  waker_to_signal.store(&waker);
  struct sigaction action {};
  action.sa_handler = request_stop;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool stop_was_requested() noexcept { return stop_requested.load(); }

}  // namespace hybridtest
