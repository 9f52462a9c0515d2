#include "experimental_site/rigs/udp_datagram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "core/random.hpp"

namespace hybridtest {
namespace {

std::vector<std::byte> kept(const std::string& name) {
  std::ifstream stream{std::string{HYBRIDTEST_SOURCE_DIR} + "/tests/contract/udp_datagrams/" + name, std::ios::binary};
  std::vector<std::byte> bytes;
  std::transform(std::istreambuf_iterator<char>{stream}, {}, std::back_inserter(bytes),
                 [](char c) { return static_cast<std::byte>(c); });
  return bytes;
}

/// What the kept files hold; tests/rig_simulator/test_datagrams.py has the same.
CommandDatagram kept_command() {
  CommandDatagram command;
  command.sequence = 0xFEDCBA98;
  command.loop_count = 70000;
  command.request = ControllerRequest::active;
  command.control_period_ns = 976562;
  command.time_ns = 12345678901234;
  command.displacement_m = SiteVector{{0.0125, -1.0 / 3.0, 2.5e-7}};
  return command;
}

MeasurementDatagram kept_measurement() {
  MeasurementDatagram measurement;
  measurement.sequence = 4000000001;
  measurement.command_sequence = 0xFEDCBA97;
  measurement.state = ControllerState::active;
  measurement.status = kFollowsDatagrams | kCommandLimited;
  measurement.discarded = 258;
  measurement.time_ns = -5000000007;
  measurement.displacement_m = SiteVector{{0.012, -0.25, std::numeric_limits<double>::infinity()}};
  measurement.force_n = SiteVector{{-40.0e3, 0.1, 6.5e4}};
  return measurement;
}

TEST(UdpDatagram, StoredCommandRoundTripsByteByByte) {
  const auto bytes = kept("command_v1.bin");
  CommandDatagram command;
  ASSERT_EQ(decode(bytes, command), DatagramDefect::none);
  EXPECT_EQ(command, kept_command());
  CommandBytes written;
  encode(kept_command(), written);
  EXPECT_TRUE(std::ranges::equal(written, bytes));
}

TEST(UdpDatagram, StoredMeasurementRoundTripsByteByByte) {
  const auto bytes = kept("measurement_v1.bin");
  MeasurementDatagram measurement;
  ASSERT_EQ(decode(bytes, measurement), DatagramDefect::none);
  EXPECT_EQ(measurement, kept_measurement());
  MeasurementBytes written;
  encode(kept_measurement(), written);
  EXPECT_TRUE(std::ranges::equal(written, bytes));
}

TEST(UdpDatagram, RoundTripsForEveryActuatorCount) {
  Random random{3};
  for (int actuators = 1; actuators <= kMaxSiteDofs; ++actuators) {
    MeasurementDatagram measurement = kept_measurement();
    measurement.displacement_m.resize(actuators);
    measurement.force_n.resize(actuators);
    for (Eigen::Index i = 0; i < actuators; ++i) {
      measurement.displacement_m[i] = random.normal();
      measurement.force_n[i] = 1e5 * random.normal();
    }
    MeasurementBytes bytes;
    encode(measurement, bytes);
    MeasurementDatagram read;
    ASSERT_EQ(decode(bytes, read), DatagramDefect::none);
    EXPECT_EQ(read, measurement);
  }
}

/// The kept command with some bytes changed and, unless that is the defect, the checksum put right.
DatagramDefect defect_with(std::size_t place, std::byte value, bool is_sealed = true) {
  auto bytes = kept("command_v1.bin");
  bytes.at(place) = value;
  if (is_sealed) {
    const std::uint32_t checksum = crc32(std::span{bytes}.first(kCommandBytes - 4));
    for (std::size_t i = 0; i < 4; ++i) bytes[kCommandBytes - 4 + i] = static_cast<std::byte>(checksum >> (8 * i));
  }
  CommandDatagram command = kept_command();
  command.sequence = 7;
  const DatagramDefect defect = decode(bytes, command);
  EXPECT_EQ(command.sequence == 7, defect != DatagramDefect::none) << "a defect leaves what was there";
  return defect;
}

TEST(UdpDatagram, ReportsEveryDefect) {
  EXPECT_EQ(defect_with(0, std::byte{'H'}), DatagramDefect::none);
  EXPECT_EQ(defect_with(3, std::byte{'M'}), DatagramDefect::magic);
  EXPECT_EQ(defect_with(4, std::byte{2}), DatagramDefect::version);
  EXPECT_EQ(defect_with(6, std::byte{131}), DatagramDefect::size);
  EXPECT_EQ(defect_with(40, std::byte{1}, false), DatagramDefect::checksum);
  EXPECT_EQ(defect_with(16, std::byte{3}), DatagramDefect::state);
  EXPECT_EQ(defect_with(17, std::byte{0}), DatagramDefect::actuators);
  EXPECT_EQ(defect_with(17, std::byte{13}), DatagramDefect::actuators);
  MeasurementDatagram measurement;
  EXPECT_EQ(decode(kept("command_v1.bin"), measurement), DatagramDefect::magic);
}

TEST(UdpDatagram, ReadsNothingBeyondItsEnd) {
  auto bytes = kept("measurement_v1.bin");
  bytes.push_back(std::byte{0});
  MeasurementDatagram measurement;
  EXPECT_EQ(decode(bytes, measurement), DatagramDefect::size);
  for (std::size_t size = 0; size < kMeasurementBytes; ++size) {
    const std::vector<std::byte> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    ASSERT_EQ(decode(cut, measurement), DatagramDefect::size) << size;
  }
}

TEST(UdpDatagram, ChecksumMatchesTheStandard) {
  const std::string text = "123456789";
  EXPECT_EQ(crc32(std::as_bytes(std::span{text})), 0xCBF43926U);
  EXPECT_EQ(crc32({}), 0U);
}

}  // namespace
}  // namespace hybridtest
