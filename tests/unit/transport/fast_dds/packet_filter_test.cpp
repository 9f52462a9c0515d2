#include "transport/fast_dds/packet_filter.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <initializer_list>
#include <vector>

/// Packets as RTPS 2.3 (section 9.4) and DDS Security 1.1 lay them out. Those of Fast DDS itself pass in the tests of
/// the transport and of security.
namespace hybridtest::fast_dds {
namespace {

using Bytes = std::vector<std::uint8_t>;
using std::chrono::seconds;

constexpr PacketFilter::Time kNow{};

Bytes operator+(Bytes left, const Bytes& right) {
  left.insert(left.end(), right.begin(), right.end());
  return left;
}

Bytes bytes(std::initializer_list<int> values) {
  Bytes result;
  for (const int value : values) result.push_back(static_cast<std::uint8_t>(value));
  return result;
}

Bytes header(int participant = 1) {
  return bytes({'R', 'T', 'P', 'S', 2, 3, 1, 15, participant, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
}

/// Little endian, as all that follows.
Bytes part(int id, const Bytes& content, int more_flags = 0) {
  return bytes({id, 1 | more_flags, static_cast<int>(content.size() % 256), static_cast<int>(content.size() / 256)}) +
         content;
}

Bytes word(std::uint32_t value) {
  return bytes({static_cast<int>(value & 255U), static_cast<int>(value >> 8U & 255U),
                static_cast<int>(value >> 16U & 255U), static_cast<int>(value >> 24U)});
}

Bytes sequence(std::uint64_t number) {
  return word(static_cast<std::uint32_t>(number >> 32U)) + word(static_cast<std::uint32_t>(number));
}

Bytes gap(std::uint64_t first, std::uint64_t end) {
  return part(8, Bytes(8) + sequence(first) + sequence(end) + Bytes(4));
}
Bytes heartbeat(std::uint64_t first, std::uint64_t last) {
  return part(7, Bytes(8) + sequence(first) + sequence(last) + Bytes(4));
}
// Flags of DATA.
constexpr int kParameters = 2;
constexpr int kData = 4;
constexpr int kKey = 8;

/// @param octets   from the field that says so to what follows: 16.
Bytes data(int flags, int octets, const Bytes& what_follows) {
  return part(0x15, bytes({0, 0, octets % 256, octets / 256}) + Bytes(8) + sequence(1) + what_follows, flags);
}

struct Fragment {
  std::uint32_t first;
  int of_one;            // bytes
  std::uint32_t of_all;  // bytes
  std::size_t bytes = 8;
  int flags = 0;
};
Bytes fragment(const Fragment& one) {
  const Bytes which = word(one.first) + bytes({1, 0, one.of_one % 256, one.of_one / 256}) + word(one.of_all);
  return part(0x16, bytes({0, 0, 28, 0}) + Bytes(8) + sequence(1) + which + Bytes(one.bytes), one.flags);
}

Bytes statistics() { return part(0x80, Bytes(52)); }
Bytes encrypted() { return part(0x33, Bytes(20)) + part(0x30, Bytes(64)) + part(0x34, Bytes(20)); }

Bytes parameter(int id, const Bytes& value) {
  return bytes({id % 256, id / 256, static_cast<int>(value.size()), 0}) + value;
}
/// @param characters   how many it says that its class has; it has 4.
Bytes token(std::uint32_t characters = 4) { return word(characters) + bytes({'D', 'D', 'S', 0}) + word(0) + word(0); }

/// @param of   whose name is in it.
/// @param in_front   parameters in front of the data.
Bytes announcement(int of, const Bytes& parameters, const Bytes& in_front = {}, std::uint64_t number = 1) {
  const Bytes its_header = header(of);
  const Bytes guid = Bytes(its_header.begin() + 8, its_header.end()) + bytes({0, 0, 1, 0xc1});
  const Bytes list = bytes({0, 3, 0, 0}) + parameter(0x50, guid) + parameters + parameter(1, {});
  const Bytes inline_qos = in_front.empty() ? Bytes{} : in_front + parameter(1, {});
  return part(0x15, bytes({0, 0, 16, 0, 0, 1, 0, 0xc7, 0, 1, 0, 0xc2}) + sequence(number) + inline_qos + list,
              in_front.empty() ? 4 : 6);
}

/// When it is repeated.
bool admits_announcement(const Bytes& packet) {
  PacketFilter filter{Admission::secured};
  return !filter.admits_discovery(packet, kNow) && filter.admits_discovery(packet, kNow);
}

/// @param address   where the participant says that it is.
Bytes announced_at(int address) {
  return header() + announcement(1, parameter(0x32, Bytes(24, static_cast<std::uint8_t>(address))));
}

TEST(PacketFilter, RefusesRangesThatNoTestHas) {
  const PacketFilter filter{Admission::plain};
  EXPECT_TRUE(filter.admits_message(header() + gap(1, 1000)));
  EXPECT_FALSE(filter.admits_message(header() + gap(1, std::uint64_t{1} << 60U)));
  EXPECT_FALSE(filter.admits_message(header() + heartbeat(1, 5) + gap(1, std::uint64_t{1} << 30U)));
  EXPECT_TRUE(filter.admits_message(header() + heartbeat(6, 5))) << "nothing to send";
  EXPECT_FALSE(filter.admits_message(header() + heartbeat(1, std::uint64_t{1} << 30U)));
  EXPECT_FALSE(filter.admits_message(header() + heartbeat(std::uint64_t{1} << 50U, std::uint64_t{1} << 50U)));
}

TEST(PacketFilter, RefusesStatisticsThatAreNotTheLastPart) {
  for (const Admission admission : {Admission::plain, Admission::secured, Admission::secured_by_server}) {
    PacketFilter filter{admission};
    EXPECT_TRUE(filter.admits_discovery(header() + encrypted() + statistics(), kNow));
    EXPECT_FALSE(filter.admits_discovery(header() + encrypted() + statistics() + statistics(), kNow));
    EXPECT_FALSE(filter.admits_discovery(header() + statistics() + encrypted(), kNow));
  }
}

TEST(PacketFilter, RefusesPartsThatEndBetweenMultiplesOfFour) {
  const PacketFilter filter{Admission::plain};
  EXPECT_FALSE(filter.admits_message(header() + part(0x0e, Bytes(14)) + Bytes(2) + heartbeat(1, 5)));
  EXPECT_TRUE(filter.admits_message(header() + part(0x0e, Bytes(12)) + heartbeat(1, 5))) << "control";
  EXPECT_TRUE(filter.admits_message(header() + data(kData, 16, Bytes(5)))) << "the last one";
}

TEST(PacketFilter, RefusesDataThatAreNotThere) {
  const PacketFilter filter{Admission::plain};
  const auto admits = [&](const Bytes& packet) { return filter.admits_message(header() + packet); };
  const Bytes list = parameter(0x71, bytes({0, 0, 0, 3})) + parameter(1, {});
  EXPECT_TRUE(admits(data(kData, 16, Bytes(8))));
  EXPECT_TRUE(admits(data(kKey, 16, Bytes(8))));
  EXPECT_TRUE(admits(data(kParameters, 16, list))) << "has left";
  EXPECT_TRUE(admits(data(kParameters | kData, 16, list + Bytes(4))));
  EXPECT_FALSE(admits(data(kData, 16, {}))) << "none";
  EXPECT_FALSE(admits(data(kParameters | kData, 16, list))) << "none behind the parameters";
  EXPECT_FALSE(admits(data(kData | kKey, 16, Bytes(8)))) << "both";
  EXPECT_FALSE(admits(data(kData, 0, Bytes(8)))) << "in front of the part";
  EXPECT_FALSE(admits(data(kData, 0xfff0, Bytes(8)))) << "the same, as a signed number";
  EXPECT_FALSE(admits(data(kData, 400, Bytes(8)))) << "behind the packet";
  EXPECT_FALSE(admits(data(kParameters, 16, parameter(0x71, bytes({0, 0, 0, 3}))))) << "parameters without an end";
  EXPECT_FALSE(admits(data(kParameters, 16, bytes({0x71, 0, 0xff, 0xff}) + Bytes(8))))
      << "parameter with a false length";
  EXPECT_FALSE(admits(part(0x15, Bytes(12)))) << "too short";
}

TEST(PacketFilter, RefusesFragmentsThatAreNotOfAMessage) {
  const PacketFilter filter{Admission::plain};
  const auto admits = [&](const Bytes& packet) { return filter.admits_message(header() + packet); };
  EXPECT_TRUE(admits(fragment({.first = 1, .of_one = 1000, .of_all = 4000})));
  EXPECT_TRUE(admits(fragment({.first = 4, .of_one = 1000, .of_all = 4000})));
  EXPECT_FALSE(admits(fragment({.first = 5, .of_one = 1000, .of_all = 4000}))) << "behind the last";
  EXPECT_FALSE(admits(fragment({.first = 0, .of_one = 1000, .of_all = 4000}))) << "they are counted from 1";
  EXPECT_FALSE(admits(fragment({.first = 1, .of_one = 0, .of_all = 4000}))) << "empty ones";
  EXPECT_FALSE(admits(fragment({.first = 1, .of_one = 1000, .of_all = 1U << 30U}))) << "no message is so long";
  EXPECT_FALSE(admits(fragment({.first = 1, .of_one = 1000, .of_all = 4000, .bytes = 0}))) << "none";
  EXPECT_FALSE(admits(fragment({.first = 1, .of_one = 1000, .of_all = 4000, .flags = 4}))) << "of a key";
}

TEST(PacketFilter, MessagesWithCredentialsAreEncryptedAndNoMore) {
  const PacketFilter filter{Admission::secured};
  EXPECT_TRUE(filter.admits_message(header() + encrypted()));
  EXPECT_TRUE(filter.admits_message(header() + encrypted() + statistics()));
  EXPECT_FALSE(filter.admits_message(header() + encrypted() + heartbeat(1, 5)));
  EXPECT_FALSE(filter.admits_message(header() + heartbeat(1, 5)));
  EXPECT_FALSE(filter.admits_message(header()));
  EXPECT_TRUE(PacketFilter{Admission::plain}.admits_message(header() + heartbeat(1, 5))) << "control";
}

TEST(PacketFilter, OnlyAnnouncementsAndAuthenticationAreInPlainText) {
  EXPECT_TRUE(admits_announcement(header() + announcement(1, parameter(0x1001, token()))));
  EXPECT_TRUE(admits_announcement(header() + announcement(1, parameter(0x58, Bytes(4)), parameter(0x800f, Bytes(24)))));
  EXPECT_FALSE(admits_announcement(header() + heartbeat(1, 5)));
  EXPECT_FALSE(admits_announcement(header() + gap(1, 5)));
  EXPECT_FALSE(admits_announcement(header() + announcement(1, {}, parameter(0x71, bytes({0, 0, 0, 3}))))) << "leaves";
  EXPECT_FALSE(admits_announcement(header() + announcement(2, {}))) << "in the name of another";
}

TEST(PacketFilter, TokensAreAsLongAsTheySay) {
  EXPECT_FALSE(admits_announcement(header() + announcement(1, parameter(0x1001, token(0xfffffff0)))));
  EXPECT_FALSE(admits_announcement(header() + announcement(1, parameter(0x1002, token(40)))));
  const Bytes properties = word(2) + word(4) + Bytes(4) + word(4) + Bytes(4);
  EXPECT_FALSE(admits_announcement(header() + announcement(1, parameter(0x59, properties)))) << "one of two is missing";
}

TEST(PacketFilter, AnnouncementStaysAsItWasWhileItIsHeard) {
  PacketFilter filter{Admission::secured};
  const Bytes genuine = announced_at(0);
  const Bytes moved = announced_at(7);
  EXPECT_FALSE(filter.admits_discovery(genuine, kNow)) << "heard once";
  EXPECT_TRUE(filter.admits_discovery(genuine, kNow));
  for (int times = 0; times < 3; ++times) EXPECT_FALSE(filter.admits_discovery(moved, kNow + seconds{1}));
  const Bytes later = header() + announcement(1, parameter(0x32, Bytes(24)), {}, std::uint64_t{1} << 33U);
  EXPECT_FALSE(filter.admits_discovery(later, kNow + seconds{1})) << "Fast DDS would drop the genuine ones as old";
  EXPECT_TRUE(filter.admits_discovery(genuine, kNow + seconds{9}));
  EXPECT_FALSE(filter.admits_discovery(moved, kNow + seconds{18}));
  EXPECT_FALSE(filter.admits_discovery(moved, kNow + seconds{30})) << "heard once";
  EXPECT_TRUE(filter.admits_discovery(moved, kNow + seconds{31})) << "a participant that was away";
}

/// Who knows the network can send another announcement before the genuine one arrives, and many of them.
TEST(PacketFilter, ForgedAnnouncementsThatComeFirstDoNotKeepAParticipantOut) {
  PacketFilter filter{Admission::secured};
  for (int address = 1; address < 200; ++address) EXPECT_FALSE(filter.admits_discovery(announced_at(address), kNow));
  EXPECT_FALSE(filter.admits_discovery(announced_at(1), kNow)) << "not clearly more often than the others";
  for (int heard = 1; heard <= 4; ++heard) {
    EXPECT_EQ(filter.admits_discovery(announced_at(0), kNow + seconds{1}), heard == 4) << heard << " times";
    EXPECT_FALSE(filter.admits_discovery(announced_at(100 + heard), kNow + seconds{1}));
  }
  // What is repeated often enough gets in: the certificate tells whose it is, and that is not looked at here.
  PacketFilter other{Admission::secured};
  EXPECT_FALSE(other.admits_discovery(announced_at(1), kNow));
  EXPECT_TRUE(other.admits_discovery(announced_at(1), kNow)) << "control";
}

TEST(PacketFilter, CountsWhatItRefusesByKind) {
  const auto refused = std::make_shared<RefusedPackets>();
  PacketFilter filter{Admission::secured, refused};
  const Bytes genuine = announced_at(0);
  EXPECT_TRUE(filter.admits_message(header() + encrypted()));
  EXPECT_FALSE(filter.admits_discovery(genuine, kNow));
  EXPECT_TRUE(filter.admits_discovery(genuine, kNow));
  EXPECT_EQ(refused->harmful + refused->in_plain_text + refused->announcements, 0U);

  EXPECT_FALSE(filter.admits_message(header() + gap(1, std::uint64_t{1} << 60U)));
  EXPECT_FALSE(filter.admits_discovery(header() + statistics() + encrypted(), kNow));
  EXPECT_EQ(refused->harmful, 2U);
  EXPECT_FALSE(filter.admits_message(header() + heartbeat(1, 5)));
  EXPECT_FALSE(filter.admits_discovery(header() + heartbeat(1, 5), kNow));
  EXPECT_EQ(refused->in_plain_text, 2U);
  EXPECT_FALSE(filter.admits_discovery(header() + announcement(1, {}, parameter(0x71, Bytes(4))), kNow)) << "leaves";
  EXPECT_EQ(refused->departures, 1U);
  EXPECT_FALSE(filter.admits_discovery(header() + announcement(1, {}, parameter(0x70, Bytes(4))), kNow));
  EXPECT_EQ(refused->in_plain_text, 3U) << "more than an announcement says, and no notice of leaving";
  EXPECT_FALSE(filter.admits_discovery(header() + announcement(2, {}), kNow)) << "in the name of another";
  EXPECT_FALSE(filter.admits_discovery(announced_at(7), kNow)) << "moved";
  EXPECT_FALSE(filter.admits_discovery(header() + announcement(1, parameter(0x1001, token(0xfffffff0))), kNow));
  EXPECT_EQ(refused->announcements, 3U);
  EXPECT_EQ(refused->harmful + refused->in_plain_text + refused->departures, 6U) << "each packet is of one kind";
}

}  // namespace
}  // namespace hybridtest::fast_dds
