#include "tests/realtime/forbidden_calls.hpp"

#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <string>
#include <thread>
#include <vector>

#include <Eigen/Core>

/// Controls: the guards of the control path detect forbidden calls.
namespace hybridtest {
namespace {

class ForbiddenCallsTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!can_count_forbidden_calls()) GTEST_SKIP() << "a sanitizer has these functions for itself";
  }
};

/// Keeps the compiler from removing unused results.
template <class Value>
void keep(const Value& value) {
  asm volatile("" : : "g"(&value) : "memory");
}

TEST_F(ForbiddenCallsTest, CountsNothingInAnEmptyScope) {
  double sum = 0.0;
  const ForbiddenCallCount count;
  for (int i = 0; i < 1000; ++i) sum += i;
  keep(sum);
  EXPECT_EQ(count.calls(), ForbiddenCalls{});
}

TEST_F(ForbiddenCallsTest, CountsNothingOutsideTheScope) {
  ForbiddenCalls calls;
  {
    const ForbiddenCallCount count;
    calls = count.calls();
  }
  keep(std::make_unique<double>(1.0));
  EXPECT_EQ(calls, ForbiddenCalls{});
}

TEST_F(ForbiddenCallsTest, CountsEveryKindOfAllocation) {
  const auto allocations = [](auto&& work) {
    const ForbiddenCallCount count;
    work();
    return count.calls().allocations;
  };
  EXPECT_GE(allocations([] { keep(std::make_unique<double>(1.0)); }), 1);
  EXPECT_GE(allocations([] { keep(std::vector<double>(100)); }), 1);
  EXPECT_GE(allocations([] { keep(std::string(100, 'x')); }), 1);
  EXPECT_GE(allocations([] { keep(Eigen::VectorXd{Eigen::VectorXd::Zero(100)}); }), 1);
  EXPECT_GE(allocations([] {
              struct alignas(128) Wide {
                double values[16];
              };
              keep(std::make_unique<Wide>());
            }),
            1);
  EXPECT_GE(allocations([] {
              void* memory = std::calloc(10, 10);
              keep(memory);
              std::free(memory);
            }),
            2);
  std::vector<double> given(100);
  EXPECT_GE(allocations([&] { std::vector<double>{}.swap(given); }), 1) << "giving back is seen as well";
}

TEST_F(ForbiddenCallsTest, CountsEveryLock) {
  const auto locks = [](auto&& work) {
    const ForbiddenCallCount count;
    work();
    return count.calls().locks;
  };
  std::mutex mutex;
  std::shared_mutex shared;
  std::condition_variable condition;
  EXPECT_EQ(locks([&] { const std::lock_guard lock{mutex}; }), 1);
  EXPECT_EQ(locks([&] {
              if (mutex.try_lock()) mutex.unlock();
            }),
            1);
  EXPECT_EQ(locks([&] { const std::shared_lock lock{shared}; }), 1);
  EXPECT_EQ(locks([&] { const std::unique_lock lock{shared}; }), 1);
  EXPECT_EQ(locks([&] { condition.notify_all(); }), 1);
}

TEST_F(ForbiddenCallsTest, CountsEveryLogLine) {
  const std::unique_ptr<FILE, int (*)(FILE*)> nowhere{std::fopen("/dev/null", "w"), std::fclose};
  ASSERT_TRUE(nowhere);
  const auto writes = [](auto&& work) {
    const ForbiddenCallCount count;
    work();
    return count.calls().writes;
  };
  EXPECT_GE(writes([&] { std::fprintf(nowhere.get(), "%d of %s\n", 1, "two"); }), 1);
  EXPECT_GE(writes([&] { std::fputs("two", nowhere.get()); }), 1);
  EXPECT_GE(writes([&] { std::fwrite("two", 1, 3, nowhere.get()); }), 1);
  EXPECT_GE(writes([] { std::clog << "\n" << std::flush; }), 1);
  EXPECT_GE(writes([&] { EXPECT_EQ(::write(fileno(nowhere.get()), "x", 1), 1); }), 1);
}

TEST_F(ForbiddenCallsTest, CountsEveryClockRead) {
  const ForbiddenCallCount count;
  keep(std::chrono::steady_clock::now());
  keep(std::chrono::system_clock::now());
  EXPECT_EQ(count.calls().clocks, 2);
  std::this_thread::sleep_for(std::chrono::nanoseconds{1});
  EXPECT_GE(count.calls().clocks, 3);
}

TEST(SystemCalls, AreDetectedFromAnyLibrary) {
  const auto none = system_calls_of([] {});
  if (!none) GTEST_SKIP() << "this kernel does not let a process turn away its own system calls";
  EXPECT_TRUE(none->empty());
  const auto one = system_calls_of([] { static_cast<void>(::write(1, "x", 1)); });
  ASSERT_TRUE(one);
  EXPECT_EQ(*one, (std::vector<int>{SYS_write}));
  const auto stdio = system_calls_of([] {
    std::setvbuf(stdout, nullptr, _IONBF, 0);
    std::puts("x");
  });
  ASSERT_TRUE(stdio);
  EXPECT_NE(std::ranges::find(*stdio, SYS_write), stdio->end()) << "also from within the C library";
  const auto memory = system_calls_of([] { keep(std::vector<char>(64U << 20U)); });
  ASSERT_TRUE(memory);
  EXPECT_FALSE(memory->empty());
  const auto sleep = system_calls_of([] { std::this_thread::sleep_for(std::chrono::nanoseconds{1}); });
  ASSERT_TRUE(sleep);
  EXPECT_NE(std::ranges::find(*sleep, SYS_clock_nanosleep), sleep->end());
}

}  // namespace
}  // namespace hybridtest
