#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <utility>

#include "experimental_site/rigs/udp_datagram.hpp"
#include "tests/support/scripted_port.hpp"

namespace hybridtest {

/// A laboratory's controller after docs/udp_rig.md: keeps to the states, answers every command that it takes,
/// goes where it is told at once, and measures a spring.
class ScriptedController {
 public:
  explicit ScriptedController(double stiffness_n_per_m = 1.0e6) : stiffness_n_per_m_{stiffness_n_per_m} {}

  /// For a ScriptedPort; this controller outlives the port.
  [[nodiscard]] ScriptedPort::Peer peer() {
    return [this](const ScriptedPort::Datagram& sent, std::deque<ScriptedPort::Datagram>& arriving) {
      CommandDatagram command;
      if (decode(sent, command) != DatagramDefect::none) return;
      commands.push_back(command);
      if (!is_alive || !take(command)) return;
      const MeasurementDatagram answer = measure();
      deliver(bytes_of(answer), arriving);
    };
  }

  [[nodiscard]] static ScriptedPort::Datagram bytes_of(const MeasurementDatagram& measurement) {
    MeasurementBytes bytes;
    encode(measurement, bytes);
    return {bytes.begin(), bytes.end()};
  }

  bool is_alive = true;
  ControllerState state = ControllerState::inactive;
  bool refuses_to_move = false;  // stays inactive when it is asked to be active
  std::uint16_t status = 0;
  SiteVector displacement_m;
  std::vector<CommandDatagram> commands;  // every one that came
  /// How an answer is delivered: at once and complete by default.
  std::function<void(ScriptedPort::Datagram answer, std::deque<ScriptedPort::Datagram>& arriving)> deliver =
      [](ScriptedPort::Datagram answer, std::deque<ScriptedPort::Datagram>& arriving) {
        arriving.push_back(std::move(answer));
      };

 private:
  bool take(const CommandDatagram& command) {
    if (displacement_m.size() == 0) displacement_m = SiteVector::Zero(command.displacement_m.size());
    const bool counts_anew = state != ControllerState::active && command.request == ControllerRequest::inactive;
    if (!counts_anew && command.sequence <= newest_command_) {
      ++discarded_;
      return false;
    }
    newest_command_ = command.sequence;
    if (state == ControllerState::fault) return true;
    if (command.request == ControllerRequest::inactive) state = ControllerState::inactive;
    if (command.request == ControllerRequest::stop) state = ControllerState::stopped;
    if (command.request == ControllerRequest::active && state == ControllerState::inactive && !refuses_to_move) {
      state = ControllerState::active;
    }
    if (state == ControllerState::active) displacement_m = command.displacement_m;
    return true;
  }

  [[nodiscard]] MeasurementDatagram measure() {
    MeasurementDatagram answer;
    answer.sequence = ++sequence_;
    answer.command_sequence = newest_command_;
    answer.state = state;
    answer.status = status;
    answer.discarded = discarded_;
    answer.displacement_m = displacement_m;
    answer.force_n = stiffness_n_per_m_ * displacement_m;
    return answer;
  }

  double stiffness_n_per_m_;
  std::uint32_t newest_command_ = 0;
  std::uint32_t sequence_ = 0;
  std::uint32_t discarded_ = 0;
};

}  // namespace hybridtest
