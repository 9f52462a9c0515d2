#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "compensation/compensator.hpp"
#include "compensation/force_compensator.hpp"
#include "core/node.hpp"
#include "core/ports.hpp"
#include "core/records.hpp"
#include "experimental_site/closing_motion.hpp"
#include "experimental_site/control_record.hpp"
#include "experimental_site/energy_error.hpp"
#include "experimental_site/fading_offset.hpp"
#include "experimental_site/interlocks.hpp"
#include "experimental_site/loop_messages.hpp"
#include "experimental_site/rigs/rig.hpp"
#include "experimental_site/tracking_indicator.hpp"
#include "experimental_site/trajectory.hpp"
#include "experimental_site/zero_offsets.hpp"

namespace hybridtest {

struct ControlLoopSettings {
  CouplingMode mode = CouplingMode::lockstep;
  int dofs = 1;
  int periods_per_step = 1;  // whole control periods fill a coupling step
  double step_s = 0.0;       // coupling step in site time [s]
  double time_scale = 1.0;   // site time over model time
  SiteLimits limits;
  InterlockRules rules = default_interlock_rules();
  double tracking_window_s = 1.0;  // of the tracking indicator, site time
  TrajectorySettings trajectory;
  double ramp_in_s = 0.0;              // to a first target away from the position of the rig; at least one step
  bool captures_zero_offsets = false;  // at arming
  bool returns_at_end = true;          // else it holds its position
  double return_time_s = 2.0;          // ramp back to zero, site time
};

struct ControlLoopPorts {
  Inbox<LoopRequest>& requests;
  Outbox<LoopReport>& reports;
};

/// One per interface degree of freedom each.
struct SiteCompensation {
  std::vector<std::unique_ptr<Compensator>> commands;
  std::vector<std::unique_ptr<ForceCompensator>> forces;
};

/// The control loop of a site. Each control period runs in this order: trajectory, compensator,
/// motion limits, interlocks, exchange with the rig, force compensator, record. Interlocks judge the
/// measured forces; the coordinator gets the compensated ones. The action of an interlock can only
/// become more severe, except that a hold may clear; the loop then continues from rest.
///
/// In lockstep, control periods run as soon as there is a target. In the other modes each has its own
/// time, and missed periods run at once, so that the rig gets every one of them.
/// Allocates, locks and logs nothing after construction.
class ControlLoop final : public Node {
 public:
  ControlLoop(const ControlLoopSettings& settings, Rig& rig, SiteCompensation compensation,
              EnergyErrorMonitor energy_error, ControlLoopPorts ports, RowSink& control_record);

  [[nodiscard]] Instant advance(Instant now) noexcept override;

  [[nodiscard]] static TableLayout control_layout(int dofs) { return ControlRecord::layout(dofs); }

 private:
  /// disarmed -> zeroing (armed, captures the zero offsets) -> standing (commands stay at zero) ->
  /// running -> holding or closing (stops, or returns to zero) -> at_rest
  enum class Phase : std::uint8_t { disarmed, zeroing, standing, running, holding, closing, at_rest };

  void obey(const LoopRequest& request, Instant now) noexcept;
  void arm(Instant now) noexcept;
  void start(Instant now) noexcept;
  void resume(Instant now) noexcept;
  void take_target(const TargetPoint& target, Instant now) noexcept;
  void stop() noexcept;
  void come_to_rest() noexcept;
  void begin_return() noexcept;

  [[nodiscard]] bool is_paced_by_time() const noexcept { return settings_.mode != CouplingMode::lockstep; }
  [[nodiscard]] bool follows_targets() const noexcept;
  [[nodiscard]] Instant period_due() const noexcept;
  [[nodiscard]] bool has_due_period(Instant now) const noexcept;
  [[nodiscard]] Instant next_wake(Instant now) const noexcept;
  void run_period() noexcept;
  void shape_command() noexcept;
  void limit_motion() noexcept;
  void exchange() noexcept;
  void capture_zero_offsets() noexcept;
  void compensate_forces() noexcept;
  void observe_tracking() noexcept;
  [[nodiscard]] InterlockInput interlock_input(bool is_new_sample) const noexcept;
  [[nodiscard]] bool passes_interlocks(bool is_new_sample) noexcept;
  void act(const InterlockVerdict& verdict) noexcept;
  void hold(bool is_final) noexcept;
  void go_on() noexcept;
  void report(const InterlockTrip& trip) noexcept;
  [[nodiscard]] std::pair<double, double> values_of(const InterlockTrip& trip) const noexcept;
  [[nodiscard]] std::pair<double, double> first_not_finite() const noexcept;
  void report_cleared() noexcept;
  void report_measurement() noexcept;
  void record() noexcept;
  [[nodiscard]] double model_time_s() const noexcept;

  ControlLoopSettings settings_;
  double period_s_;
  Rig& rig_;
  SiteCompensation compensation_;
  EnergyErrorMonitor energy_error_;
  TrackingIndicator tracking_;
  ControlLoopPorts ports_;
  LoopRequest request_;                        // taken last
  LoopReport measurement_{StepMeasurement{}};  // reported last
  ControlRecord record_;
  Trajectory trajectory_;
  FadingOffset start_offset_;   // from the position of the rig to the start of the path
  FadingOffset resume_offset_;  // from the held command to that of the compensator after it
  ClosingMotion closing_;
  ZeroOffsets zero_offsets_;

  Phase phase_ = Phase::disarmed;
  Phase phase_before_hold_ = Phase::disarmed;
  bool hold_is_final_ = false;
  bool is_paused_ = false;
  bool stop_was_asked_ = false;
  FaultFlags faults_ = FaultFlags::none;
  InterlockState interlocks_;
  Instant armed_at_{};
  Duration clock_shift_{};         // of the control periods
  Duration wanted_clock_shift_{};  // approached slowly
  Instant last_target_at_{};
  double command_age_s_ = 0.0;
  bool rig_fault_ = false;
  bool emergency_stop_ = false;

  ActuatorCommand command_;
  SiteVector command_before_m_;
  MeasurementFlags motion_flags_ = MeasurementFlags::none;
  SiteVector compensated_command_m_;
  SiteVector wanted_command_m_;  // with the offset after a hold
  ReachedTarget reached_;        // not measured yet
  bool is_reached_ = false;      // there is one
  TrajectoryPoint target_;       // with the offset at the start
  SiteVector no_motion_;
  RigFeedback reading_;   // of the rig; unchanged where the rig reports a fault
  RigFeedback feedback_;  // minus the zero offsets
  RigFeedback feedback_before_;
  SiteVector compensated_force_n_;
  SiteVector compensated_force_before_n_;
};

}  // namespace hybridtest
