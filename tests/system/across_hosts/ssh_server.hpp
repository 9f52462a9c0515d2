#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "tests/support/started_program.hpp"

namespace hybridtest {

/// A real OpenSSH server of this user on the loopback device, with keys, port and configuration of its own. It and what
/// it started are gone with this object.
///
/// The configuration for clients names four hosts: `lab` is let in; `nobody_there` is a port on which nobody listens;
/// `wrong_key` has a key that the server does not know; `unknown_host` has never been seen before;
/// `changed_host` had another key.
class SshServer {
 public:
  /// @param directory   for all its files; of this test alone.
  explicit SshServer(const std::filesystem::path& directory);

  /// Why nobody is let in here; empty when the server works.
  [[nodiscard]] const std::string& why_not() const noexcept { return why_not_; }
  /// A folder with `ssh` and `scp`: those of the system, with the configuration of this server.
  [[nodiscard]] std::filesystem::path programs() const { return directory_ / "bin"; }
  /// Ends every connection as a broken line does: nobody says farewell.
  void cut_connections() const;

 private:
  void make_keys();
  void write_configurations(int port) const;
  void start();

  std::filesystem::path directory_;
  std::string why_not_;
  std::optional<StartedProgram> server_;
};

}  // namespace hybridtest
