#include "transport/fast_dds/connection_watch.hpp"

#include <arpa/inet.h>
#include <linux/tcp.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>

namespace hybridtest::fast_dds {
namespace {

/// One end of a connection of this process.
struct Socket {
  int descriptor = -1;
  std::uint16_t own_port = 0;
  std::uint64_t bytes = 0;  // that have come
};

bool is_at(const sockaddr_in& peer, const Locator& remote) noexcept {
  if (ntohs(peer.sin_port) != IpLocator::getPhysicalPort(remote)) return false;
  const auto is = [&](const unsigned char* address) { return std::memcmp(&peer.sin_addr, address, 4) == 0; };
  return is(IpLocator::getIPv4(remote)) || (IpLocator::hasWan(remote) && is(IpLocator::getWan(remote)));
}

/// The sockets of this process that are connected to this address and port.
std::vector<Socket> connected_to(const Locator& remote) {
  std::vector<Socket> sockets;
  std::error_code error;
  for (std::filesystem::directory_iterator entry{"/proc/self/fd", error}, end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    Socket socket;
    std::from_chars(name.data(), name.data() + name.size(), socket.descriptor);
    sockaddr_in peer{};
    sockaddr_in own{};
    socklen_t peer_size = sizeof peer;
    socklen_t own_size = sizeof own;
    if (::getpeername(socket.descriptor, reinterpret_cast<sockaddr*>(&peer), &peer_size) != 0 ||
        peer.sin_family != AF_INET || !is_at(peer, remote) ||
        ::getsockname(socket.descriptor, reinterpret_cast<sockaddr*>(&own), &own_size) != 0) {
      continue;
    }
    socket.own_port = ntohs(own.sin_port);
    tcp_info info{};
    socklen_t info_size = sizeof info;
    if (::getsockopt(socket.descriptor, IPPROTO_TCP, TCP_INFO, &info, &info_size) != 0) continue;
    socket.bytes = info.tcpi_bytes_received;
    sockets.push_back(socket);
  }
  return sockets;
}

bool is_same_place(const Locator& one, const Locator& other) {
  return IpLocator::getPhysicalPort(one) == IpLocator::getPhysicalPort(other) && IpLocator::compareAddress(one, other);
}

}  // namespace

ConnectionWatch::ConnectionWatch(Duration patience) : patience_{patience}, thread_{[this] { run(); }} {}

ConnectionWatch::~ConnectionWatch() {
  {
    const std::lock_guard lock{mutex_};
    has_ended_ = true;
  }
  ended_.notify_all();
  thread_.join();
}

void ConnectionWatch::expect(const Locator& remote) {
  if (remote.kind != LOCATOR_KIND_TCPv4) return;
  const std::lock_guard lock{mutex_};
  if (std::ranges::any_of(remotes_, [&](const Remote& known) { return is_same_place(known.locator, remote); })) return;
  Remote& added = remotes_.emplace_back(Remote{.locator = remote, .patience = patience_});
  for (const Socket& before : connected_to(remote)) {
    added.connections[before.own_port] = {.since = {}, .bytes = 0, .is_left_alone = true};
  }
}

void ConnectionWatch::run() {
  std::unique_lock lock{mutex_};
  while (!ended_.wait_for(lock, patience_ / 4, [this] { return has_ended_; })) {
    for (Remote& remote : remotes_) look(remote, std::chrono::steady_clock::now());
  }
}

void ConnectionWatch::look(Remote& remote, Time now) {
  const std::vector<Socket> sockets = connected_to(remote.locator);
  std::erase_if(remote.connections, [&](const auto& known) {
    return std::ranges::find(sockets, known.first, &Socket::own_port) == sockets.end();
  });
  for (const Socket& socket : sockets) {
    Connection& connection =
        remote.connections.try_emplace(socket.own_port, Connection{.since = now, .bytes = socket.bytes}).first->second;
    const Duration age = now - connection.since;
    // What comes at its very beginning is the answer to its request.
    if (age > remote.patience / 2 && socket.bytes > connection.bytes) connection.is_left_alone = true;
    connection.bytes = socket.bytes;
    if (connection.is_left_alone || age < remote.patience) continue;
    ::shutdown(socket.descriptor, SHUT_RDWR);
    connection.is_left_alone = true;  // until Fast DDS closes it
    remote.patience *= 2;
  }
}

}  // namespace hybridtest::fast_dds
