#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "core/random.hpp"

namespace hybridtest {

/// Sends packets that nobody should send to every participant of a DDS domain on this host, as fast as every tenth of a
/// millisecond, until it is destroyed.
class PacketFuzzer {
 public:
  enum class Kind {
    noise,               // random bytes, half of them behind a valid RTPS header
    malformed_packets,   // parts that RTPS knows, with random contents, often to every reader
    cut_packets,         // packets of the test itself, cut short or with other lengths in their parts
    altered_packets,     // packets of the test itself with other bits, which may be well formed
    disordered_packets,  // packets of the test itself once more, or with their parts exchanged or among those of
                         // another
    forged_packets,  // in the name of a participant of the test: well-formed messages of the protocol that are not true
  };

  /// @throws std::runtime_error where the operating system does not allow it, see why_not().
  PacketFuzzer(int domain, std::uint64_t seed, Kind kind);
  PacketFuzzer(const PacketFuzzer&) = delete;
  PacketFuzzer& operator=(const PacketFuzzer&) = delete;

  /// Why this process may not listen to packets; empty when it may.
  [[nodiscard]] static std::string why_not();

  [[nodiscard]] std::uint64_t sent() const noexcept { return sent_; }

 private:
  struct Packet {
    std::uint16_t port = 0;
    std::vector<std::uint8_t> bytes;
  };

  void run(const std::stop_token& stop);
  void listen();
  [[nodiscard]] Packet next();
  [[nodiscard]] std::vector<std::uint8_t> malformed();
  void cut(std::vector<std::uint8_t>& bytes);
  void alter(std::vector<std::uint8_t>& bytes);
  void disorder(std::vector<std::uint8_t>& bytes);
  void forge(std::vector<std::uint8_t>& bytes);
  void forge_announcement(std::vector<std::uint8_t>& bytes);
  [[nodiscard]] std::size_t below(std::size_t count) noexcept { return static_cast<std::size_t>(random_.below(count)); }
  [[nodiscard]] std::uint8_t byte() noexcept { return static_cast<std::uint8_t>(random_.below(256)); }

  int first_port_;
  Kind kind_;
  Random random_;
  int listener_ = -1;
  int sender_ = -1;
  std::uint16_t own_port_ = 0;
  std::vector<Packet> heard_;
  std::size_t oldest_ = 0;
  std::atomic<std::uint64_t> sent_{0};
  std::jthread thread_;  // the last member: it uses the others
};

}  // namespace hybridtest
