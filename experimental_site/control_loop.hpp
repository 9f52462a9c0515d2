#pragma once

#include <memory>
#include <vector>

#include "compensation/compensator.hpp"
#include "compensation/force_compensator.hpp"
#include "core/node.hpp"
#include "core/ports.hpp"
#include "core/records.hpp"
#include "experimental_site/energy_error.hpp"
#include "experimental_site/interlocks.hpp"
#include "experimental_site/loop_messages.hpp"
#include "experimental_site/rigs/rig.hpp"
#include "experimental_site/trajectory.hpp"

namespace hybridtest {

struct ControlLoopSettings {
  CouplingMode mode = CouplingMode::lockstep;
  int dofs = 1;
  int periods_per_step = 1;  // whole control periods fill a coupling step
  double step_s = 0.0;       // coupling step in site time [s]
  double time_scale = 1.0;   // site time over model time
  SiteLimits limits;
  double return_time_s = 2.0;  // ramp back to zero at the end, site time
};

struct ControlLoopPorts {
  Inbox<LoopRequest>& requests;
  Outbox<LoopReport>& reports;
  Outbox<SignalSample>& signals;
};

/// One per interface degree of freedom each.
struct SiteCompensation {
  std::vector<std::unique_ptr<Compensator>> commands;
  std::vector<std::unique_ptr<ForceCompensator>> forces;
};

/// The part of a site that stands between targets and the rig, once per control period:
/// trajectory, compensator, motion limits, interlocks, exchange with the rig, force compensator,
/// record. Interlocks judge forces as measured; the coordinator gets them as compensated.
///
/// In lockstep, control periods follow each other as fast as targets come; in paced mode each
/// has its own time and those missed are made up for at once, so that the rig sees every one.
/// Allocates, locks and logs nothing after construction.
class ControlLoop final : public Node {
 public:
  ControlLoop(const ControlLoopSettings& settings, Rig& rig, SiteCompensation compensation,
              EnergyErrorMonitor energy_error, ControlLoopPorts ports, RowSink& control_record);

  [[nodiscard]] Instant advance(Instant now) noexcept override;

  [[nodiscard]] static TableLayout control_layout(int dofs);

 private:
  /// disarmed -> standing (armed, commands stay at zero) -> running -> holding or ramping -> at_rest
  enum class Phase : std::uint8_t { disarmed, standing, running, holding, ramping, at_rest };

  void obey(const LoopRequest& request, Instant now) noexcept;
  void arm(Instant now) noexcept;
  void stop() noexcept;
  void come_to_rest() noexcept;
  void begin_ramp() noexcept;

  [[nodiscard]] bool has_due_period(Instant now) const noexcept;
  [[nodiscard]] Instant next_wake(Instant now) const noexcept;
  void run_period() noexcept;
  void shape_command() noexcept;
  void limit_motion() noexcept;
  void ramp_command() noexcept;
  void exchange() noexcept;
  void compensate_forces() noexcept;
  [[nodiscard]] bool passes_interlocks() noexcept;
  void trip(const InterlockVerdict& verdict) noexcept;
  void report_measurement(const ReachedTarget& reached) noexcept;
  void record() noexcept;

  ControlLoopSettings settings_;
  Rig& rig_;
  SiteCompensation compensation_;
  EnergyErrorMonitor energy_error_;
  ControlLoopPorts ports_;
  RowSink& control_record_;
  Trajectory trajectory_;
  double period_s_;

  Phase phase_ = Phase::disarmed;
  bool is_paused_ = false;
  bool stop_was_asked_ = false;
  FaultFlags faults_ = FaultFlags::none;
  Instant armed_at_{};
  Instant last_target_at_{};
  double command_age_s_ = 0.0;
  bool rig_fault_ = false;

  ActuatorCommand command_;
  MeasurementFlags motion_flags_ = MeasurementFlags::none;
  InterfaceVector wanted_command_m_;
  InterfaceVector last_target_m_;
  InterfaceVector no_motion_;
  RigFeedback feedback_;
  RigFeedback feedback_before_;
  InterfaceVector compensated_force_n_;
  InterfaceVector compensated_force_before_n_;
  InterfaceVector ramp_begin_m_;
  std::int64_t ramp_periods_ = 0;
  std::int64_t ramp_period_ = 0;
  std::vector<double> row_;
};

}  // namespace hybridtest
