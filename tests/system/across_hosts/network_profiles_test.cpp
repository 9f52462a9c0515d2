#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <regex>
#include <sstream>

#include "tests/system/across_hosts/across_hosts_fixture.hpp"

/// Each kind of network profile carries a test with real processes to its end, and changes no bit of its result.
namespace hybridtest {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Optional;

class NetworkProfilesLive : public AcrossHosts {
 protected:
  static std::string tcp_profile(const std::string& host, int port) {
    return "type: tcp\nhosts:\n  coordinator: {host: " + host + ", listens: " + std::to_string(port) +
           "}\n  storey_1: {}\n  storey_2: {}\n";
  }
  static std::string tls(const std::string& folder) {
    return "tls: {authority: " + folder + "/authority.pem, certificate: \"" + folder + "/{id}.pem\", key: \"" + folder +
           "/{id}.key\"}\n";
  }
};

TEST_F(NetworkProfilesLive, OneHostGivesTheBitsOfSimulate) {
  expect_bits_of_simulate(with_profile("type: one_host\n"));
}

TEST_F(NetworkProfilesLive, PeersGiveTheBitsOfSimulate) {
  const std::string here = "{host: 127.0.0.1}";
  expect_bits_of_simulate(with_profile("type: peers\nhosts:\n  coordinator: " + here + "\n  storey_1: " + here +
                                       "\n  storey_2: " + here + "\n"));
}

TEST_F(NetworkProfilesLive, DiscoveryServerGivesTheBitsOfSimulate) {
  const Arguments arguments =
      with_profile("type: discovery_server\nserver: {host: 127.0.0.1, listens: " + std::to_string(free_port()) + "}\n");
  StartedProgram server = start_hybridtest({"discovery-server", arguments[0], arguments[1]}, "server");
  ASSERT_TRUE(wait_until([&] { return server.standard_output().find("discovery server at") != std::string::npos; }))
      << server.standard_error();
  expect_bits_of_simulate(arguments);
  server.signal(SIGINT);
  EXPECT_THAT(server.wait(), Optional(kExitCompleted)) << server.standard_error();
}

TEST_F(NetworkProfilesLive, SecondDiscoveryServerIsRefused) {
  const std::string port = std::to_string(free_port());
  StartedProgram first = start_hybridtest({"discovery-server", "--port", port}, "first");
  ASSERT_TRUE(wait_until([&] { return first.standard_output().find("discovery server at") != std::string::npos; }));
  StartedProgram second = start_hybridtest({"discovery-server", "--port", port}, "second");
  EXPECT_THAT(second.wait(), Optional(kExitInternal));
  EXPECT_THAT(second.standard_error(), HasSubstr("UDP port " + port + " is in use"));
}

TEST_F(NetworkProfilesLive, TcpGivesTheBitsOfSimulate) {
  expect_bits_of_simulate(with_profile(tcp_profile("127.0.0.1", free_port())));
}

TEST_F(NetworkProfilesLive, TwoTcpListenersGiveTheBitsOfSimulate) {
  expect_bits_of_simulate(with_profile(
      "type: tcp\nhosts:\n  storey_1: {host: 127.0.0.1, listens: " + std::to_string(free_port()) +
      "}\n  coordinator: {host: 127.0.0.1, listens: " + std::to_string(free_port()) + "}\n  storey_2: {}\n"));
}

TEST_F(NetworkProfilesLive, TlsOverTcpGivesTheBitsOfSimulate) {
  if (!make_certificates("certificates", {"coordinator", "storey_1", "storey_2"})) GTEST_SKIP() << "no program openssl";
  expect_bits_of_simulate(with_profile(tcp_profile("127.0.0.1", free_port()) + tls("certificates")));
}

/// A profile of Fast DDS itself, which leaves it the choice of transports: UDP and shared memory.
TEST_F(NetworkProfilesLive, FastDdsProfileGivesTheBitsOfSimulate) {
  Arguments arguments{"--profile", write("profile.xml", R"(<?xml version="1.0" encoding="UTF-8"?>
<profiles xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles">
  <participant profile_name="hybridtest"><rtps/></participant>
</profiles>)")};
  std::ranges::copy(network(), std::back_inserter(arguments));
  expect_bits_of_simulate(arguments);
  for (const char* output : {"coordinator.coordinator", "experimental_site.storey_1"}) {
    EXPECT_THAT(text_of(directory() / (std::string{output} + ".err")), HasSubstr("does not pass the packet filter"))
        << output;
  }
}

TEST_F(NetworkProfilesLive, TlsKeepsOutACertificateOfAnotherAuthority) {
  if (!make_certificates("certificates", {"coordinator", "storey_1", "storey_2"})) GTEST_SKIP() << "no program openssl";
  ASSERT_TRUE(make_certificates("others", {"storey_1"}));
  const std::string profile = tcp_profile("127.0.0.1", free_port());
  Arguments arguments = with_profile(profile + tls("certificates"));
  arguments.insert(arguments.end(), {"--set", "timeouts={discovery_s: 5}"});
  Arguments intruding = arguments;
  intruding[1] = write("intruder.yaml", "schema: hybridtest-network/1\n" + profile + tls("others"));
  StartedProgram coordinator = start("coordinator", "coordinator", arguments);
  StartedProgram numerical = start("numerical_substructure", "storey_2", arguments);
  StartedProgram intruder = start("experimental_site", "storey_1", intruding);
  EXPECT_THAT(coordinator.wait(), Optional(kExitConfiguration)) << coordinator.standard_error();
  EXPECT_THAT(coordinator.standard_error(), HasSubstr("storey_1"));
  EXPECT_THAT(intruder.wait(), Optional(kExitConfiguration)) << intruder.standard_error();
}

/// Hosts on this machine: network namespaces joined by cables.
class SeveralHosts : public NetworkProfilesLive {
 protected:
  ~SeveralHosts() override {
    for (const std::string& host : hosts_) static_cast<void>(succeeds("ip netns delete " + host));
  }

  /// @return its name; empty where there can be none, see problem().
  [[nodiscard]] std::string add_host() {
    if (::geteuid() != 0) {
      problem_ = "network namespaces need root";
      return {};
    }
    std::string host = "ht" + std::to_string(::getpid()) + "_" + std::to_string(hosts_.size());
    if (!must("ip netns add " + host)) return {};
    hosts_.push_back(host);
    must("ip -n " + host + " link set lo up");
    return host;
  }
  /// Joins two of them by a cable, whose ends have these addresses.
  void join(const std::string& one, const std::string& one_address, const std::string& other,
            const std::string& other_address) {
    const std::string cable = "hc" + std::to_string(::getpid()) + std::to_string(cables_++);
    if (!problem_.empty()) return;
    must("ip link add " + cable + "a netns " + one + " type veth peer name " + cable + "b netns " + other);
    must("ip -n " + one + " addr add " + one_address + "/24 dev " + cable + "a");
    must("ip -n " + other + " addr add " + other_address + "/24 dev " + cable + "b");
    must("ip -n " + one + " link set " + cable + "a up");
    must("ip -n " + other + " link set " + cable + "b up");
    if (!problem_.empty()) return;
    // A participant uses the interfaces that are up when it starts.
    const auto is_up = [](const std::string& host, const std::string& end) {
      return succeeds("ip -n " + host + " link show dev " + end + " | grep 'state UP'");
    };
    EXPECT_TRUE(wait_until([&] { return is_up(one, cable + "a") && is_up(other, cable + "b"); }));
  }
  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }

  static bool succeeds(const std::string& command) { return std::system((command + " >/dev/null 2>&1").c_str()) == 0; }
  static Arguments inside(const std::string& host) { return {"/usr/bin/env", "ip", "netns", "exec", host}; }

 private:
  bool must(const std::string& command) {
    if (problem_.empty() && !succeeds(command)) problem_ = "no network namespaces here: " + command;
    return problem_.empty();
  }

  std::vector<std::string> hosts_;
  int cables_ = 0;
  std::string problem_;
};

class TwoHosts : public SeveralHosts {
 protected:
  void SetUp() override {
    left_ = add_host();
    right_ = add_host();
    join(left_, "10.71.0.1", right_, "10.71.0.2");
    if (!problem().empty()) GTEST_SKIP() << problem();
  }

