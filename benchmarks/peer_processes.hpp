#pragma once

#include <sys/types.h>
#include <string>
#include <vector>

namespace hybridtest::benchmarks {

/// Processes started from the file of this program; killed when this object or the parent ends.
class PeerProcesses {
 public:
  PeerProcesses() = default;
  ~PeerProcesses();
  PeerProcesses(const PeerProcesses&) = delete;
  PeerProcesses& operator=(const PeerProcesses&) = delete;

  /// @throws std::runtime_error when the process cannot be started.
  void start(const std::vector<std::string>& arguments);

 private:
  std::vector<pid_t> processes_;
};

}  // namespace hybridtest::benchmarks
