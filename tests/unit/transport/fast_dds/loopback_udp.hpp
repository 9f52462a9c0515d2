#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <memory>

#include "transport/fast_dds/dds_version.hpp"

/// UDP of Fast DDS on the loopback interface.
namespace hybridtest::fast_dds {

inline std::uint16_t free_port() {
  const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  EXPECT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&address), size), 0);
  EXPECT_EQ(::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size), 0);
  ::close(socket);
  return ntohs(address.sin_port);
}

inline Locator loopback_at(std::uint16_t port) {
  Locator locator;
  locator.kind = LOCATOR_KIND_UDPv4;
  IpLocator::setIPv4(locator, 127, 0, 0, 1);
  IpLocator::setPhysicalPort(locator, port);
  return locator;
}

inline std::shared_ptr<rtps::UDPv4TransportDescriptor> loopback_udp() {
  auto udp = std::make_shared<rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.emplace_back("127.0.0.1");
  return udp;
}

}  // namespace hybridtest::fast_dds
