#include "tests/realtime/forbidden_calls.hpp"

#include <dlfcn.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <pthread.h>
#include <semaphore.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <syslog.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <new>

// The functions below take the place of the C library's: a definition in the program comes before
// those of shared libraries, also for calls from within these. They count and go on to the
// original. The C library's calls to itself do not come by here (a formatted print takes its
// stream's lock unseen); that is why each family is caught at the functions that programs call,
// and why there is system_calls_of() besides.

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HYBRIDTEST_INTERPOSES 0
#else
#define HYBRIDTEST_INTERPOSES 1
#endif

namespace hybridtest {
namespace {

thread_local bool is_counting = false;
thread_local ForbiddenCalls counted;

}  // namespace

bool can_count_forbidden_calls() noexcept { return HYBRIDTEST_INTERPOSES == 1; }

ForbiddenCallCount::ForbiddenCallCount() noexcept {
  counted = {};
  is_counting = true;
}

ForbiddenCallCount::~ForbiddenCallCount() { is_counting = false; }

ForbiddenCalls ForbiddenCallCount::calls() const noexcept { return counted; }

namespace {

/// Which calls were tried, in memory shared with the parent.
struct TriedCalls {
  std::atomic<int> count;
  std::array<int, 64> numbers;
};
TriedCalls* tried = nullptr;

void note_call(int, siginfo_t* information, void*) {
  const int place = tried->count.fetch_add(1);
  if (place < static_cast<int>(tried->numbers.size())) {
    tried->numbers[static_cast<std::size_t>(place)] = information->si_syscall;
  }
}

/// From here on only the end of the process and the return from a signal pass.
bool turn_system_calls_away() {
  struct sigaction action {};
  action.sa_sigaction = note_call;
  action.sa_flags = SA_SIGINFO | SA_NODEFER;
  if (sigaction(SIGSYS, &action, nullptr) != 0) return false;
  std::array<sock_filter, 5> filter{{
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_exit_group, 2, 0),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_rt_sigreturn, 1, 0),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  }};
  const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

}  // namespace

std::optional<std::vector<int>> system_calls_of(void (*work)()) {
  constexpr int kDone = 0;
  constexpr int kUnable = 77;
  void* const shared = mmap(nullptr, sizeof(TriedCalls), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) return std::nullopt;
  tried = new (shared) TriedCalls{};
  const pid_t child = fork();
  if (child == 0) {
    if (!turn_system_calls_away()) _exit(kUnable);
    work();
    _exit(kDone);
  }
  int status = 0;
  const bool has_ended = child > 0 && waitpid(child, &status, 0) == child;
  std::optional<std::vector<int>> numbers;
  if (has_ended && !(WIFEXITED(status) && WEXITSTATUS(status) == kUnable)) {
    const int count = std::min(tried->count.load(), static_cast<int>(tried->numbers.size()));
    numbers.emplace(tried->numbers.begin(), tried->numbers.begin() + count);
    // A child that did not reach its end did something forbidden.
    if (!WIFEXITED(status) || WEXITSTATUS(status) != kDone) numbers->push_back(-1);
  }
  munmap(shared, sizeof(TriedCalls));
  return numbers;
}

namespace {

void count(int ForbiddenCalls::*kind) noexcept {
  if (is_counting) ++(counted.*kind);
}

/// The function of that name that would have been called.
template <class Function>
Function* original(const char* name) noexcept {
  // Looking a name up allocates and locks by itself.
  const bool was_counting = is_counting;
  is_counting = false;
  void* const address = dlsym(RTLD_NEXT, name);
  is_counting = was_counting;
  return reinterpret_cast<Function*>(address);
}

}  // namespace
}  // namespace hybridtest

#if HYBRIDTEST_INTERPOSES

using hybridtest::count;
using hybridtest::ForbiddenCalls;
using hybridtest::original;

extern "C" {

// The C library's own names: a lookup would itself allocate.
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t number, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* memory);

