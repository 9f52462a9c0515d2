#include "experimental_site/rigs/udp_datagram.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>

#include "core/assert.hpp"

namespace hybridtest {
namespace {

constexpr std::string_view kCommandMagic = "HTDC";
constexpr std::string_view kMeasurementMagic = "HTDM";

// Offsets of both datagrams; the checksum is in the last four bytes of each.
constexpr std::size_t kVersionAt = 4;
constexpr std::size_t kSizeAt = 6;
constexpr std::size_t kSequenceAt = 8;
constexpr std::size_t kStateAt = 16;
constexpr std::size_t kActuatorsAt = 17;
constexpr std::size_t kTimeAt = 24;
constexpr std::size_t kDisplacementAt = 32;
// Of a command.
constexpr std::size_t kLoopCountAt = 12;
constexpr std::size_t kControlPeriodAt = 20;
// Of a measurement.
constexpr std::size_t kCommandSequenceAt = 12;
constexpr std::size_t kStatusAt = 18;
constexpr std::size_t kDiscardedAt = 20;
constexpr std::size_t kForceAt = kDisplacementAt + sizeof(double) * kMaxSiteDofs;

constexpr std::size_t kChecksumBytes = 4;
static_assert(kForceAt + kChecksumBytes == kCommandBytes);
static_assert(kForceAt + sizeof(double) * kMaxSiteDofs + kChecksumBytes == kMeasurementBytes);

template <std::unsigned_integral Value>
void put(std::span<std::byte> bytes, std::size_t at, Value value) noexcept {
  for (std::size_t i = 0; i < sizeof value; ++i) bytes[at + i] = static_cast<std::byte>((value >> (8 * i)) & 0xFFU);
}

template <std::unsigned_integral Value>
[[nodiscard]] Value get(std::span<const std::byte> bytes, std::size_t at) noexcept {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof(Value); ++i) value |= std::to_integer<std::uint64_t>(bytes[at + i]) << (8 * i);
  return static_cast<Value>(value);
}

void put(std::span<std::byte> bytes, std::size_t at, const SiteVector& values) noexcept {
  for (Eigen::Index i = 0; i < values.size(); ++i, at += sizeof(double)) {
    put(bytes, at, std::bit_cast<std::uint64_t>(values[i]));
  }
}

void get(std::span<const std::byte> bytes, std::size_t at, SiteVector& values) noexcept {
  values.resize(get<std::uint8_t>(bytes, kActuatorsAt));
  for (Eigen::Index i = 0; i < values.size(); ++i, at += sizeof(double)) {
    values[i] = std::bit_cast<double>(get<std::uint64_t>(bytes, at));
  }
}

void begin(std::span<std::byte> bytes, std::string_view magic, Eigen::Index actuators) noexcept {
  HYBRIDTEST_ASSERT(actuators >= 1 && actuators <= kMaxSiteDofs);
  std::ranges::fill(bytes, std::byte{0});
  for (std::size_t i = 0; i < magic.size(); ++i) bytes[i] = static_cast<std::byte>(magic[i]);
  put(bytes, kVersionAt, kUdpProtocolVersion);
  put(bytes, kSizeAt, static_cast<std::uint16_t>(bytes.size()));
  put(bytes, kActuatorsAt, static_cast<std::uint8_t>(actuators));
}

void seal(std::span<std::byte> bytes) noexcept {
  const std::size_t end = bytes.size() - kChecksumBytes;
  put(bytes, end, crc32(bytes.first(end)));
}

/// Checks that both datagrams have in common.
DatagramDefect defect_of(std::span<const std::byte> bytes, std::string_view magic, std::size_t size,
                         std::uint8_t highest_state) noexcept {
  if (bytes.size() < kSequenceAt) return DatagramDefect::size;
  for (std::size_t i = 0; i < magic.size(); ++i) {
    if (bytes[i] != static_cast<std::byte>(magic[i])) return DatagramDefect::magic;
  }
  if (get<std::uint16_t>(bytes, kVersionAt) != kUdpProtocolVersion) return DatagramDefect::version;
  if (bytes.size() != size || get<std::uint16_t>(bytes, kSizeAt) != size) return DatagramDefect::size;
  const std::size_t end = size - kChecksumBytes;
  if (get<std::uint32_t>(bytes, end) != crc32(bytes.first(end))) return DatagramDefect::checksum;
  const auto actuators = get<std::uint8_t>(bytes, kActuatorsAt);
  if (actuators < 1 || actuators > kMaxSiteDofs) return DatagramDefect::actuators;
  return get<std::uint8_t>(bytes, kStateAt) > highest_state ? DatagramDefect::state : DatagramDefect::none;
}

/// Remainder of each byte for crc32().
constexpr std::array<std::uint32_t, 256> kRemainders = [] {
  constexpr std::uint32_t kReflectedPolynomial = 0xEDB88320U;
  std::array<std::uint32_t, 256> remainders{};
  for (std::uint32_t byte = 0; byte < remainders.size(); ++byte) {
    std::uint32_t remainder = byte;
    for (int bit = 0; bit < 8; ++bit) {
      remainder = (remainder >> 1U) ^ ((remainder & 1U) != 0 ? kReflectedPolynomial : 0U);
    }
    remainders[byte] = remainder;
  }
  return remainders;
}();

}  // namespace

