#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/messages.hpp"
#include "runtime/network_profile.hpp"
#include "transport/fast_dds/fast_dds_settings.hpp"

namespace hybridtest {

/// Options of the command line for how participants find each other. They belong to the deployment and
/// not to the test.
class NetworkOptions {
 public:
  void add_to(CLI::App& app);
  /// @param participant   its id, which finds its host in the network profile.
  /// @throws ConfigError as read_network_profile() and settings_of().
  [[nodiscard]] fast_dds::FastDdsSettings settings(std::string_view participant = kOperatorId) const;
  /// For a tool that looks for a test wherever it may run: the network, if it is to be used, and this machine alone.
  [[nodiscard]] std::vector<fast_dds::FastDdsSettings> observer_paths() const;
  /// The same as arguments for a child process.
  [[nodiscard]] std::vector<std::string> arguments() const;
  /// Likewise for a host where the network profile has another name.
  [[nodiscard]] std::vector<std::string> arguments_but_profile() const;
  /// The network profile, where there is one. @throws ConfigError as read_network_profile().
  [[nodiscard]] std::optional<NetworkProfile> profile() const;

  /// Nothing was said about other hosts.
  [[nodiscard]] bool is_unspecified() const { return network_.empty() && !loopback_only_; }
  /// Folder of the credentials; empty without security.
  [[nodiscard]] const std::filesystem::path& credentials() const noexcept { return credentials_; }
  void set_credentials(const std::filesystem::path& folder) { credentials_ = folder; }
  void set_loopback_only(bool loopback_only) { loopback_only_ = loopback_only; }
  [[nodiscard]] const std::filesystem::path& network_file() const { return network_; }

 private:
  std::filesystem::path network_;
  std::optional<unsigned> domain_;
  bool loopback_only_ = false;
  int busy_poll_us_ = 0;
  std::vector<std::string> peers_;
  std::string discovery_server_;
  std::filesystem::path profile_;
  std::filesystem::path credentials_;
};

}  // namespace hybridtest
