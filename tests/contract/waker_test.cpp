#include "transport/waker.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

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

// A lost signal would make both threads wait for ever.
TEST(Waker, LosesNoSignalBetweenTwoThreads) {
  constexpr int kRounds = 20000;
  Waker ping;
  Waker pong;
  int number = 0;  // written by one thread at a time: the signals must also order memory
  std::thread other{[&] {
    for (int i = 0; i < kRounds; ++i) {
      EXPECT_TRUE(ping.wait_until(kEndless));
      ++number;
      pong.signal();
    }
  }};
  for (int i = 0; i < kRounds; ++i) {
    ++number;
    ping.signal();
    ASSERT_TRUE(pong.wait_until(kEndless));
    ASSERT_EQ(number, 2 * (i + 1));
  }
  other.join();
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
