#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>

#include "transport/in_process/hub.hpp"

namespace hybridtest {

/// Partition of this test in this run, so that tests which run at the same time do not meet.
inline std::string unique_test_name(const char* qualifier = "") {
  const ::testing::TestInfo& info = *::testing::UnitTest::GetInstance()->current_test_info();
  // A test name has at most 64 characters.
  std::string name = std::string{info.name()}.substr(0, 40) + qualifier + "." + std::to_string(::getpid());
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

/// Transport between the threads of one process.
struct InProcessNetwork {
  in_process::Hub hub;
  std::unique_ptr<Transport> join(const std::string& test_name) { return hub.join(test_name); }
};

/// Waits until `condition()` holds, looking again whenever the participant is signalled.
/// @return false after a long time, which only a fault explains.
template <class Condition>
[[nodiscard]] bool eventually(Transport& participant, Condition condition) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point give_up = Clock::now() + std::chrono::seconds{30};
  while (!condition()) {
    if (Clock::now() > give_up) return false;
    // Also looks without a signal: some conditions depend on other participants.
    static_cast<void>(participant.waker().wait_until(Clock::now() + std::chrono::milliseconds{20}));
  }
  return true;
}

}  // namespace hybridtest
