#include "experimental_site/rigs/udp_port.hpp"

#include <fcntl.h>
#include <netdb.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <utility>

namespace hybridtest {
namespace {

/// Linux reports an unreachable port once for each datagram sent. This does not end the wait.
constexpr int kErrorsInARow = 64;

using Addresses = std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)>;

Addresses look_up(const char* host, std::uint16_t port, int family, int flags) {
  addrinfo wanted{};
  wanted.ai_family = family;
  wanted.ai_socktype = SOCK_DGRAM;
  wanted.ai_flags = flags | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const int error = ::getaddrinfo(host, std::to_string(port).c_str(), &wanted, &found);
  if (error != 0) throw std::runtime_error{::gai_strerror(error)};
  return {found, ::freeaddrinfo};
}

void check(int result, const char* what) {
  if (result < 0) throw std::runtime_error{std::string{what} + ": " + std::strerror(errno)};
}

/// Whether a datagram can be read before the time is over. Linux writes back the time that is left,
/// so that no clock has to be read.
bool is_readable(int socket, Duration& patience) noexcept {
  constexpr Duration::rep kPerSecond = 1'000'000'000;
  timeval left{};
  left.tv_sec = patience.count() / kPerSecond;
  left.tv_usec = (patience.count() % kPerSecond) / 1000;
  fd_set readable;
  FD_ZERO(&readable);
  FD_SET(socket, &readable);
  const int count = ::select(socket + 1, &readable, nullptr, nullptr, &left);
  if (count == 0) {
    patience = Duration::zero();
  } else {
    patience = std::min(patience, Duration{left.tv_sec * kPerSecond + left.tv_usec * 1000});
  }
  return count > 0;
}

}  // namespace

UdpPort::~UdpPort() { close(); }

void UdpPort::open() {
  close();
  const auto where = address_.host + ":" + std::to_string(address_.port);
  try {
    const Addresses peer = look_up(address_.host.c_str(), address_.port, AF_UNSPEC, 0);
    socket_ = ::socket(peer->ai_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    check(socket_, "no socket could be opened");
    // select() cannot handle a higher number.
    if (socket_ >= FD_SETSIZE) throw std::runtime_error{"too many open files"};
    if (address_.local_port != 0) {
      const Addresses local = look_up(nullptr, address_.local_port, peer->ai_family, AI_PASSIVE);
      check(::bind(socket_, local->ai_addr, local->ai_addrlen), "its local port cannot be used");
    }
    check(::connect(socket_, peer->ai_addr, peer->ai_addrlen), "the address cannot be reached");
  } catch (const std::runtime_error& error) {
    close();
    throw std::runtime_error{"udp " + where + ": " + error.what()};
  }
}

bool UdpPort::send(std::span<const std::byte> datagram) noexcept {
  const auto sent = ::send(socket_, datagram.data(), datagram.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  return std::cmp_equal(sent, datagram.size());
}

std::optional<std::size_t> UdpPort::receive(std::span<std::byte> buffer, Duration& patience) noexcept {
  if (socket_ < 0) return {};
  for (int errors = 0; errors < kErrorsInARow;) {
    const auto received = ::recv(socket_, buffer.data(), buffer.size(), MSG_DONTWAIT);
    if (received >= 0) return static_cast<std::size_t>(received);
    if (errno != EAGAIN && errno != EWOULDBLOCK) {
      ++errors;
    } else if (patience <= Duration::zero() || !is_readable(socket_, patience)) {
      return {};
    }
  }
  return {};
}

void UdpPort::close() noexcept {
  const int socket = socket_.exchange(-1);
  if (socket >= 0) ::close(socket);
}

}  // namespace hybridtest
