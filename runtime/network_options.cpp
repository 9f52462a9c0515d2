#include "runtime/network_options.hpp"

namespace hybridtest {

void NetworkOptions::add_to(CLI::App& app) {
  app.add_option("--network", network_, "Network profile (YAML): who listens where, the same file on every host")
      ->check(CLI::ExistingFile)
      ->group("Network");
  app.add_option("--domain", domain_, "DDS domain; participants of one test use the same")
      ->check(CLI::Range(0, 232))
      ->default_str("0")
      ->group("Network");
  app.add_option("--peer", peers_, "host[:port] of another participant where multicast does not reach; repeatable")
      ->group("Network");
  app.add_option("--discovery-server", discovery_server_, "host:port of a Fast DDS discovery server")->group("Network");
  app.add_option("--profile", profile_, "Fast DDS XML profiles; the participant profile 'hybridtest' is used")
      ->check(CLI::ExistingFile)
      ->group("Network");
  app.add_option("--credentials", credentials_,
                 "Folder of the credentials of this participant: only participants of the same test are heard, and "
                 "everything is encrypted")
      ->check(CLI::ExistingDirectory)
      ->group("Network");
  app.add_option("--busy-poll-us", busy_poll_us_,
                 "Look at the socket for so long before sleeping; shorter steps, for processors of their own")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str()
      ->group("Network");
  app.add_flag("--loopback-only", loopback_only_, "Talk on this machine only")->group("Network");
}

std::optional<NetworkProfile> NetworkOptions::profile() const {
  if (network_.empty()) return std::nullopt;
  NetworkProfile profile = read_network_profile(network_);
  if (domain_) move_to_domain(profile, *domain_);
  return profile;
}

fast_dds::FastDdsSettings NetworkOptions::settings(std::string_view participant) const {
  fast_dds::FastDdsSettings settings;
  if (const auto read = profile()) {
    settings = settings_of(*read, participant);
  } else if (domain_) {
    settings.domain = *domain_;
  }
  if (loopback_only_) {
    settings.loopback_only = true;
    settings.tcp.reset();
  }
  settings.initial_peers.insert(settings.initial_peers.end(), peers_.begin(), peers_.end());
  settings.busy_poll = std::chrono::microseconds{busy_poll_us_};
  if (!discovery_server_.empty()) settings.discovery_server = discovery_server_;
  if (!profile_.empty()) settings.profile_file = profile_;
  if (!credentials_.empty()) settings.credentials = credentials_;
  return settings;
}

std::vector<fast_dds::FastDdsSettings> NetworkOptions::observer_paths() const {
  fast_dds::FastDdsSettings path = settings();
  path.is_observer = true;
  std::vector<fast_dds::FastDdsSettings> paths;
  if (!path.loopback_only) paths.push_back(path);
  path.loopback_only = true;
  path.tcp.reset();
  paths.push_back(path);
  return paths;
}

std::vector<std::string> NetworkOptions::arguments() const {
  std::vector<std::string> arguments = arguments_but_profile();
  if (!network_.empty()) arguments.insert(arguments.begin(), {"--network", network_.string()});
  return arguments;
}

std::vector<std::string> NetworkOptions::arguments_but_profile() const {
  std::vector<std::string> arguments;
  if (domain_) arguments.insert(arguments.end(), {"--domain", std::to_string(*domain_)});
  for (const std::string& peer : peers_) arguments.insert(arguments.end(), {"--peer", peer});
  if (!discovery_server_.empty()) arguments.insert(arguments.end(), {"--discovery-server", discovery_server_});
  if (!profile_.empty()) arguments.insert(arguments.end(), {"--profile", profile_.string()});
  if (!credentials_.empty()) arguments.insert(arguments.end(), {"--credentials", credentials_.string()});
  if (busy_poll_us_ > 0) arguments.insert(arguments.end(), {"--busy-poll-us", std::to_string(busy_poll_us_)});
  if (loopback_only_) arguments.emplace_back("--loopback-only");
  return arguments;
}

}  // namespace hybridtest
