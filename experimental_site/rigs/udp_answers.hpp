#pragma once

#include <cstdint>
#include <span>

#include "experimental_site/rigs/udp_datagram.hpp"

namespace hybridtest {

/// Puts the datagrams from the controller in order: keeps the newest measurement and counts those that
/// were lost, overtaken or damaged.
class UdpAnswers {
 public:
  struct Counts {
    std::uint32_t received = 0;  // measurements newer than all before
    std::uint32_t skipped = 0;   // sequence numbers left out: lost or overtaken
    std::uint32_t stale = 0;     // came twice or after a newer one
    std::uint32_t invalid = 0;   // not a datagram of this protocol, or not an answer to this rig
  };

  explicit UdpAnswers(int actuators);

  /// Starts a new connection; the counts are kept. The next measurement is the first, with any number.
  /// @param next_command   sequence number of the first command of the new connection.
  void begin(std::uint32_t next_command) noexcept;
  /// @param last_command   sequence number of the newest command sent; an answer to a later one is invalid.
  void take(std::span<const std::byte> bytes, std::uint32_t last_command) noexcept;

  /// Since begin(): whether a measurement has come, and the newest one.
  [[nodiscard]] bool has_any() const noexcept { return has_any_; }
  [[nodiscard]] const MeasurementDatagram& newest() const noexcept { return newest_; }
  [[nodiscard]] const Counts& counts() const noexcept { return counts_; }
  /// Defect of the last invalid datagram.
  [[nodiscard]] DatagramDefect last_defect() const noexcept { return last_defect_; }

 private:
  [[nodiscard]] DatagramDefect read(std::span<const std::byte> bytes) noexcept;
  [[nodiscard]] bool answers_one_of(std::uint32_t last_command) const noexcept;

  int actuators_;
  std::uint32_t first_command_ = 0;
  bool has_any_ = false;
  MeasurementDatagram newest_;
  MeasurementDatagram arrived_;
  Counts counts_;
  DatagramDefect last_defect_ = DatagramDefect::none;
};

}  // namespace hybridtest
