#include "tests/support/malloc_count.hpp"

#include <atomic>
#include <cstddef>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)

std::size_t hybridtest::malloc_count() noexcept { return 0; }
bool hybridtest::counts_mallocs() noexcept { return false; }

#else

// The C library's own names behind the ones that a program may replace.
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* __libc_calloc(std::size_t count, std::size_t size);
extern "C" void* __libc_realloc(void* memory, std::size_t size);

namespace {

std::atomic<std::size_t> calls{0};

}  // namespace

extern "C" void* malloc(std::size_t size) {
  calls.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(size);
}

extern "C" void* calloc(std::size_t count, std::size_t size) {
  calls.fetch_add(1, std::memory_order_relaxed);
  return __libc_calloc(count, size);
}

extern "C" void* realloc(void* memory, std::size_t size) {
  calls.fetch_add(1, std::memory_order_relaxed);
  return __libc_realloc(memory, size);
}

std::size_t hybridtest::malloc_count() noexcept { return calls.load(std::memory_order_relaxed); }
bool hybridtest::counts_mallocs() noexcept { return true; }

#endif
