#include "tests/support/emulated_hosts.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <net/route.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <thread>
#include <utility>

namespace hybridtest {
namespace {

/// Longer than a burst of packets: the emulator drops what is to be dropped, not the device.
constexpr int kTunnelQueue = 20'000;

[[noreturn]] void fail(const std::string& what) { throw std::runtime_error{what + ": " + std::strerror(errno)}; }

void require(bool worked, const char* what) {
  if (!worked) fail(what);
}

/// On a thread that ends: what it did to itself ends with it.
void on_a_thread(const std::function<void()>& action) {
  std::exception_ptr thrown;
  std::thread{[&] {
    try {
      action();
    } catch (...) {
      thrown = std::current_exception();
    }
  }}.join();
  if (thrown) std::rethrow_exception(thrown);
}

ifreq device(const char* name) {
  ifreq request{};
  std::strncpy(request.ifr_name, name, IFNAMSIZ - 1);
  return request;
}

sockaddr_in ipv4(const std::string& address) {
  sockaddr_in result{};
  result.sin_family = AF_INET;
  ::inet_pton(AF_INET, address.c_str(), &result.sin_addr);
  return result;
}

template <class Target>
void put(const sockaddr_in& address, Target& target) {
  static_assert(sizeof address <= sizeof target);
  std::memcpy(&target, &address, sizeof address);
}

void switch_on(int socket, const char* name) {
  ifreq request = device(name);
  require(::ioctl(socket, SIOCGIFFLAGS, &request) == 0, "SIOCGIFFLAGS");
  request.ifr_flags = static_cast<short>(request.ifr_flags | IFF_UP | IFF_RUNNING | IFF_MULTICAST);
  require(::ioctl(socket, SIOCSIFFLAGS, &request) == 0, "SIOCSIFFLAGS");
}

/// Of the calling thread's namespace.
OwnedFile make_tunnel(const std::string& address) {
  OwnedFile tunnel{::open("/dev/net/tun", O_RDWR | O_NONBLOCK | O_CLOEXEC)};
  require(tunnel.get() >= 0, "/dev/net/tun");
  ifreq request = device("lan");
  request.ifr_flags = IFF_TUN | IFF_NO_PI;
  require(::ioctl(tunnel.get(), TUNSETIFF, &request) == 0, "TUNSETIFF");

  const OwnedFile socket{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
  require(socket.get() >= 0, "socket");
  request = device("lan");
  put(ipv4(address), request.ifr_addr);
  require(::ioctl(socket.get(), SIOCSIFADDR, &request) == 0, "SIOCSIFADDR");
  request = device("lan");
  put(ipv4("255.255.255.0"), request.ifr_netmask);
  require(::ioctl(socket.get(), SIOCSIFNETMASK, &request) == 0, "SIOCSIFNETMASK");
  request = device("lan");
  request.ifr_qlen = kTunnelQueue;
  require(::ioctl(socket.get(), SIOCSIFTXQLEN, &request) == 0, "SIOCSIFTXQLEN");
  switch_on(socket.get(), "lan");
  switch_on(socket.get(), "lo");

  rtentry multicast{};
  put(ipv4("224.0.0.0"), multicast.rt_dst);
  put(ipv4("240.0.0.0"), multicast.rt_genmask);
  multicast.rt_flags = RTF_UP;
  std::string name = "lan";
  multicast.rt_dev = name.data();
  require(::ioctl(socket.get(), SIOCADDRT, &multicast) == 0, "SIOCADDRT");
  return tunnel;
}

/// Programs that the calling thread starts from now on have this offset of the clocks that count from the start of the
/// machine.
void set_clock_offset(Duration offset) {
  require(::unshare(CLONE_NEWTIME) == 0, "a namespace of the clock");
  std::ofstream file{"/proc/" + std::to_string(::gettid()) + "/timens_offsets"};
  const auto whole_s = std::chrono::duration_cast<std::chrono::seconds>(offset);
  for (const char* clock : {"monotonic", "boottime"}) {
    file << clock << ' ' << whole_s.count() << ' ' << (offset - whole_s).count() << '\n' << std::flush;
  }
  require(file.good(), "timens_offsets");
}

}  // namespace

OwnedFile::~OwnedFile() {
  if (file_ >= 0) ::close(file_);
}
OwnedFile::OwnedFile(OwnedFile&& other) noexcept : file_{std::exchange(other.file_, -1)} {}
OwnedFile& OwnedFile::operator=(OwnedFile&& other) noexcept {
  std::swap(file_, other.file_);
  return *this;
}

std::string EmulatedHost::why_not() {
  try {
    const EmulatedHost host{1};
    host.inside([] {});
    return {};
  } catch (const std::exception& error) {
    return std::string{"hosts as network namespaces are not permitted here ("} + error.what() +
           "); they need root and /dev/net/tun";
  }
}

EmulatedHost::EmulatedHost(int number, Duration clock_offset) : number_{number}, clock_offset_{clock_offset} {
  on_a_thread([this] {
    require(::unshare(CLONE_NEWNET) == 0, "a network namespace");
    namespace_ = OwnedFile{::open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC)};
    require(namespace_.get() >= 0, "/proc/thread-self/ns/net");
    tunnel_ = make_tunnel(address());
  });
}

std::string EmulatedHost::address() const { return "10.77.0." + std::to_string(number_); }

void EmulatedHost::inside(const std::function<void()>& action) const {
  on_a_thread([&] {
    require(::setns(namespace_.get(), CLONE_NEWNET) == 0, "entering the host");
    if (clock_offset_ != Duration{0}) set_clock_offset(clock_offset_);
    action();
  });
}

}  // namespace hybridtest