  std::string left_;
  std::string right_;
};

TEST_F(TwoHosts, PeersGiveTheBitsOfSimulate) {
  const Arguments arguments = with_profile(
      "type: peers\nhosts:\n  coordinator: {host: 10.71.0.1}\n  storey_1: {host: 10.71.0.2}\n  storey_2: {host: "
      "10.71.0.2}\n");
  expect_bits_of_simulate(arguments, inside(left_), inside(right_));
}

TEST_F(TwoHosts, MulticastGivesTheBitsOfSimulate) {
  expect_bits_of_simulate(with_profile("type: multicast\n"), inside(left_), inside(right_));
}

/// Two hosts whose firewalls let nothing in but answers, and the rules of docs/across_hosts.md that open them.
class Firewalls : public TwoHosts {
 protected:
  void SetUp() override {
    TwoHosts::SetUp();
    if (IsSkipped()) return;
    close(left_);
    close(right_);
    if (!why_not_.empty()) GTEST_SKIP() << why_not_;
  }

  /// Runs the rule of the page that opens ports of this protocol, with this address in the place of its example's.
  void open(const std::string& host, const std::string& protocol, const std::string& address) {
    const std::string page = text_of(std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "docs/across_hosts.md");
    std::istringstream lines{page};
    const std::string ports = " " + protocol + " dport ";
    std::string rule;
    for (std::string line; rule.empty() && std::getline(lines, line);) {
      if (line.starts_with("nft ") && line.find(ports) != std::string::npos) rule = line;
    }
    ASSERT_FALSE(rule.empty()) << "the page has no rule for " << protocol;
    rule = std::regex_replace(rule, std::regex{R"(ip saddr (\{[^}]*\}|[0-9.]+))"}, "ip saddr " + address);
    EXPECT_TRUE(succeeds("ip netns exec " + host + " " + rule)) << rule;
  }
  /// DDS domain 0, as in the page: nobody else is in these networks.
  [[nodiscard]] Arguments profile(const std::string& body) const {
    return {"--network", write("network.yaml", "schema: hybridtest-network/1\n" + body)};
  }
  [[nodiscard]] std::string doctor_of_the_site(const Arguments& profile) const {
    Arguments arguments = profile;
    arguments.insert(arguments.end(), {"--wait", "1", "--out", directory().string()});
    StartedProgram doctor = start("hybridtest", "storey_1", arguments, inside(right_));
    EXPECT_THAT(doctor.wait(), Optional(kExitConfiguration)) << doctor.standard_error();
    return doctor.standard_output();
  }

