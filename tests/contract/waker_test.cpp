#include "transport/waker.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "tests/support/signals_in_turn.hpp"

namespace hybridtest {
namespace {

using Clock = std::chrono::steady_clock;
constexpr Clock::time_point kPast{};
constexpr Clock::time_point kEndless = Clock::time_point::max();

TEST(Waker, KeepsOneSignalForALaterWait) {
  Waker waker;
  waker.signal();
  waker.signal();
  EXPECT_TRUE(waker.wait_until(kPast));
  EXPECT_FALSE(waker.wait_until(kPast)) << "used up";
}

TEST(Waker, WaitEndsAtItsDeadline) {
  Waker waker;
  const Clock::time_point deadline = Clock::now() + std::chrono::milliseconds{20};
  EXPECT_FALSE(waker.wait_until(deadline));
  EXPECT_GE(Clock::now(), deadline);
}

TEST(Waker, SignalFromAnotherThreadEndsWait) {
  Waker waker;
  std::thread other{[&] { waker.signal(); }};
  EXPECT_TRUE(waker.wait_until(kEndless));
  other.join();
}

TEST(Waker, LosesNoSignalBetweenTwoThreads) {
  Waker ping;
  Waker pong;
  expect_signals_in_turn(ping, pong, 20000, [](Waker& waker) { return waker.wait_until(kEndless); });
}

// The last of several signals must be seen by a wait that begins after it was taken note of.
TEST(Waker, LosesNoSignalOfSeveralThreads) {
  constexpr int kEach = 5000;
  Waker waker;
  std::atomic<int> sent{0};
  const auto signal_often = [&] {
    for (int i = 0; i < kEach; ++i) {
      sent.fetch_add(1);
      waker.signal();
    }
  };
  std::thread first{signal_often};
  std::thread second{signal_often};
  while (sent < 2 * kEach) ASSERT_TRUE(waker.wait_until(kEndless));
  first.join();
  second.join();
}

}  // namespace
}  // namespace hybridtest
