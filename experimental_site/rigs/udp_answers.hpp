#pragma once

#include <cstdint>
#include <span>

#include "experimental_site/rigs/udp_datagram.hpp"

namespace hybridtest {

/// What has come from the controller, put in order: keeps the newest measurement and counts what was
/// lost, overtaken or damaged.
class UdpAnswers {
 public:
  struct Counts {
    std::uint32_t received = 0;  // measurements newer than all before
    std::uint32_t skipped = 0;   // sequence numbers passed over: lost, or overtaken
    std::uint32_t stale = 0;     // came twice or behind a newer one
    std::uint32_t invalid = 0;   // no datagram of this protocol, or not an answer to this rig
  };

  explicit UdpAnswers(int actuators);

  /// Forgets the controller, not the counts: the next measurement is the first, whatever its number.
  /// @param next_command   sequence number of the first command that counts from now on.
  void begin(std::uint32_t next_command) noexcept;
  /// @param last_command   sequence number of the newest command sent; nothing can have answered a later one.
  void take(std::span<const std::byte> bytes, std::uint32_t last_command) noexcept;

  /// Since begin(): whether any has come, and the newest one.
  [[nodiscard]] bool has_any() const noexcept { return has_any_; }
  [[nodiscard]] const MeasurementDatagram& newest() const noexcept { return newest_; }
  [[nodiscard]] const Counts& counts() const noexcept { return counts_; }
  /// What was wrong with the last invalid one.
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
