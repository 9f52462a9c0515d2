#pragma once

#include <sys/types.h>
#include <string>
#include <vector>

namespace hybridtest::benchmarks {

/// Processes started from this program's own file; killed when this goes or the parent dies.
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
