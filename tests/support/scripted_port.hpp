#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <utility>
#include <vector>

#include "experimental_site/rigs/datagram_port.hpp"

namespace hybridtest {

/// A peer made of a lambda: it receives each datagram sent and decides what arrives, and when. Waiting takes no time:
/// the timeout ends at once when nothing has arrived.
class ScriptedPort final : public DatagramPort {
 public:
  using Datagram = std::vector<std::byte>;
  /// @param arriving   what can be received, oldest first; add to it.
  using Peer = std::function<void(const Datagram& sent, std::deque<Datagram>& arriving)>;

  explicit ScriptedPort(Peer peer) : peer_{std::move(peer)} {}

  void open() override {
    if (on_open) on_open();
    is_open_ = true;
  }
  bool send(std::span<const std::byte> datagram) noexcept override {
    if (!is_open_) return false;
    ++sent;
    peer_({datagram.begin(), datagram.end()}, arriving);
    return true;
  }
  [[nodiscard]] std::optional<std::size_t> receive(std::span<std::byte> buffer, Duration& patience) noexcept override {
    if (arriving.empty()) {
      waited += std::exchange(patience, Duration::zero());
      return {};
    }
    const Datagram datagram = std::move(arriving.front());
    arriving.pop_front();
    const std::size_t size = std::min(buffer.size(), datagram.size());
    std::copy_n(datagram.begin(), size, buffer.begin());
    return size;
  }

  std::function<void()> on_open;  // may throw
  std::deque<Datagram> arriving;
  int sent = 0;
  Duration waited{};

 private:
  Peer peer_;
  bool is_open_ = false;
};

}  // namespace hybridtest
