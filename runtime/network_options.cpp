#include "runtime/network_options.hpp"

namespace hybridtest {

void NetworkOptions::add_to(CLI::App& app) {
  app.add_option("--domain", domain_, "DDS domain; participants of one test use the same")
      ->check(CLI::Range(0, 232))
      ->capture_default_str()
      ->group("Network");
  app.add_option("--peer", peers_, "host[:port] of another participant where multicast does not reach; repeatable")
      ->group("Network");
  app.add_option("--discovery-server", discovery_server_, "host:port of a Fast DDS discovery server")->group("Network");
  app.add_option("--profile", profile_, "Fast DDS XML profiles; the participant profile 'hybridtest' is used")
      ->check(CLI::ExistingFile)
      ->group("Network");
  app.add_option("--busy-poll-us", busy_poll_us_,
                 "Look at the socket for so long before sleeping; shorter steps, for processors of their own")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str()
      ->group("Network");
  app.add_flag("--loopback-only", loopback_only_, "Talk on this machine only")->group("Network");
}

fast_dds::FastDdsSettings NetworkOptions::settings() const {
  fast_dds::FastDdsSettings settings;
  settings.domain = domain_;
  settings.loopback_only = loopback_only_;
  settings.initial_peers = peers_;
  settings.busy_poll = std::chrono::microseconds{busy_poll_us_};
  if (!discovery_server_.empty()) settings.discovery_server = discovery_server_;
  if (!profile_.empty()) settings.profile_file = profile_;
  return settings;
}

std::vector<fast_dds::FastDdsSettings> NetworkOptions::observer_paths() const {
  fast_dds::FastDdsSettings path = settings();
  path.is_observer = true;
  std::vector<fast_dds::FastDdsSettings> paths;
  if (!path.loopback_only) paths.push_back(path);
  path.loopback_only = true;
  paths.push_back(path);
  return paths;
}

std::vector<std::string> NetworkOptions::arguments() const {
  std::vector<std::string> arguments{"--domain", std::to_string(domain_)};
  for (const std::string& peer : peers_) arguments.insert(arguments.end(), {"--peer", peer});
  if (!discovery_server_.empty()) arguments.insert(arguments.end(), {"--discovery-server", discovery_server_});
  if (!profile_.empty()) arguments.insert(arguments.end(), {"--profile", profile_.string()});
  if (busy_poll_us_ > 0) arguments.insert(arguments.end(), {"--busy-poll-us", std::to_string(busy_poll_us_)});
  if (loopback_only_) arguments.emplace_back("--loopback-only");
  return arguments;
}

}  // namespace hybridtest
