#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "core/time.hpp"

namespace hybridtest {

/// To and from one peer, a datagram at a time; whatever is sent may be lost, doubled or overtaken.
class DatagramPort {
 public:
  virtual ~DatagramPort() = default;

  /// Once, before anything is sent or received; again, it begins anew.
  /// @throws std::runtime_error that says what the system refused.
  virtual void open() = 0;
  /// Sends at once or not at all; any thread, also before open().
  virtual bool send(std::span<const std::byte> datagram) noexcept = 0;
  /// Takes the oldest datagram that has arrived; cut off where it does not fit into `buffer`.
  /// @param patience   how long to wait for one at most, zero: not at all. What was waited is
  ///                   taken off, all of it when nothing came.
  /// @return its size; nothing when none came.
  [[nodiscard]] virtual std::optional<std::size_t> receive(std::span<std::byte> buffer,
                                                           Duration& patience) noexcept = 0;
};

}  // namespace hybridtest
