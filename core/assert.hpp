#pragma once

namespace hybridtest {

/// Called by a failed HYBRIDTEST_ASSERT before the process aborts. A site sets it to
/// stop_motion() of its rig. Thread-safe; must not return into the failed code's invariants.
using AssertAction = void (*)(void* context) noexcept;
void set_assert_action(AssertAction action, void* context) noexcept;

[[noreturn]] void assertion_failed(const char* condition, const char* file, int line) noexcept;

}  // namespace hybridtest

/// For programming errors; always on. Never for input or for faults in operation.
#define HYBRIDTEST_ASSERT(condition) \
  ((condition) ? static_cast<void>(0) : ::hybridtest::assertion_failed(#condition, __FILE__, __LINE__))
