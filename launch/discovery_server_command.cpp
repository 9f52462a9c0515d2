#include <fmt/format.h>

#include <optional>

#include "core/config_error.hpp"
#include "core/exit_code.hpp"
#include "launch/commands.hpp"
#include "runtime/executor.hpp"
#include "runtime/network_profile.hpp"
#include "transport/fast_dds/discovery_server.hpp"

namespace hybridtest {
namespace {

struct ServerOptions {
  std::filesystem::path network_file;
  std::uint16_t port = 11811;
};

int serve(const ServerOptions& options) {
  catch_stop_signals();
  std::uint16_t port = options.port;
  std::optional<std::string> interface_address;
  if (!options.network_file.empty()) {
    const NetworkProfile profile = read_network_profile(options.network_file);
    if (profile.type != NetworkType::discovery_server) {
      throw ConfigError{options.network_file.string() + ": expected a profile of type discovery_server"};
    }
    port = profile.server.listens->first;
    interface_address = profile.server.interface_address;
  }
  const fast_dds::DiscoveryServer server{port, interface_address};
  fmt::print("discovery server at UDP port {}; Ctrl-C ends it\n", port);
  std::fflush(stdout);
  wait_while([] { return !stop_was_requested(); });
  return kExitCompleted;
}

}  // namespace

void add_discovery_server_command(CLI::App& app, CommandAction& action) {
  auto options = std::make_shared<ServerOptions>();
  CLI::App* command = app.add_subcommand(
      "discovery-server", "Introduce participants to each other where multicast does not reach; runs until Ctrl-C");
  auto* network =
      command->add_option("--network", options->network_file, "Network profile (YAML) of type discovery_server")
          ->check(CLI::ExistingFile);
  command->add_option("--port", options->port, "UDP port")->capture_default_str()->excludes(network);
  command->callback([options, &action] { action = [options] { return serve(*options); }; });
}

}  // namespace hybridtest
