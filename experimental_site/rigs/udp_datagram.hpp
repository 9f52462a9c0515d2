#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/interface_vector.hpp"

/// The two datagrams between a site and a laboratory's controller, protocol version 1. Offsets,
/// units and rules: docs/udp_rig.md. Fixed size, little endian, doubles after IEEE 754.
namespace hybridtest {

inline constexpr std::uint16_t kUdpProtocolVersion = 1;

/// Request of the site to the controller.
enum class ControllerRequest : std::uint8_t {
  inactive = 0,  // measure, do not move
  active = 1,    // follow the commands
  stop = 2,      // bring the actuators to rest and keep them there until `inactive` is requested
};

/// State of the controller.
enum class ControllerState : std::uint8_t { inactive = 0, active = 1, stopped = 2, fault = 3 };

/// Bits of MeasurementDatagram::status.
inline constexpr std::uint16_t kFollowsDatagrams = 1U << 0U;  // its time follows the loop count and not a clock
inline constexpr std::uint16_t kWatchdogExpired = 1U << 1U;   // no new command within the watchdog time
inline constexpr std::uint16_t kCommandLimited = 1U << 2U;    // the controller has limited a command
inline constexpr std::uint16_t kEmergencyStopped = 1U << 3U;  // its emergency stop is pressed

/// Site to controller.
struct CommandDatagram {
  std::uint32_t sequence = 0;    // increases by one with every datagram
  std::uint32_t loop_count = 0;  // number of exchanges of the control loop; constant while the loop does not run
  ControllerRequest request = ControllerRequest::inactive;
  std::uint32_t control_period_ns = 0;  // [ns] between two loop counts
  std::int64_t time_ns = 0;             // [ns] of the command, since arming
  SiteVector displacement_m;            // [m] one per actuator; followed only with `active`
  bool operator==(const CommandDatagram&) const = default;
};

/// Controller to site.
struct MeasurementDatagram {
  std::uint32_t sequence = 0;          // increases by one with every datagram
  std::uint32_t command_sequence = 0;  // of the newest command accepted; 0 before the first
  ControllerState state = ControllerState::inactive;
  std::uint16_t status = 0;
  std::uint32_t discarded = 0;  // commands not accepted: damaged, or older than the newest
  std::int64_t time_ns = 0;     // [ns] of the measurement, by the controller's clock
  SiteVector displacement_m;    // [m] one per actuator
  SiteVector force_n;           // [N] one per actuator
  bool operator==(const MeasurementDatagram&) const = default;
};

inline constexpr std::size_t kCommandBytes = 132;
inline constexpr std::size_t kMeasurementBytes = 228;
using CommandBytes = std::array<std::byte, kCommandBytes>;
using MeasurementBytes = std::array<std::byte, kMeasurementBytes>;

/// Why bytes are not a datagram of this protocol.
enum class DatagramDefect : std::uint8_t { none, size, magic, version, checksum, actuators, state };
/// Text for messages, such as "another protocol version".
[[nodiscard]] std::string_view describe(DatagramDefect defect) noexcept;

/// @param datagram   with 1 to kMaxSiteDofs actuators.
void encode(const CommandDatagram& datagram, CommandBytes& bytes) noexcept;
void encode(const MeasurementDatagram& datagram, MeasurementBytes& bytes) noexcept;

/// @param datagram   unchanged when the bytes have a defect.
[[nodiscard]] DatagramDefect decode(std::span<const std::byte> bytes, CommandDatagram& datagram) noexcept;
[[nodiscard]] DatagramDefect decode(std::span<const std::byte> bytes, MeasurementDatagram& datagram) noexcept;

/// Checksum of the datagrams: CRC-32 of IEEE 802.3 (reflected, polynomial 0x04C11DB7, first and last inverted), as in
/// zlib and PNG; of "123456789" it is 0xCBF43926.
[[nodiscard]] std::uint32_t crc32(std::span<const std::byte> bytes) noexcept;

}  // namespace hybridtest
