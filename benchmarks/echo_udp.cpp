// The lower bound: the same number of bytes over plain UDP sockets on the loopback interface.

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <stdexcept>

#include "benchmarks/echo.hpp"
#include "benchmarks/echo_payload.hpp"
#include "benchmarks/peer_processes.hpp"
#include "hybridtest.h"

namespace hybridtest::benchmarks {
namespace {

using Clock = std::chrono::steady_clock;

std::size_t command_bytes() {
  return wire::DisplacementCommand::getCdrSerializedSize(echo_command_sample()) + 4;  // with encapsulation
}
std::size_t measurement_bytes() { return wire::ForceMeasurement::getCdrSerializedSize(echo_measurement_sample()) + 4; }

class LoopbackSocket {
 public:
  LoopbackSocket() : socket_{::socket(AF_INET, SOCK_DGRAM, 0)} {
    sockaddr_in address = to(0);
    socklen_t size = sizeof(address);
    if (socket_ < 0 || ::bind(socket_, reinterpret_cast<sockaddr*>(&address), size) != 0 ||
        ::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
      throw std::runtime_error{"cannot open a UDP socket on the loopback interface"};
    }
    port = ntohs(address.sin_port);
    const timeval timeout{.tv_sec = 20, .tv_usec = 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof(timeout));
  }
  ~LoopbackSocket() { ::close(socket_); }
  LoopbackSocket(const LoopbackSocket&) = delete;
  LoopbackSocket& operator=(const LoopbackSocket&) = delete;

  static sockaddr_in to(int port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
  }

  void send(const sockaddr_in& address, std::size_t bytes) {
    ::sendto(socket_, buffer_.data(), bytes, 0, reinterpret_cast<const sockaddr*>(&address), sizeof(address));
  }

  /// Blocks. @return the sender; throws after 20 s without a datagram.
  sockaddr_in receive() {
    sockaddr_in from{};
    socklen_t size = sizeof(from);
    if (::recvfrom(socket_, buffer_.data(), buffer_.size(), 0, reinterpret_cast<sockaddr*>(&from), &size) < 0) {
      throw std::runtime_error{"a UDP echo peer did not answer"};
    }
    return from;
  }

  int port = 0;

 private:
  int socket_;
  std::array<char, 4096> buffer_{};
};

}  // namespace

void udp_echo_peer(int port) {
  LoopbackSocket socket;
  const sockaddr_in initiator = LoopbackSocket::to(port);
  socket.send(initiator, 1);  // announces its port
  while (true) {
    static_cast<void>(socket.receive());
    socket.send(initiator, measurement_bytes());
  }
}

std::vector<double> udp_echo_us(const EchoSettings& settings) {
  LoopbackSocket socket;
  PeerProcesses peers;
  for (int i = 0; i < settings.peers; ++i) peers.start({"echo_peer", "udp", std::to_string(socket.port)});
  std::vector<sockaddr_in> addresses(static_cast<std::size_t>(settings.peers));
  for (sockaddr_in& address : addresses) address = socket.receive();

  std::vector<double> times_us;
  times_us.reserve(static_cast<std::size_t>(settings.samples));
  const std::size_t bytes = command_bytes();
  for (int i = 0; i < settings.warm_up + settings.samples; ++i) {
    const Clock::time_point start = Clock::now();
    for (const sockaddr_in& address : addresses) socket.send(address, bytes);
    for (int answer = 0; answer < settings.peers; ++answer) static_cast<void>(socket.receive());
    const std::chrono::duration<double, std::micro> round_trip = Clock::now() - start;
    if (i >= settings.warm_up) times_us.push_back(round_trip.count());
  }
  return times_us;
}

}  // namespace hybridtest::benchmarks