 private:
  void close(const std::string& host) {
    const std::string rules =
        "add table inet filter; add chain inet filter input { type filter hook input priority 0; }; "
        "add rule inet filter input iif lo accept; add rule inet filter input ct state established,related accept; "
        "add rule inet filter input drop";
    if (!succeeds("nft --version")) why_not_ = "no program nft (Debian: nftables)";
    if (why_not_.empty() && !succeeds("ip netns exec " + host + " nft '" + rules + "'")) {
      why_not_ = "no firewall can be set up in a network namespace here";
    }
  }

  std::string why_not_;
};

TEST_F(Firewalls, PeersNeedTheUdpPortsOfThePageAndNoOther) {
  const Arguments arguments = profile(
      "type: peers\nhosts:\n  coordinator: {host: 10.71.0.1}\n  storey_1: {host: 10.71.0.2}\n  storey_2: {host: "
      "10.71.0.2}\n");
  EXPECT_THAT(doctor_of_the_site(arguments), HasSubstr("coordinator was not found"));
  open(left_, "udp", "10.71.0.2");
  open(right_, "udp", "10.71.0.1");
  expect_bits_of_simulate(arguments, inside(left_), inside(right_));
}

TEST_F(Firewalls, TcpNeedsTheOnePortOfThePageAtOneHost) {
  const Arguments arguments = profile(tcp_profile("10.71.0.1", 5100));
  EXPECT_THAT(doctor_of_the_site(arguments), HasSubstr("does not accept a connection: Connection timed out"));
  open(left_, "tcp", "10.71.0.2");
  expect_bits_of_simulate(arguments, inside(left_), inside(right_));
}

TEST_F(TwoHosts, TlsToTheOneHostThatAcceptsConnections) {
  if (!make_certificates("certificates", {"coordinator", "storey_1", "storey_2"})) GTEST_SKIP() << "no program openssl";
  const Arguments longer{"--set", "time.duration_s=2"};
  Arguments arguments = with_profile(tcp_profile("10.71.0.1", 5100) + tls("certificates"));
  arguments.insert(arguments.end(), longer.begin(), longer.end());
  StartedProgram site = start("experimental_site", "storey_1", arguments, inside(right_));
  StartedProgram numerical = start("numerical_substructure", "storey_2", arguments, inside(right_));
  StartedProgram coordinator = start("coordinator", "coordinator", arguments, inside(left_));
  // While the test runs: the connection to 10.71.0.1:5100, and nobody else who listens, as /proc/net/tcp writes them.
  const auto sockets = [](const StartedProgram& one) {
    return text_of("/proc/" + std::to_string(one.process()) + "/net/tcp");
  };
  const std::string listening = "00000000:0000 0A ";
  EXPECT_TRUE(
      wait_until([&] { return sockets(site).find("0100470A:13EC 01 ") != std::string::npos || !site.is_running(); }));
  const std::string at_site = sockets(site);
  EXPECT_THAT(at_site, HasSubstr("0100470A:13EC 01 "));
  EXPECT_THAT(at_site, Not(HasSubstr(listening)));
  EXPECT_THAT(sockets(coordinator), HasSubstr(listening));
  ASSERT_THAT(coordinator.wait(), Optional(kExitCompleted)) << coordinator.standard_error();
  EXPECT_THAT(site.wait(), Optional(kExitCompleted)) << site.standard_error();
  EXPECT_THAT(numerical.wait(), Optional(kExitCompleted)) << numerical.standard_error();
  EXPECT_EQ(displacement("run"), simulated(longer));
}

/// The coordinator stands behind a router, which forwards one port. There is no other way between the two networks.
TEST_F(SeveralHosts, TlsThroughARouterThatTranslatesAddresses) {
  if (!make_certificates("certificates", {"coordinator", "storey_1", "storey_2"})) GTEST_SKIP() << "no program openssl";
  if (!succeeds("python3 --version")) GTEST_SKIP() << "no program python3";
  const std::string coordinator = add_host();
  const std::string router = add_host();
  const std::string others = add_host();
  join(coordinator, "10.72.0.1", router, "10.72.0.254");
  join(others, "10.71.0.2", router, "10.71.0.254");
  if (!problem().empty()) GTEST_SKIP() << problem();
  EXPECT_FALSE(succeeds("ip -n " + others + " route get 10.72.0.1")) << "there is another way";
  Arguments words = inside(router);
  words.insert(words.end(), {std::string{HYBRIDTEST_SOURCE_DIR} + "/tests/system/across_hosts/stand_in_router",
                             "10.71.0.254:5100", "10.72.0.1:5100"});
  words.erase(words.begin());
  StartedProgram forwarding{"/usr/bin/env", words, directory() / "router", {}};
  ASSERT_TRUE(wait_until([&] { return forwarding.standard_output().find("listening") != std::string::npos; }))
      << forwarding.standard_error();
  expect_bits_of_simulate(with_profile(tcp_profile("10.71.0.254", 5100) + tls("certificates")), inside(coordinator),
                          inside(others));
  EXPECT_THAT(forwarding.standard_output(), HasSubstr("connection from 10.71.0.2"));
}

}  // namespace
}  // namespace hybridtest
