#include "runtime/network_profile.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::Optional;

class NetworkProfiles : public ::testing::Test {
 protected:
  ~NetworkProfiles() override { std::filesystem::remove(file_); }

  NetworkProfile read(const std::string& body) const {
    std::ofstream{file_} << "schema: hybridtest-network/1\n" << body;
    return read_network_profile(file_);
  }
  std::string refusal(const std::string& body) const {
    try {
      static_cast<void>(read(body));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return {};
  }

 private:
  const std::filesystem::path file_ =
      std::filesystem::temp_directory_path() / ("network_" + std::to_string(::getpid()) + ".yaml");
};

NetworkProfile shipped(const std::string& name) {
  return read_network_profile(std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "launch/profiles" / (name + ".yaml"));
}

/// RTPS 2.2, 9.6.1.1: PB + DG * domain + d1 + PG * participant with PB 7400, DG 250, d1 10, PG 2.
TEST_F(NetworkProfiles, UdpPortsAreThoseOfTheRtpsFormula) {
  EXPECT_EQ(udp_ports(0, 10), (PortRange{7410, 7429}));
  EXPECT_EQ(udp_ports(77, 1), (PortRange{26660, 26661}));
}

TEST_F(NetworkProfiles, ShippedProfilesBecomeTheirSettings) {
  EXPECT_TRUE(settings_of(shipped("one_host"), "storey_1").loopback_only);

  const auto multicast = settings_of(shipped("lan_multicast"), "storey_1");
  EXPECT_FALSE(multicast.loopback_only);
  EXPECT_THAT(multicast.initial_peers, IsEmpty());

  const auto peers = settings_of(shipped("lan_peers"), "storey_1");
  EXPECT_FALSE(peers.looks_by_multicast);
  EXPECT_EQ(peers.initial_peers.size(), 30U);  // 3 hosts, 10 participants each
  EXPECT_THAT(peers.initial_peers, Contains("192.168.10.20:7410"));
  EXPECT_THAT(peers.initial_peers, Contains("192.168.10.22:7428"));
  EXPECT_THAT(peers.initial_peers, Not(Contains("192.168.10.22:7429")));  // a port of messages

  EXPECT_THAT(settings_of(shipped("wan_discovery_server"), "storey_1").discovery_server,
              Optional(std::string{"192.0.2.10:11811"}));

  const auto coordinator = settings_of(shipped("wan_tcp"), "coordinator");
  ASSERT_TRUE(coordinator.tcp);
  EXPECT_THAT(coordinator.tcp->listens_at, Optional(std::string{"192.0.2.10:5100"}));
  EXPECT_THAT(coordinator.tcp->dials, IsEmpty());
  const auto site = settings_of(shipped("wan_tcp"), "storey_1");
  EXPECT_EQ(site.tcp->listens_at, std::nullopt);
  EXPECT_THAT(site.tcp->dials, ElementsAre("192.0.2.10:5100"));
  EXPECT_EQ(site.tcp->tls->key.filename(), "storey_1.key");
  EXPECT_EQ(site.tcp->tls->authority.filename(), "authority.pem");
}

TEST_F(NetworkProfiles, OfTwoListenersTheLaterOneDials) {
  const NetworkProfile profile = read(
      "type: tcp\nhosts:\n  a: {host: 192.0.2.1, listens: 5100}\n  b: {host: 192.0.2.2, listens: 5100}\n  c: {}\n");
  EXPECT_THAT(settings_of(profile, "a").tcp->dials, IsEmpty());
  EXPECT_THAT(settings_of(profile, "b").tcp->dials, ElementsAre("192.0.2.1:5100"));
  EXPECT_THAT(settings_of(profile, "c").tcp->dials, ElementsAre("192.0.2.1:5100", "192.0.2.2:5100"));
  EXPECT_THAT(settings_of(profile, "operator").tcp->dials, ElementsAre("192.0.2.1:5100", "192.0.2.2:5100"));
}

TEST_F(NetworkProfiles, AnotherDomainMovesUdpPortsAndNotTcp) {
  NetworkProfile udp = shipped("lan_peers");
  move_to_domain(udp, 4);
  EXPECT_THAT(settings_of(udp, "storey_1").initial_peers, Contains("192.168.10.20:8410"));
  NetworkProfile tcp = shipped("wan_tcp");
  move_to_domain(tcp, 4);
  EXPECT_THAT(settings_of(tcp, "storey_1").tcp->dials, ElementsAre("192.0.2.10:5100"));
  EXPECT_EQ(settings_of(tcp, "storey_1").domain, 4U);
}

TEST_F(NetworkProfiles, ListsEveryErrorWithItsPlace) {
  const std::string told = refusal(
      "type: peers\ndomain: 2\nhosts:\n  coordinator: {host: 192.0.2.1, listens: 7410-7419}\n  storey_1: {hots: x}\n");
  EXPECT_THAT(told, HasSubstr(":5:"));
  EXPECT_THAT(told, HasSubstr("'7410-7419' are not the UDP ports of domain 2: they begin at 7910"));
  EXPECT_THAT(told, HasSubstr("hots"));
  EXPECT_THAT(told, HasSubstr("host"));
}

TEST_F(NetworkProfiles, RefusesWhatCannotConnect) {
  EXPECT_THAT(refusal("type: tcp\nhosts: {a: {}, b: {}}\n"), HasSubstr("nobody listens"));
  EXPECT_THAT(refusal("type: tcp\nhosts: {a: {host: h, listens: 5}, b: {host: h, listens: 5}}\n"),
              HasSubstr("a and b listen at the same port"));
  EXPECT_THAT(refusal("type: tcp\nhosts: {a: {listens: 5}, b: {}}\n"), HasSubstr("host"));
  EXPECT_THAT(refusal("type: peers\nhosts: {a: {host: h}}\n"), HasSubstr("one entry for each participant"));
  EXPECT_THAT(refusal("type: discovery_server\n"), HasSubstr("server"));
  EXPECT_THAT(refusal("type: tpc\n"), HasSubstr("tcp"));
  EXPECT_THAT(refusal("type: multicast\ntls: {}\n"), HasSubstr("tls"));
}

TEST_F(NetworkProfiles, ParticipantWithoutAnEntryIsRefused) {
  const NetworkProfile profile = shipped("lan_peers");
  EXPECT_THROW(static_cast<void>(settings_of(profile, "storey_9")), ConfigError);
  EXPECT_NO_THROW(static_cast<void>(settings_of(profile, "operator")));
}

}  // namespace
}  // namespace hybridtest
