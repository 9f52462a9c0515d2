#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "core/time.hpp"

namespace hybridtest {

/// Datagrams to and from one peer. A datagram may be lost, duplicated or overtaken by a later one.
class DatagramPort {
 public:
  virtual ~DatagramPort() = default;

  /// Must be called before anything is sent or received. A second call opens a new socket.
  /// @throws std::runtime_error with the error of the operating system.
  virtual void open() = 0;
  /// Sends at once or not at all. From any thread; before open() it sends nothing.
  virtual bool send(std::span<const std::byte> datagram) noexcept = 0;
  /// Takes the oldest datagram that has arrived, truncated to the size of `buffer`.
  /// @param patience   longest time to wait for one; zero: no wait. On return the time that is left,
  ///                   zero when none came.
  /// @return its size; std::nullopt when none came.
  [[nodiscard]] virtual std::optional<std::size_t> receive(std::span<std::byte> buffer,
                                                           Duration& patience) noexcept = 0;
};

}  // namespace hybridtest
