#include "core/assert.hpp"

#include <atomic>
#include <cstdio>
#include <cstdlib>

namespace hybridtest {
namespace {

std::atomic<AssertAction> assert_action{nullptr};
std::atomic<void*> assert_context{nullptr};

}  // namespace

void set_assert_action(AssertAction action, void* context) noexcept {
  assert_context.store(context);
  assert_action.store(action);
}

void assertion_failed(const char* condition, const char* file, int line) noexcept {
  if (const AssertAction action = assert_action.exchange(nullptr)) action(assert_context.load());
  std::fprintf(stderr, "%s:%d: internal error, please report it: %s is false\n", file, line, condition);
  std::abort();
}

}  // namespace hybridtest