void* malloc(std::size_t size) {
  count(&ForbiddenCalls::allocations);
  return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) {
  count(&ForbiddenCalls::allocations);
  return __libc_calloc(number, size);
}
void* realloc(void* memory, std::size_t size) {
  count(&ForbiddenCalls::allocations);
  return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count(&ForbiddenCalls::allocations);
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  count(&ForbiddenCalls::allocations);
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}
void free(void* memory) {
  if (memory != nullptr) count(&ForbiddenCalls::allocations);  // of nothing it does nothing
  __libc_free(memory);
}

#define HYBRIDTEST_COUNTED(kind, result, name, parameters, arguments) \
  result name parameters {                                            \
    count(&ForbiddenCalls::kind);                                     \
    static const auto next = original<result parameters>(#name);      \
    return next arguments;                                            \
  }

HYBRIDTEST_COUNTED(locks, int, pthread_mutex_lock, (pthread_mutex_t * mutex), (mutex))
HYBRIDTEST_COUNTED(locks, int, pthread_mutex_trylock, (pthread_mutex_t * mutex), (mutex))
HYBRIDTEST_COUNTED(locks, int, pthread_rwlock_rdlock, (pthread_rwlock_t * lock), (lock))
HYBRIDTEST_COUNTED(locks, int, pthread_rwlock_wrlock, (pthread_rwlock_t * lock), (lock))
HYBRIDTEST_COUNTED(locks, int, pthread_spin_lock, (pthread_spinlock_t * lock), (lock))
HYBRIDTEST_COUNTED(locks, int, pthread_cond_wait, (pthread_cond_t * condition, pthread_mutex_t* mutex),
                   (condition, mutex))
HYBRIDTEST_COUNTED(locks, int, pthread_cond_signal, (pthread_cond_t * condition), (condition))
HYBRIDTEST_COUNTED(locks, int, pthread_cond_broadcast, (pthread_cond_t * condition), (condition))
HYBRIDTEST_COUNTED(locks, int, sem_wait, (sem_t * semaphore), (semaphore))
HYBRIDTEST_COUNTED(locks, int, sem_post, (sem_t * semaphore), (semaphore))

HYBRIDTEST_COUNTED(writes, ssize_t, write, (int file, const void* bytes, std::size_t size), (file, bytes, size))
HYBRIDTEST_COUNTED(writes, ssize_t, writev, (int file, const iovec* parts, int number), (file, parts, number))
HYBRIDTEST_COUNTED(writes, std::size_t, fwrite, (const void* bytes, std::size_t size, std::size_t number, FILE* file),
                   (bytes, size, number, file))
HYBRIDTEST_COUNTED(writes, int, fputs, (const char* text, FILE* file), (text, file))
HYBRIDTEST_COUNTED(writes, int, fputc, (int letter, FILE* file), (letter, file))
HYBRIDTEST_COUNTED(writes, int, puts, (const char* text), (text))
HYBRIDTEST_COUNTED(writes, int, putchar, (int letter), (letter))
HYBRIDTEST_COUNTED(writes, int, vfprintf, (FILE * file, const char* format, va_list arguments),
                   (file, format, arguments))
HYBRIDTEST_COUNTED(writes, void, vsyslog, (int priority, const char* format, va_list arguments),
                   (priority, format, arguments))

int fprintf(FILE* file, const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  const int written = vfprintf(file, format, arguments);
  va_end(arguments);
  return written;
}
int printf(const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  const int written = vfprintf(stdout, format, arguments);
  va_end(arguments);
  return written;
}
void syslog(int priority, const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  vsyslog(priority, format, arguments);
  va_end(arguments);
}

HYBRIDTEST_COUNTED(clocks, int, clock_gettime, (clockid_t clock, timespec* time), (clock, time))
HYBRIDTEST_COUNTED(clocks, time_t, time, (time_t * seconds), (seconds))
HYBRIDTEST_COUNTED(clocks, int, nanosleep, (const timespec* wanted, timespec* left), (wanted, left))
HYBRIDTEST_COUNTED(clocks, int, clock_nanosleep, (clockid_t clock, int flags, const timespec* wanted, timespec* left),
                   (clock, flags, wanted, left))

}  // extern "C"

#endif
