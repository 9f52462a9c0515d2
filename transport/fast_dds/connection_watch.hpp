#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include "core/time.hpp"
#include "transport/fast_dds/dds_version.hpp"

namespace hybridtest::fast_dds {

/// Cuts the TCP connections of this process over which nothing comes, so that Fast DDS makes them again.
///
/// Fast DDS 2.9 asks at the other end for a connection, and notes only then that it waits for the answer. On a busy
/// machine another thread may have read the answer before: the connection then stays in waiting for ever, and nothing
/// is sent through it.
class ConnectionWatch {
 public:
  /// @param patience   how long a new connection may be silent; twice as long after each that was cut. Participants
  ///                   announce themselves every half second.
  explicit ConnectionWatch(Duration patience = std::chrono::seconds{5});
  ~ConnectionWatch();
  ConnectionWatch(const ConnectionWatch&) = delete;
  ConnectionWatch& operator=(const ConnectionWatch&) = delete;

  /// Connections to this address and port that are made from now on are watched.
  void expect(const Locator& remote);

 private:
  using Time = std::chrono::steady_clock::time_point;

  struct Connection {
    Time since;               // when it was first seen
    std::uint64_t bytes = 0;  // that had come by the last look
    bool is_left_alone = false;
  };
  struct Remote {
    Locator locator;
    Duration patience;
    std::map<std::uint16_t, Connection> connections{};  // by own port
  };

  void run();
  static void look(Remote& remote, Time now);

  const Duration patience_;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool has_ended_ = false;
  std::vector<Remote> remotes_;
  std::thread thread_;  // the last member: it uses the others
};

}  // namespace hybridtest::fast_dds
