#include "report/live/connection.hpp"

#include <arpa/inet.h>
#include <sys/poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

namespace hybridtest {
namespace {

constexpr std::size_t kRequestBytes = 64UL * 1024;
constexpr Duration kSlice = std::chrono::milliseconds{200};

void read_address(const sockaddr_storage& address, std::string& ip, int& port) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (address.ss_family == AF_INET) {
    const auto* v4 = reinterpret_cast<const sockaddr_in*>(&address);
    inet_ntop(AF_INET, &v4->sin_addr, text.data(), text.size());
    port = ntohs(v4->sin_port);
  } else if (address.ss_family == AF_INET6) {
    const auto* v6 = reinterpret_cast<const sockaddr_in6*>(&address);
    inet_ntop(AF_INET6, &v6->sin6_addr, text.data(), text.size());
    port = ntohs(v6->sin6_port);
  }
  ip = text.data();
}

}  // namespace

Connection::~Connection() {
  shutdown(socket_, SHUT_RDWR);
  close(socket_);
}

bool Connection::wait(short events, Duration limit) const {
  pollfd waited{.fd = socket_, .events = events, .revents = 0};
  const auto limit_ms = std::chrono::duration_cast<std::chrono::milliseconds>(limit).count();
  return limit > Duration{0} && poll(&waited, 1, static_cast<int>(limit_ms) + 1) > 0;
}

Duration Connection::left() const { return deadline_ - clock_.now(); }

bool Connection::waits_for_request(Duration limit, const std::function<bool()>& is_stopping) {
  const Instant by = clock_.now() + limit;
  while (!is_stopping()) {
    if (begin_ < end_) return true;
    const Duration rest = by - clock_.now();
    if (rest <= Duration{0}) return false;
    if (wait(POLLIN, std::min(rest, kSlice))) return true;
  }
  return false;
}

void Connection::begin_request(Duration limit) {
  deadline_ = clock_.now() + limit;
  bytes_left_ = kRequestBytes;
}

bool Connection::is_readable() const { return begin_ < end_ || wait(POLLIN, left()); }

bool Connection::is_writable() const { return wait(POLLOUT, left()); }

ssize_t Connection::read(char* bytes, std::size_t size) {
  if (begin_ == end_) {
    if (!is_readable()) return -1;
    const ssize_t received = recv(socket_, buffer_.data(), buffer_.size(), 0);
    if (received <= 0) return received;
    begin_ = 0;
    end_ = static_cast<std::size_t>(received);
  }
  const std::size_t taken = std::min({size, end_ - begin_, bytes_left_});
  if (taken == 0) return -1;  // too large
  std::memcpy(bytes, buffer_.data() + begin_, taken);
  begin_ += taken;
  bytes_left_ -= taken;
  return static_cast<ssize_t>(taken);
}

ssize_t Connection::write(const char* bytes, std::size_t size) {
  if (!is_writable()) return -1;
  return send(socket_, bytes, size, MSG_NOSIGNAL | MSG_DONTWAIT);
}

void Connection::get_remote_ip_and_port(std::string& ip, int& port) const {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (getpeername(socket_, reinterpret_cast<sockaddr*>(&address), &size) == 0) read_address(address, ip, port);
}

void Connection::get_local_ip_and_port(std::string& ip, int& port) const {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) == 0) read_address(address, ip, port);
}

}  // namespace hybridtest
