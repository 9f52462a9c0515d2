#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "transport/fast_dds/fast_dds_settings.hpp"

namespace hybridtest {

/// Options of the command line for how participants find each other. They belong to the deployment and
/// not to the test.
class NetworkOptions {
 public:
  void add_to(CLI::App& app);
  [[nodiscard]] fast_dds::FastDdsSettings settings() const;
  /// For a tool that looks for a test wherever it may run: the network, if it is to be used, and this machine alone.
  [[nodiscard]] std::vector<fast_dds::FastDdsSettings> observer_paths() const;
  /// The same as arguments for a child process.
  [[nodiscard]] std::vector<std::string> arguments() const;

  void set_loopback_only(bool loopback_only) { loopback_only_ = loopback_only; }

 private:
  unsigned domain_ = 0;
  bool loopback_only_ = false;
  int busy_poll_us_ = 0;
  std::vector<std::string> peers_;
  std::string discovery_server_;
  std::filesystem::path profile_;
};

}  // namespace hybridtest
