#include "transport/fast_dds/participant_qos.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <memory>

#include "core/config_error.hpp"
#include "transport/fast_dds/dds_version.hpp"

namespace hybridtest::fast_dds {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::string> locators(const eprosima::fastrtps::rtps::LocatorList_t& list) {
  std::vector<std::string> texts;
  for (const Locator& locator : list) {
    texts.push_back(IpLocator::toIPv4string(locator) + ":" + std::to_string(IpLocator::getPhysicalPort(locator)));
  }
  return texts;
}

FastDdsSettings over_tcp(std::optional<std::string> listens_at, std::vector<std::string> dials) {
  FastDdsSettings settings;
  settings.domain = 3;
  settings.tcp = TcpSettings{.listens_at = std::move(listens_at), .dials = std::move(dials), .tls = {}};
  return settings;
}

std::shared_ptr<rtps::TCPv4TransportDescriptor> tcp_of(const dds::DomainParticipantQos& qos) {
  if (qos.transport().user_transports.size() != 1) return nullptr;
  const auto outer =
      std::dynamic_pointer_cast<rtps::ChainingTransportDescriptor>(qos.transport().user_transports.front());
  if (outer == nullptr) return nullptr;
  return std::dynamic_pointer_cast<rtps::TCPv4TransportDescriptor>(outer->low_level_descriptor);
}

std::string refusal_of(const FastDdsSettings& settings) {
  try {
    static_cast<void>(participant_qos(settings));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return {};
}

TEST(ParticipantQos, PeersGetMulticastBesidesUnlessItIsOff) {
  FastDdsSettings settings;
  settings.initial_peers = {"192.0.2.7:7412"};
  EXPECT_THAT(locators(participant_qos(settings).wire_protocol().builtin.initialPeersList),
              ElementsAre("192.0.2.7:7412", "239.255.0.1:0"));
  settings.looks_by_multicast = false;
  EXPECT_THAT(locators(participant_qos(settings).wire_protocol().builtin.initialPeersList),
              ElementsAre("192.0.2.7:7412"));
}

TEST(ParticipantQos, TcpListenerIsAnnouncedWhereOthersDialIt) {
  const dds::DomainParticipantQos qos = participant_qos(over_tcp("192.0.2.1:5100", {}));
  const auto tcp = tcp_of(qos);
  ASSERT_NE(tcp, nullptr) << "another transport beside TCP";
  EXPECT_FALSE(qos.transport().use_builtin_transports);
  EXPECT_THAT(tcp->listening_ports, ElementsAre(5100));
  EXPECT_TRUE(tcp->enable_tcp_nodelay);
  EXPECT_FALSE(tcp->apply_security);
  EXPECT_THAT(locators(qos.wire_protocol().builtin.metatrafficUnicastLocatorList), ElementsAre("192.0.2.1:5100"));
  EXPECT_THAT(locators(qos.wire_protocol().default_unicast_locator_list), ElementsAre("192.0.2.1:5100"));
}

TEST(ParticipantQos, TcpDiallerOpensNoPort) {
  const dds::DomainParticipantQos qos = participant_qos(over_tcp({}, {"192.0.2.1:5100", "192.0.2.2:5101"}));
  ASSERT_NE(tcp_of(qos), nullptr);
  EXPECT_THAT(tcp_of(qos)->listening_ports, IsEmpty());
  EXPECT_THAT(locators(qos.wire_protocol().builtin.initialPeersList), ElementsAre("192.0.2.1:5100", "192.0.2.2:5101"));
}

TEST(ParticipantQos, OverTcpOneLogicalPortCarriesAll) {
  // RTPS 2.2, 9.6.1.1: 7400 + 250 * domain + 10 for discovery of the first participant.
  constexpr std::uint16_t kPort = 8160;
  for (const FastDdsSettings& settings : {over_tcp("192.0.2.1:5100", {}), over_tcp({}, {"192.0.2.1:5100"})}) {
    const auto wire = participant_qos(settings).wire_protocol();
    for (const auto* list : {&wire.builtin.metatrafficUnicastLocatorList, &wire.default_unicast_locator_list}) {
      ASSERT_EQ(list->size(), 1U);
      EXPECT_EQ(IpLocator::getLogicalPort(*list->begin()), kPort);
    }
    for (const Locator& peer : wire.builtin.initialPeersList) EXPECT_EQ(IpLocator::getLogicalPort(peer), kPort);
  }
}

TEST(ParticipantQos, TlsAsksBothEndsForACertificate) {
  const std::filesystem::path file = std::filesystem::temp_directory_path() / ("tls_" + std::to_string(::getpid()));
  std::ofstream{file} << "any";
  FastDdsSettings settings = over_tcp("192.0.2.1:5100", {});
  settings.tcp->tls = TlsFiles{.authority = file, .certificate = file, .key = file};
  using Tls = rtps::TCPTransportDescriptor::TLSConfig;
  const auto tcp = tcp_of(participant_qos(settings));
  ASSERT_NE(tcp, nullptr);
  EXPECT_TRUE(tcp->apply_security);
  EXPECT_TRUE(tcp->tls_config.get_verify_mode(Tls::TLSVerifyMode::VERIFY_PEER));
  EXPECT_TRUE(tcp->tls_config.get_verify_mode(Tls::TLSVerifyMode::VERIFY_FAIL_IF_NO_PEER_CERT));
  EXPECT_TRUE(tcp->tls_config.get_option(Tls::TLSOptions::NO_TLSV1_1));
  EXPECT_FALSE(tcp->tls_config.get_option(Tls::TLSOptions::NO_TLSV1_2));
  std::filesystem::remove(file);
  EXPECT_THAT(refusal_of(settings), HasSubstr("tls: the certificate of the authority cannot be read"));
}

/// Fast DDS keeps every profile that a process has read, so this file is the only one here with that name.
TEST(ParticipantQos, TransportsOfAProfileGetThePacketFilter) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("profile_" + std::to_string(::getpid()) + ".xml");
  std::ofstream{file} << R"(<?xml version="1.0" encoding="UTF-8"?>
<profiles xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles">
  <transport_descriptors>
    <transport_descriptor><transport_id>udp</transport_id><type>UDPv4</type><TTL>3</TTL></transport_descriptor>
    <transport_descriptor><transport_id>tcp</transport_id><type>TCPv4</type>
      <listening_ports><port>5100</port></listening_ports></transport_descriptor>
    <transport_descriptor><transport_id>memory</transport_id><type>SHM</type></transport_descriptor>
  </transport_descriptors>
  <participant profile_name="hybridtest"><rtps>
    <userTransports><transport_id>udp</transport_id><transport_id>tcp</transport_id>
      <transport_id>memory</transport_id></userTransports>
    <useBuiltinTransports>false</useBuiltinTransports>
  </rtps></participant>
</profiles>)";
  FastDdsSettings settings;
  EXPECT_EQ(unfiltered_text(settings), "");
  settings.profile_file = file;
  const dds::DomainParticipantQos qos = participant_qos(settings);
  const auto& transports = qos.transport().user_transports;
  ASSERT_EQ(transports.size(), 3U);
  const auto behind_filter = [&](std::size_t i) -> std::shared_ptr<rtps::TransportDescriptorInterface> {
    const auto filter = std::dynamic_pointer_cast<rtps::ChainingTransportDescriptor>(transports[i]);
    return filter == nullptr ? nullptr : filter->low_level_descriptor;
  };
  const auto udp = std::dynamic_pointer_cast<rtps::UDPv4TransportDescriptor>(behind_filter(0));
  ASSERT_NE(udp, nullptr);
  EXPECT_EQ(udp->TTL, 3);
  const auto tcp = std::dynamic_pointer_cast<rtps::TCPv4TransportDescriptor>(behind_filter(1));
  ASSERT_NE(tcp, nullptr);
  EXPECT_THAT(tcp->listening_ports, ElementsAre(5100));
  EXPECT_NE(std::dynamic_pointer_cast<rtps::SharedMemTransportDescriptor>(transports[2]), nullptr);
  EXPECT_EQ(unfiltered_text(settings),
            file.string() +
                ": what other processes of this host send through shared memory does not pass the packet filter "
                "(docs/security.md)");
  std::filesystem::remove(file);
}

TEST(ParticipantQos, WrongAddressesAreToldInWords) {
  EXPECT_THAT(refusal_of(over_tcp({}, {})), HasSubstr("at least one participant listens"));
  EXPECT_THAT(refusal_of(over_tcp({}, {"192.0.2.1"})), HasSubstr("'192.0.2.1': TCP needs a port"));
  FastDdsSettings settings;
  settings.interface_address = "192.0.2.99";
  EXPECT_THAT(refusal_of(settings), HasSubstr("no interface of this host has this address"));
  settings.interface_address = "127.0.0.1";
  EXPECT_EQ(refusal_of(settings), "");
}

}  // namespace
}  // namespace hybridtest::fast_dds