std::uint32_t crc32(std::span<const std::byte> bytes) noexcept {
  std::uint32_t remainder = 0xFFFFFFFFU;
  for (const std::byte byte : bytes) {
    remainder = (remainder >> 8U) ^ kRemainders[(remainder ^ std::to_integer<std::uint32_t>(byte)) & 0xFFU];
  }
  return ~remainder;
}

std::string_view describe(DatagramDefect defect) noexcept {
  switch (defect) {
    case DatagramDefect::none: return "nothing wrong";
    case DatagramDefect::size: return "a wrong number of bytes";
    case DatagramDefect::magic: return "another beginning than HTDC or HTDM";
    case DatagramDefect::version: return "another protocol version";
    case DatagramDefect::checksum: return "a wrong checksum";
    case DatagramDefect::actuators: return "another number of actuators";
    case DatagramDefect::state: return "a state that this version does not know";
  }
  return "";
}

void encode(const CommandDatagram& datagram, CommandBytes& bytes) noexcept {
  begin(bytes, kCommandMagic, datagram.displacement_m.size());
  put(bytes, kSequenceAt, datagram.sequence);
  put(bytes, kLoopCountAt, datagram.loop_count);
  put(bytes, kStateAt, static_cast<std::uint8_t>(datagram.request));
  put(bytes, kControlPeriodAt, datagram.control_period_ns);
  put(bytes, kTimeAt, std::bit_cast<std::uint64_t>(datagram.time_ns));
  put(bytes, kDisplacementAt, datagram.displacement_m);
  seal(bytes);
}

void encode(const MeasurementDatagram& datagram, MeasurementBytes& bytes) noexcept {
  HYBRIDTEST_ASSERT(datagram.force_n.size() == datagram.displacement_m.size());
  begin(bytes, kMeasurementMagic, datagram.displacement_m.size());
  put(bytes, kSequenceAt, datagram.sequence);
  put(bytes, kCommandSequenceAt, datagram.command_sequence);
  put(bytes, kStateAt, static_cast<std::uint8_t>(datagram.state));
  put(bytes, kStatusAt, datagram.status);
  put(bytes, kDiscardedAt, datagram.discarded);
  put(bytes, kTimeAt, std::bit_cast<std::uint64_t>(datagram.time_ns));
  put(bytes, kDisplacementAt, datagram.displacement_m);
  put(bytes, kForceAt, datagram.force_n);
  seal(bytes);
}

DatagramDefect decode(std::span<const std::byte> bytes, CommandDatagram& datagram) noexcept {
  const auto defect =
      defect_of(bytes, kCommandMagic, kCommandBytes, static_cast<std::uint8_t>(ControllerRequest::stop));
  if (defect != DatagramDefect::none) return defect;
  datagram.sequence = get<std::uint32_t>(bytes, kSequenceAt);
  datagram.loop_count = get<std::uint32_t>(bytes, kLoopCountAt);
  datagram.request = static_cast<ControllerRequest>(get<std::uint8_t>(bytes, kStateAt));
  datagram.control_period_ns = get<std::uint32_t>(bytes, kControlPeriodAt);
  datagram.time_ns = std::bit_cast<std::int64_t>(get<std::uint64_t>(bytes, kTimeAt));
  get(bytes, kDisplacementAt, datagram.displacement_m);
  return defect;
}

DatagramDefect decode(std::span<const std::byte> bytes, MeasurementDatagram& datagram) noexcept {
  const auto defect =
      defect_of(bytes, kMeasurementMagic, kMeasurementBytes, static_cast<std::uint8_t>(ControllerState::fault));
  if (defect != DatagramDefect::none) return defect;
  datagram.sequence = get<std::uint32_t>(bytes, kSequenceAt);
  datagram.command_sequence = get<std::uint32_t>(bytes, kCommandSequenceAt);
  datagram.state = static_cast<ControllerState>(get<std::uint8_t>(bytes, kStateAt));
  datagram.status = get<std::uint16_t>(bytes, kStatusAt);
  datagram.discarded = get<std::uint32_t>(bytes, kDiscardedAt);
  datagram.time_ns = std::bit_cast<std::int64_t>(get<std::uint64_t>(bytes, kTimeAt));
  get(bytes, kDisplacementAt, datagram.displacement_m);
  get(bytes, kForceAt, datagram.force_n);
  return defect;
}

}  // namespace hybridtest
