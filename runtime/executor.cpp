#include "runtime/executor.hpp"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <thread>

namespace hybridtest {
namespace {

/// End a process by default, without a core dump but for SIGQUIT and SIGXCPU.
constexpr std::array kStopSignals{SIGHUP,  SIGINT,    SIGQUIT, SIGTERM, SIGUSR1, SIGUSR2,  SIGALRM,
                                  SIGPROF, SIGVTALRM, SIGPOLL, SIGPWR,  SIGXCPU, SIGSTKFLT};

std::atomic<int> first_stop_signal{0};
std::atomic<Waker*> waker_to_signal{nullptr};

extern "C" void request_stop(int signal) {
  int none = 0;
  first_stop_signal.compare_exchange_strong(none, signal);
  if (Waker* waker = waker_to_signal.load()) waker->signal();
}

}  // namespace

double ProcessClock::zero_unix_s() const noexcept {
  // Two clocks cannot be read at once. The best of a few attempts: the thread may lose its processor in between.
  constexpr int kAttempts = 8;
  auto shortest = std::chrono::steady_clock::duration::max();
  double zero_s = 0.0;
  for (int i = 0; i < kAttempts; ++i) {
    const auto before = std::chrono::steady_clock::now();
    const auto wall_time = std::chrono::system_clock::now().time_since_epoch();
    const auto took = std::chrono::steady_clock::now() - before;
    if (took >= shortest) continue;
    shortest = took;
    zero_s = std::chrono::duration<double>(wall_time - (before + took / 2 - start_)).count();
  }
  return zero_s;
}

void run_until(Node& node, Waker& waker, const ProcessClock& clock, const std::function<bool()>& is_done,
               const std::function<void(Instant)>& between) {
  while (true) {
    const Instant now = clock.now();
    const Instant wake = node.advance(now);
    between(now);
    if (is_done()) return;
    static_cast<void>(waker.wait_until(clock.deadline(wake)));  // also when it is due: the wait receives
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

void catch_stop_signals() {
  struct sigaction action {};
  action.sa_handler = request_stop;
  sigemptyset(&action.sa_mask);
  for (const int signal : kStopSignals) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
  action.sa_handler = SIG_IGN;
  sigaction(SIGPIPE, &action, nullptr);
  sigaction(SIGXFSZ, &action, nullptr);
}

void wake_on_stop(Waker& waker) noexcept { waker_to_signal.store(&waker); }

bool stop_was_requested() noexcept { return first_stop_signal.load() != 0; }

std::string stop_signal() {
  const int signal = first_stop_signal.load();
  return signal == 0 ? "" : std::string{"SIG"} + sigabbrev_np(signal);
}

}  // namespace hybridtest
