#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <vector>

/// Packets for tests, as RTPS 2.3 (section 9.4) lays them out.
namespace hybridtest {

/// A message of a writer that skips those from 1 to this number, and says so to every reader of the participant.
/// @param end           beyond 2^24 no test has it: Fast DDS 2.9 is busy for years with a gap up to 2^60.
/// @param participant   the writer's; its GUID prefix.
inline std::vector<std::uint8_t> gap_up_to(std::uint64_t end, const std::array<std::uint8_t, 12>& participant = {1},
                                           const std::array<std::uint8_t, 4>& writer = {}) {
  constexpr std::uint8_t kGap = 0x08;
  constexpr std::uint8_t kLittleEndian = 0x01;
  std::vector<std::uint8_t> packet{'R', 'T', 'P', 'S', 2, 3, 1, 15};
  packet.insert(packet.end(), participant.begin(), participant.end());
  packet.insert(packet.end(), {kGap, kLittleEndian, 28, 0});
  packet.insert(packet.end(), 4, 0);  // to every reader
  packet.insert(packet.end(), writer.begin(), writer.end());
  const auto append = [&packet](std::uint64_t number) {
    for (const unsigned shift : {32U, 40U, 48U, 56U, 0U, 8U, 16U, 24U}) {
      packet.push_back(static_cast<std::uint8_t>(number >> shift));
    }
  };
  append(1);
  append(end);
  packet.insert(packet.end(), 4, 0);  // no bits
  return packet;
}

/// Says that it brings a fragment of a message, to every reader of the participant, and has parameters in front of it
/// but no data: Fast DDS 2.9 then frees what it has not allocated.
inline std::vector<std::uint8_t> fragment_without_data() {
  constexpr std::uint8_t kDataFragment = 0x16;
  constexpr std::uint8_t kLittleEndianWithParameters = 0x03;
  std::vector<std::uint8_t> packet{'R', 'T', 'P', 'S', 2, 3, 1, 15, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  packet.insert(packet.end(), {kDataFragment, kLittleEndianWithParameters, 36, 0, 0, 0, 28, 0});
  packet.insert(packet.end(), 8, 0);                                           // from whom and to whom
  packet.insert(packet.end(), {0, 0, 0, 0, 1, 0, 0, 0});                       // its number
  packet.insert(packet.end(), {1, 0, 0, 0, 1, 0, 0xe8, 3, 0xa0, 0x0f, 0, 0});  // the first of 4, each of 1000 bytes
  packet.insert(packet.end(), {1, 0, 0, 0});                                   // the end of the parameters
  return packet;
}

/// As one datagram to a UDP port of this host.
/// @return whether the operating system took it.
inline bool send_to(std::uint16_t port, const std::vector<std::uint8_t>& packet) {
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const ssize_t sent =
      ::sendto(socket, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof(to));
  ::close(socket);
  return sent == static_cast<ssize_t>(packet.size());
}

}  // namespace hybridtest
