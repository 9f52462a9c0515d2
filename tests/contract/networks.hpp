#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "transport/fast_dds/fast_dds_transport.hpp"
#include "transport/in_process/hub.hpp"

namespace hybridtest {

/// Its UDP ports lie in 29150 … 29400, below the range that systems hand out by themselves.
inline constexpr std::uint32_t kTestDomain = 87;
inline constexpr Duration kTestLease = std::chrono::milliseconds{600};

/// Partition of this test in this run, so that tests which run at the same time do not meet.
inline std::string unique_test_name(const char* qualifier = "") {
  const ::testing::TestInfo& info = *::testing::UnitTest::GetInstance()->current_test_info();
  // A test name has at most 64 characters.
  std::string name = std::string{info.name()}.substr(0, 40) + qualifier + "." + std::to_string(::getpid());
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

inline fast_dds::FastDdsSettings test_settings() {
  fast_dds::FastDdsSettings settings;
  settings.domain = kTestDomain;
  settings.loopback_only = true;
  settings.loopback_participants = 200;  // one process makes many, one after another
  settings.lease = kTestLease;
  settings.heartbeat_deadline = kTestLease;
  return settings;
}

// The transports that the contract holds for.

struct InProcessNetwork {
  in_process::Hub hub;
  std::unique_ptr<Transport> join(const std::string& test_name) { return hub.join(test_name); }
};

struct FastDdsUdpNetwork {
  static std::unique_ptr<Transport> join(const std::string& test_name) {
    return fast_dds::make_fast_dds_transport(test_settings(), test_name);
  }
};

struct FastDdsSharedMemoryNetwork {
  static std::unique_ptr<Transport> join(const std::string& test_name) {
    fast_dds::FastDdsSettings settings = test_settings();
    settings.shared_memory = true;
    return fast_dds::make_fast_dds_transport(settings, test_name);
  }
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
