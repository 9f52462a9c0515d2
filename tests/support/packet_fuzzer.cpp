#include "tests/support/packet_fuzzer.hpp"

#include <arpa/inet.h>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <netinet/in.h>
#include <netinet/ip.h>
#include <netinet/udp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <ctime>
#include <initializer_list>
#include <stdexcept>
#include <system_error>

namespace hybridtest {
namespace {

constexpr int kPortsOfADomain = 250;  // RTPS 9.6.1
constexpr std::size_t kKept = 512;
constexpr std::size_t kHeader = 20;  // of RTPS
constexpr std::array<std::uint8_t, 8> kRtps{'R', 'T', 'P', 'S', 2, 3, 1, 15};
constexpr timespec kInterval{.tv_sec = 0, .tv_nsec = 100'000};

using Bytes = std::vector<std::uint8_t>;

/// Where its submessages begin, and where the last one ends: id, flags, two octets of length, and so many octets.
std::vector<std::size_t> parts_of(const Bytes& bytes) {
  std::vector<std::size_t> parts;
  for (std::size_t at = kHeader; at + 4 <= bytes.size();) {
    parts.push_back(at);
    const std::size_t length = bytes[at + 2] + 256U * bytes[at + 3];
    if (length == 0) break;
    at += 4 + length;
  }
  parts.push_back(bytes.size());
  return parts;
}

void append(Bytes& bytes, std::initializer_list<int> more) {
  for (const int one : more) bytes.push_back(static_cast<std::uint8_t>(one));
}

/// As RTPS does: the upper half first, each of them from its lowest octet on.
void append_sequence_number(Bytes& bytes, std::uint64_t number) {
  for (const unsigned shift : {32U, 40U, 48U, 56U, 0U, 8U, 16U, 24U}) {
    bytes.push_back(static_cast<std::uint8_t>(number >> shift));
  }
}

// Writers and readers of Fast DDS in the octets 2 to 4, and their counterparts: those of participants, publications,
// subscriptions and liveliness, the same encrypted, those of the authentication, and some of users.
struct Endpoints {
  std::array<std::uint8_t, 4> reader;
  std::array<std::uint8_t, 4> writer;
};
constexpr std::array<Endpoints, 12> kEndpoints{{
    {{0x00, 0x01, 0x00, 0xc7}, {0x00, 0x01, 0x00, 0xc2}},
    {{0x00, 0x00, 0x03, 0xc7}, {0x00, 0x00, 0x03, 0xc2}},
    {{0x00, 0x00, 0x04, 0xc7}, {0x00, 0x00, 0x04, 0xc2}},
    {{0x00, 0x02, 0x00, 0xc7}, {0x00, 0x02, 0x00, 0xc2}},
    {{0xff, 0x00, 0x03, 0xc7}, {0xff, 0x00, 0x03, 0xc2}},
    {{0xff, 0x00, 0x04, 0xc7}, {0xff, 0x00, 0x04, 0xc2}},
    {{0xff, 0x02, 0x00, 0xc7}, {0xff, 0x02, 0x00, 0xc2}},
    {{0xff, 0x02, 0x02, 0xc4}, {0xff, 0x02, 0x02, 0xc3}},
    {{0x00, 0x02, 0x01, 0xc4}, {0x00, 0x02, 0x01, 0xc3}},
    {{0x00, 0x00, 0x07, 0x07}, {0x00, 0x00, 0x0a, 0x02}},
    {{0x00, 0x00, 0x08, 0x07}, {0x00, 0x00, 0x08, 0x02}},
    {{0x00, 0x00, 0x03, 0x07}, {0x00, 0x00, 0x04, 0x02}},
}};

/// Hears every packet of the loopback interface.
int open_listener() {
  const int listener = ::socket(AF_PACKET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, htons(ETH_P_IP));
  if (listener < 0) return listener;
  sockaddr_ll address{};
  address.sll_family = AF_PACKET;
  address.sll_protocol = htons(ETH_P_IP);
  address.sll_ifindex = static_cast<int>(::if_nametoindex("lo"));
  if (::bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return listener;
  ::close(listener);
  return -1;
}

}  // namespace

std::string PacketFuzzer::why_not() {
  const int listener = open_listener();
  if (listener < 0) return "listening to packets: " + std::generic_category().message(errno);
  ::close(listener);
  return "";
}

PacketFuzzer::PacketFuzzer(int domain, std::uint64_t seed, Kind kind)
    : first_port_{7400 + kPortsOfADomain * domain}, kind_{kind}, random_{seed}, listener_{open_listener()} {
  if (listener_ < 0) throw std::runtime_error{why_not()};
  sender_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof own;
  if (::bind(sender_, reinterpret_cast<const sockaddr*>(&own), size) != 0 ||
      ::getsockname(sender_, reinterpret_cast<sockaddr*>(&own), &size) != 0) {
    throw std::runtime_error{"no socket to send from"};
  }
  own_port_ = ntohs(own.sin_port);
  thread_ = std::jthread{[this](const std::stop_token& stop) { run(stop); }};
}

void PacketFuzzer::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    listen();
    const Packet packet = next();
    if (!heard_.empty() || kind_ == Kind::noise || kind_ == Kind::malformed_packets) {
      sockaddr_in to{};
      to.sin_family = AF_INET;
      to.sin_port = htons(packet.port);
      to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      const auto count = ::sendto(sender_, packet.bytes.data(), packet.bytes.size(), MSG_DONTWAIT,
                                  reinterpret_cast<const sockaddr*>(&to), sizeof to);
      if (count >= 0) ++sent_;
    }
    pollfd nothing{.fd = -1, .events = 0, .revents = 0};
    static_cast<void>(::ppoll(&nothing, 1, &kInterval, nullptr));
  }
  ::close(sender_);
  ::close(listener_);
}

void PacketFuzzer::listen() {
  std::array<std::uint8_t, 65'536> bytes{};
  sockaddr_ll from{};
  socklen_t size = sizeof from;
  // A few at a time: the newest are of use.
  for (int i = 0; i < 16; ++i) {
    const auto count = ::recvfrom(listener_, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
    if (count < static_cast<ssize_t>(sizeof(iphdr) + sizeof(udphdr))) return;
    iphdr ip{};
    std::memcpy(&ip, bytes.data(), sizeof ip);
    const std::size_t header = 4U * ip.ihl;
    if (from.sll_pkttype == PACKET_OUTGOING || ip.protocol != IPPROTO_UDP) continue;
    udphdr udp{};
    std::memcpy(&udp, bytes.data() + header, sizeof udp);
    const int port = ntohs(udp.dest);
    if (port < first_port_ || port >= first_port_ + kPortsOfADomain || ntohs(udp.source) == own_port_) continue;
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(header + sizeof udp);
    Packet packet{static_cast<std::uint16_t>(port), {begin, bytes.begin() + count}};
    if (packet.bytes.size() < kHeader + 4) continue;
    if (heard_.size() < kKept) {
      heard_.push_back(std::move(packet));
    } else {
      heard_[oldest_++ % kKept] = std::move(packet);
    }
  }
}

PacketFuzzer::Packet PacketFuzzer::next() {
  Packet packet;
  if (kind_ == Kind::noise || kind_ == Kind::malformed_packets) {
    packet.port = static_cast<std::uint16_t>(first_port_ + static_cast<int>(below(60)));
    if (!heard_.empty()) packet.port = heard_[below(heard_.size())].port;
    if (kind_ == Kind::malformed_packets) {
      packet.bytes = malformed();
      return packet;
    }
    packet.bytes.resize(below(2000));
    for (std::uint8_t& one : packet.bytes) one = byte();
    if (below(2) == 0 && packet.bytes.size() > kRtps.size()) std::ranges::copy(kRtps, packet.bytes.begin());
    return packet;
  }
  if (heard_.empty()) return packet;
  packet = heard_[below(heard_.size())];
  switch (kind_) {
    case Kind::noise:
    case Kind::malformed_packets: break;
    case Kind::cut_packets: cut(packet.bytes); break;
    case Kind::altered_packets: alter(packet.bytes); break;
    case Kind::disordered_packets: disorder(packet.bytes); break;
    case Kind::forged_packets: forge(packet.bytes); break;
  }
  return packet;
}

std::vector<std::uint8_t> PacketFuzzer::malformed() {
  constexpr std::array<int, 19> kParts{0x01, 0x06, 0x07, 0x08, 0x09, 0x0c, 0x0d, 0x0e, 0x0f, 0x12,
                                       0x13, 0x15, 0x16, 0x30, 0x31, 0x32, 0x33, 0x34, 0x80};
  Bytes bytes{kRtps.begin(), kRtps.end()};
  while (bytes.size() < kHeader) bytes.push_back(byte());
  const std::size_t parts = 1 + below(4);
  for (std::size_t i = 0; i < parts; ++i) {
    const std::size_t length = 4 * below(below(3) == 0 ? 350 : 20);
    std::size_t said = length;
    if (below(6) == 0) said = 0;  // up to the end of the packet
    if (below(8) == 0) said = below(65'536);
    append(bytes,
           {kParts[below(kParts.size())], byte() | 1, static_cast<int>(said % 256), static_cast<int>(said / 256)});
    const std::size_t range = std::array<std::size_t, 3>{256, 64, 4}[below(3)];
    for (std::size_t at = 0; at < length; ++at) {
      const bool is_random = range != 64 || below(4) == 0;
      bytes.push_back(is_random ? static_cast<std::uint8_t>(below(range)) : std::uint8_t{0});
    }
  }
  return bytes;
}

void PacketFuzzer::cut(std::vector<std::uint8_t>& bytes) {
  if (below(2) == 0) {
    bytes.resize(kHeader + below(bytes.size() - kHeader));
    return;
  }
  const std::vector<std::size_t> parts = parts_of(bytes);
  const std::size_t at = parts[below(parts.size() - 1)] + 2;
  bytes[at] = byte();
  bytes[at + 1] = static_cast<std::uint8_t>(below(4) == 0 ? below(256) : below(3));
}

void PacketFuzzer::alter(std::vector<std::uint8_t>& bytes) {
  const std::size_t times = 1 + below(8);
  for (std::size_t i = 0; i < times; ++i) {
    const std::size_t at = kHeader + below(bytes.size() - kHeader);
    bytes[at] = below(2) == 0 ? byte() : static_cast<std::uint8_t>(bytes[at] ^ (1U << below(8)));
  }
}

void PacketFuzzer::disorder(std::vector<std::uint8_t>& bytes) {
  if (below(3) == 0) return;  // as it was heard, too late or twice
  const auto part = [this](const Bytes& packet) {
    const std::vector<std::size_t> parts = parts_of(packet);
    const std::size_t which = below(parts.size() - 1);
    const auto begin = packet.begin();
    return Bytes{begin + static_cast<std::ptrdiff_t>(parts[which]),
                 begin + static_cast<std::ptrdiff_t>(parts[which + 1])};
  };
  const Bytes original = bytes;
  const Bytes& other = below(2) == 0 ? original : heard_[below(heard_.size())].bytes;
  if (below(2) == 0) bytes.resize(kHeader);
  const std::size_t count = 1 + below(4);
  for (std::size_t i = 0; i < count; ++i) {
    const Bytes more = part(below(2) == 0 ? original : other);
    if (bytes.size() + more.size() < 9000) bytes.insert(bytes.end(), more.begin(), more.end());
  }
}

void PacketFuzzer::forge(std::vector<std::uint8_t>& bytes) {
  const bool is_announcement =
      bytes.size() > 100 &&
      std::search(bytes.begin(), bytes.end(), kEndpoints[0].writer.begin(), kEndpoints[0].writer.end()) != bytes.end();
  if (is_announcement && below(2) == 0) {
    forge_announcement(bytes);
    return;
  }
  const Bytes prefix{bytes.begin() + 8, bytes.begin() + kHeader};
  bytes.resize(kHeader);
  const Endpoints& ends = kEndpoints[below(kEndpoints.size())];
  const auto name = [&](const Endpoints& endpoints) {
    bytes.insert(bytes.end(), endpoints.reader.begin(), endpoints.reader.end());
    bytes.insert(bytes.end(), endpoints.writer.begin(), endpoints.writer.end());
  };
  const std::uint64_t far = std::uint64_t{1} << below(62);
  switch (below(5)) {
    case 0:  // GAP: nothing between 1 and `far` comes any more
      append(bytes, {0x08, 1, 28, 0});
      name(ends);
      append_sequence_number(bytes, 1);
      append_sequence_number(bytes, far);
      append(bytes, {0, 0, 0, 0});
      break;
    case 1:  // HEARTBEAT: only what follows `far` is still there
      append(bytes, {0x07, 1, 28, 0});
      name(ends);
      append_sequence_number(bytes, below(2) == 0 ? far : 1);
      append_sequence_number(bytes, far);
      append(bytes, {byte(), byte(), byte(), 0x70});
      break;
    case 2:  // ACKNACK: everything before `far` has arrived
      append(bytes, {0x06, 3, 24, 0});
      name(ends);
      append_sequence_number(bytes, far);
      append(bytes, {0, 0, 0, 0, byte(), byte(), byte(), 0x70});
      break;
    case 3:  // DATA of what may be anything
      append(bytes, {0x15, 5, 64, 0, 0, 0, 16, 0});
      name(ends);
      append_sequence_number(bytes, far);
      append(bytes, {0, 1, 0, 0});
      while (bytes.size() < kHeader + 68) bytes.push_back(byte());
      break;
    default:  // DATA: the participant has left
      append(bytes, {0x15, 3, 52, 0, 0, 0, 16, 0});
      name(kEndpoints[0]);
      append_sequence_number(bytes, (std::uint64_t{1} << 33U) + sent_);
      append(bytes, {0x70, 0, 16, 0});
      bytes.insert(bytes.end(), prefix.begin(), prefix.end());
      append(bytes, {0x00, 0x00, 0x01, 0xc1, 0x71, 0, 4, 0, 0, 0, 0, 3, 1, 0, 0, 0});
      break;
  }
}

void PacketFuzzer::forge_announcement(std::vector<std::uint8_t>& bytes) {
  // The parameters of an announcement: id, length and value each.
  const auto writer = std::search(bytes.begin(), bytes.end(), kEndpoints[0].writer.begin(), kEndpoints[0].writer.end());
  const auto number = static_cast<std::size_t>(writer - bytes.begin()) + 4;
  Bytes newer;
  append_sequence_number(newer, (std::uint64_t{1} << 33U) + sent_);
  if (number + newer.size() > bytes.size()) return;
  std::ranges::copy(newer, bytes.begin() + static_cast<std::ptrdiff_t>(number));
  std::vector<std::size_t> values;
  for (std::size_t at = number + newer.size() + 4; at + 8 <= bytes.size();) {
    const std::size_t length = bytes[at + 2] + 256U * bytes[at + 3];
    if (length < 4) break;
    values.push_back(at + 4);
    at += 4 + length;
  }
  if (values.empty()) return;
  const std::size_t at = values[below(values.size())];
  for (std::size_t i = 0; i < 4; ++i) {
    if (below(2) == 0) bytes[std::min(at + i, bytes.size() - 1)] = byte();
  }
}

}  // namespace hybridtest
