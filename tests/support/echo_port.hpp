#pragma once

#include <algorithm>
#include <mutex>
#include <utility>

#include "experimental_site/rigs/datagram_port.hpp"
#include "experimental_site/rigs/udp_datagram.hpp"

namespace hybridtest {

/// A controller without state or network: accepts every command, follows it when it is active, and answers
/// at once. Allocates nothing; may be sent to from several threads.
class EchoPort final : public DatagramPort {
 public:
  explicit EchoPort(double stiffness_n_per_m) : stiffness_n_per_m_{stiffness_n_per_m} {}

  void open() override {}
  bool send(std::span<const std::byte> datagram) noexcept override {
    const std::lock_guard lock{mutex_};
    CommandDatagram command;
    if (decode(datagram, command) != DatagramDefect::none) return false;
    MeasurementDatagram answer;
    answer.sequence = ++sequence_;
    answer.command_sequence = command.sequence;
    answer.state = static_cast<ControllerState>(command.request);
    if (displacement_m_.size() == 0) displacement_m_ = SiteVector::Zero(command.displacement_m.size());
    if (command.request == ControllerRequest::active) displacement_m_ = command.displacement_m;
    answer.displacement_m = displacement_m_;
    answer.force_n = stiffness_n_per_m_ * displacement_m_;
    encode(answer, bytes_);
    has_answer_ = true;
    return true;
  }
  [[nodiscard]] std::optional<std::size_t> receive(std::span<std::byte> buffer, Duration& patience) noexcept override {
    const std::lock_guard lock{mutex_};
    if (!std::exchange(has_answer_, false)) {
      patience = Duration::zero();
      return {};
    }
    std::ranges::copy(bytes_, buffer.begin());
    return bytes_.size();
  }

 private:
  std::mutex mutex_;
  double stiffness_n_per_m_;
  std::uint32_t sequence_ = 0;
  SiteVector displacement_m_;
  MeasurementBytes bytes_{};
  bool has_answer_ = false;
};

}  // namespace hybridtest
