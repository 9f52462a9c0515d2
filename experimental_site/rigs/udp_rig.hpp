#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "experimental_site/rigs/datagram_port.hpp"
#include "experimental_site/rigs/rig.hpp"
#include "experimental_site/rigs/udp_answers.hpp"
#include "experimental_site/rigs/udp_datagram.hpp"

namespace hybridtest {

/// A laboratory's real-time controller (Simulink Real-Time, Speedgoat, dSPACE, LabVIEW RT) behind a
/// UDP gateway: one datagram of commands out, the newest measurement back; docs/udp_rig.md.
///
/// These are faults: the controller has not answered a new command for `watchdog`, reports a fault, or
/// has left the state `active` by itself. The feedback is the newest measurement received.
/// stop_motion() sends the request several times, because a datagram may be lost; every exchange()
/// after it repeats the request. arm() needs a connect() after the last stop_motion().
class UdpRig final : public Rig {
 public:
  struct Settings {
    std::string name;                // of the controller, for messages
    int actuators = 1;               // 1 to kMaxSiteDofs
    Duration control_period{};       // from one exchange() to the next; positive, below 4.29 s
    Duration watchdog{};             // at least two control periods
    Duration reply_wait{};           // longest wait of exchange() for the answer to its own command
    Duration connect_timeout{};      // of connect() and of arm()
    bool follows_datagrams = false;  // the time of the controller follows the exchanges and not a clock
  };

  /// @throws ConfigError for values outside these ranges, and for a wait of a control period or more
  ///         for a controller with a clock.
  UdpRig(const Settings& settings, std::unique_ptr<DatagramPort> port);

  /// Columns of the table `rig_link`, one row per exchange().
  [[nodiscard]] static TableLayout link_layout();
  void record_to(const RigTables& tables) override;

  /// @throws std::runtime_error when no controller with this number of actuators is ready to be armed in time.
  void connect() override;
  /// @throws std::runtime_error without a connect(), when stopped after it, or when the controller does not
  ///         become active in time.
  void arm() override;
  [[nodiscard]] RigStatus exchange(const ActuatorCommand& command, RigFeedback& feedback) noexcept override;
  [[nodiscard]] RigFault fault() const noexcept override;
  void stop_motion() noexcept override;

  [[nodiscard]] const UdpAnswers::Counts& counts() const noexcept { return answers_.counts(); }

 private:
  enum class Phase : std::uint8_t { disconnected, connected, armed, stopped };

  [[nodiscard]] bool repeat_until(ControllerRequest request, const std::function<bool()>& is_done);
  /// @return its sequence number.
  std::uint32_t send(ControllerRequest request, const ActuatorCommand& command) noexcept;
  void take_answers(std::uint32_t awaited) noexcept;
  void watch() noexcept;
  [[nodiscard]] RigStatus status(Phase phase) const noexcept;
  [[nodiscard]] std::string silence() const;
  void record(std::int64_t sample, std::uint32_t sent) noexcept;

  Settings settings_;
  std::unique_ptr<DatagramPort> port_;
  std::int64_t watchdog_samples_;
  RowSink* link_record_ = nullptr;
  std::vector<double> row_;

  // Used by stop_motion() from any thread.
  std::atomic<Phase> phase_{Phase::disconnected};
  std::atomic<std::uint32_t> sequence_{0};
  std::atomic<std::uint32_t> loop_count_{0};

  ActuatorCommand rest_;  // sent while there is no command
  UdpAnswers answers_;
  std::uint32_t answered_ = 0;  // newest command known to have reached the controller
  std::int64_t silent_samples_ = 0;
};

}  // namespace hybridtest
