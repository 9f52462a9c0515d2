#include "runtime/crash_report.hpp"

#include <execinfo.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <string_view>

namespace hybridtest {
namespace {

constexpr int kCallsMax = 18;  // `hybridtest run` shows 20 lines of a log
constexpr std::array kFaults{SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT};

void write_text(std::string_view text) noexcept {
  static_cast<void>(!::write(STDERR_FILENO, text.data(), text.size()));
}

// Only what may be called in the handler of a signal. The system has put back what it does by itself, and does it when
// this returns and the signal comes again.
void on_fault(int signal) {
  write_text("crashed; the calls that led there, the last one first:\n");
  std::array<void*, kCallsMax> calls{};
  ::backtrace_symbols_fd(calls.data(), ::backtrace(calls.data(), kCallsMax), STDERR_FILENO);
  ::raise(signal);
}

}  // namespace

void report_crashes() noexcept {
  // Loads what the handler needs: loading allocates.
  std::array<void*, 1> call{};
  static_cast<void>(::backtrace(call.data(), 1));
  for (const int fault : kFaults) {
    struct sigaction present {};
    if (::sigaction(fault, nullptr, &present) != 0 || present.sa_handler != SIG_DFL) continue;
    struct sigaction action {};
    action.sa_handler = on_fault;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    ::sigaction(fault, &action, nullptr);
  }
}

}  // namespace hybridtest
