#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "core/time.hpp"
#include "transport/waker.hpp"

struct sockaddr_in;

namespace hybridtest::fast_dds {

/// A UDP socket that is read by the thread which waits on the Waker of a participant.
///
/// While that thread does something else for long (a model that computes, a full disk), or where there is none, a
/// thread of its own stands in, so that the peers are answered all the same.
class PolledSocket final : public Reception {
 public:
  /// Takes one datagram: its bytes, their number, and the sender's address and port, both in the order of the host.
  using Sink = std::function<void(const std::uint8_t*, std::uint32_t, std::uint32_t, std::uint16_t)>;

  /// How long the waiting thread may be away before the other one stands in. Only then: what another thread reads may
  /// have been sent after the instant that the waiting thread's node works with, and a latency would be negative.
  static constexpr Duration kAbsence = std::chrono::milliseconds{50};

  /// @param busy_poll    how long await() looks at the socket before it sleeps.
  /// @param when_woken   called before await() returns because something has arrived; may be empty.
  /// @throws std::runtime_error when the operating system has no descriptor left.
  explicit PolledSocket(Duration busy_poll, std::function<void()> when_woken = nullptr);
  ~PolledSocket() override;
  PolledSocket(const PolledSocket&) = delete;
  PolledSocket& operator=(const PolledSocket&) = delete;

  /// Binds to the port, of the loopback interface alone or of all. At most once.
  /// @return false when it is taken.
  [[nodiscard]] bool open(std::uint16_t port, bool loopback_only, std::uint32_t datagram_bytes_max, Sink sink);
  /// After this the sink is not called any more.
  void close() noexcept;
  [[nodiscard]] bool is_open_at(std::uint16_t port) const noexcept;

  void receive() noexcept override;
  [[nodiscard]] bool await(std::chrono::steady_clock::time_point deadline) noexcept override;
  void interrupt() noexcept override;

 private:
  void read() noexcept;
  void stand_in() noexcept;
  [[nodiscard]] bool is_someone_there(std::uint64_t& visits_seen) const noexcept;

  const Duration busy_poll_;
  const std::function<void()> when_woken_;
  const int interruption_;  // descriptor, readable after interrupt()
  const int end_;           // descriptor, readable when the stand-in must end
  std::atomic<int> socket_{-1};
  std::atomic<std::uint16_t> port_{0};  // 0 while closed
  std::mutex mutex_;                    // held while the sink is called
  Sink sink_;
  std::vector<std::uint8_t> datagram_;
  std::atomic<bool> is_awaited_{false};
  std::atomic<std::uint64_t> visits_{0};  // counts calls of await() and of receive()
  std::thread stand_in_;
};

}  // namespace hybridtest::fast_dds
