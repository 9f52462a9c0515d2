#pragma once

#include <gtest/gtest.h>

#include <thread>

#include "transport/waker.hpp"

namespace hybridtest {

/// Two threads that wake each other in turn. A lost signal would make both wait for ever.
/// @param await   waits for the signal of a waker, for ever, and says whether it came.
template <class Await>
void expect_signals_in_turn(Waker& ping, Waker& pong, int rounds, const Await& await) {
  int number = 0;  // written by one thread at a time: the signals must also order memory
  std::thread other{[&] {
    for (int i = 0; i < rounds; ++i) {
      EXPECT_TRUE(await(ping));
      ++number;
      pong.signal();
    }
  }};
  for (int i = 0; i < rounds; ++i) {
    ++number;
    ping.signal();
    EXPECT_TRUE(await(pong));
    EXPECT_EQ(number, 2 * (i + 1));
  }
  other.join();
}

}  // namespace hybridtest
