#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "transport/fast_dds/fast_dds_transport.hpp"

namespace hybridtest {

/// Its UDP ports lie in 29150 … 29400, below the range that systems hand out by themselves.
inline constexpr std::uint32_t kTestDomain = 87;
inline constexpr Duration kTestLease = std::chrono::milliseconds{600};

inline fast_dds::FastDdsSettings test_settings() {
  fast_dds::FastDdsSettings settings;
  settings.domain = kTestDomain;
  settings.loopback_only = true;
  settings.loopback_participants = 200;  // one process makes many, one after another
  settings.lease = kTestLease;
  settings.heartbeat_deadline = kTestLease;
  return settings;
}

// Fast DDS over both of its local transports.

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

/// Commands and measurements are not sent again.
struct FastDdsBestEffortNetwork {
  static std::unique_ptr<Transport> join(const std::string& test_name) {
    fast_dds::FastDdsSettings settings = test_settings();
    settings.best_effort_coupling = true;
    return fast_dds::make_fast_dds_transport(settings, test_name);
  }
};

}  // namespace hybridtest
