#include "transport/fast_dds/polled_socket.hpp"

#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <stdexcept>
#include <utility>

#include "core/assert.hpp"

namespace hybridtest::fast_dds {
namespace {

using Clock = std::chrono::steady_clock;

/// Read in one go, so that a flood of packets does not keep the thread from its work.
constexpr int kDatagramsAtOnce = 64;

int event_descriptor() {
  const int descriptor = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  if (descriptor < 0) throw std::runtime_error{"no file descriptor left"};
  return descriptor;
}

timespec to_wait(Duration time) noexcept {
  const Duration left = std::max(time, Duration{0});
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(left);
  return {static_cast<time_t>(seconds.count()), static_cast<long>((left - seconds).count())};
}

/// @return whether one of the descriptors is readable, or a signal came.
template <std::size_t Count>
bool wait_for(std::array<pollfd, Count>& descriptors, const timespec* time) noexcept {
  return ::ppoll(descriptors.data(), Count, time, nullptr) != 0;
}

void set(int event) noexcept {
  const std::uint64_t one = 1;
  static_cast<void>(!::write(event, &one, sizeof(one)));  // fails only when it is set already
}

}  // namespace

PolledSocket::PolledSocket(Duration busy_poll, std::function<void()> when_woken)
    : busy_poll_{busy_poll},
      when_woken_{std::move(when_woken)},
      interruption_{event_descriptor()},
      end_{event_descriptor()} {
  stand_in_ = std::thread{[this] { stand_in(); }};
}

PolledSocket::~PolledSocket() {
  set(end_);
  stand_in_.join();
  if (socket_ >= 0) ::close(socket_);
  ::close(end_);
  ::close(interruption_);
}

bool PolledSocket::open(std::uint16_t port, bool loopback_only, std::uint32_t datagram_bytes_max, Sink sink) {
  HYBRIDTEST_ASSERT(socket_ < 0);
  const int descriptor = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return false;
  // Packets wait here while the thread works; the system grants what it allows.
  constexpr int kWaitingBytes = 1 << 20;
  ::setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &kWaitingBytes, sizeof(kWaitingBytes));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(loopback_only ? INADDR_LOOPBACK : INADDR_ANY);
  if (::bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    ::close(descriptor);
    return false;
  }
  const std::lock_guard lock{mutex_};
  sink_ = std::move(sink);
  datagram_.resize(datagram_bytes_max);
  port_ = port;
  socket_ = descriptor;
  return true;
}

// The descriptor stays until the end: a thread may be waiting for it.
void PolledSocket::close() noexcept {
  const std::lock_guard lock{mutex_};
  sink_ = nullptr;
  port_ = 0;
}

bool PolledSocket::is_open_at(std::uint16_t port) const noexcept { return port != 0 && port_ == port; }

void PolledSocket::receive() noexcept {
  visits_.fetch_add(1, std::memory_order_relaxed);
  read();
}

void PolledSocket::read() noexcept {
  const std::lock_guard lock{mutex_};
  for (int i = 0; i < kDatagramsAtOnce && socket_ >= 0; ++i) {
    sockaddr_in from{};
    socklen_t size = sizeof(from);
    const ssize_t bytes =
        ::recvfrom(socket_, datagram_.data(), datagram_.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
    if (bytes < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return;
    if (bytes <= 0 || !sink_) continue;  // an error that an earlier packet of ours came back with
    sink_(datagram_.data(), static_cast<std::uint32_t>(bytes), ntohl(from.sin_addr.s_addr), ntohs(from.sin_port));
  }
}

bool PolledSocket::await(Clock::time_point deadline) noexcept {
  is_awaited_.store(true, std::memory_order_relaxed);
  std::array<pollfd, 2> descriptors{pollfd{socket_, POLLIN, 0}, pollfd{interruption_, POLLIN, 0}};
  const bool endless = deadline == Clock::time_point::max();
  bool in_time = false;
  Clock::time_point now = Clock::now();
  if (busy_poll_ > Duration{0}) {
    const timespec none{};
    const Clock::time_point rest = std::min(deadline, now + busy_poll_);
    while (!(in_time = wait_for(descriptors, &none)) && now < rest) now = Clock::now();
  }
  if (!in_time) {
    const timespec time = endless ? timespec{} : to_wait(deadline - now);
    in_time = wait_for(descriptors, endless ? nullptr : &time);
  }
  if (when_woken_ && (descriptors[0].revents & POLLIN) != 0) when_woken_();
  if ((descriptors[1].revents & POLLIN) != 0) {
    std::uint64_t count = 0;
    static_cast<void>(!::read(interruption_, &count, sizeof(count)));
  }
  visits_.fetch_add(1, std::memory_order_relaxed);
  is_awaited_.store(false, std::memory_order_relaxed);
  return in_time;
}

void PolledSocket::interrupt() noexcept { set(interruption_); }

bool PolledSocket::is_someone_there(std::uint64_t& visits_seen) const noexcept {
  if (is_awaited_.load(std::memory_order_relaxed)) return true;
  return std::exchange(visits_seen, visits_.load(std::memory_order_relaxed)) != visits_seen;
}

void PolledSocket::stand_in() noexcept {
  std::uint64_t visits_seen = 0;
  bool is_needed = false;
  const timespec absence = to_wait(kAbsence);
  while (true) {
    std::array<pollfd, 2> descriptors{pollfd{is_needed ? socket_.load() : -1, POLLIN, 0}, pollfd{end_, POLLIN, 0}};
    static_cast<void>(wait_for(descriptors, &absence));
    if ((descriptors[1].revents & POLLIN) != 0) return;
    // Who is back reads alone again, also while it is between two waits.
    is_needed = !is_someone_there(visits_seen);
    if (is_needed && (descriptors[0].revents & POLLIN) != 0) read();
  }
}

}  // namespace hybridtest::fast_dds
