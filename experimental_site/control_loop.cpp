#include "experimental_site/control_loop.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/assert.hpp"
#include "core/message_copies.hpp"

namespace hybridtest {
namespace {

/// In lockstep the return to zero is not paced by a clock. After this many control periods the other
/// nodes of the thread run.
constexpr int kPeriodsPerAdvance = 256;

/// Shortest time from motion to standing.
constexpr double kHalt_s_min = 0.02;

/// By which a control period may be longer or shorter to follow the clock of the coordinator: four times what two
/// quartz clocks drift apart.
constexpr double kClockSlewMost = 4e-4;

/// Motion smaller than this share of the displacement limit does not scale the tracking indicator.
constexpr double kMotionShareMin = 0.05;

void copy_feedback(const RigFeedback& from, RigFeedback& to) noexcept {
  copy_values(from.displacement_m, to.displacement_m);
  copy_values(from.force_n, to.force_n);
}

double period_s(const ControlLoopSettings& settings) noexcept { return settings.step_s / settings.periods_per_step; }

ClosingMotionSettings closing_settings(const ControlLoopSettings& settings) noexcept {
  return {.period_s = period_s(settings),
          .halt_s = std::max(settings.step_s, kHalt_s_min),
          .return_time_s = settings.return_time_s,
          .displacement_limit_m = settings.limits.displacement_m,
          .velocity_limit_m_per_s = settings.limits.velocity_m_per_s};
}

}  // namespace

ControlLoop::ControlLoop(const ControlLoopSettings& settings, Rig& rig, SiteCompensation compensation,
                         EnergyErrorMonitor energy_error, ControlLoopPorts ports, RowSink& control_record)
    : settings_{settings},
      period_s_{period_s(settings)},
      rig_{rig},
      compensation_{std::move(compensation)},
      energy_error_{std::move(energy_error)},
      tracking_{settings.dofs, period_s_, settings.tracking_window_s, kMotionShareMin * settings.limits.displacement_m},
      ports_{ports},
      record_{settings.dofs, control_record},
      trajectory_{settings.dofs, settings.step_s, settings.time_scale, settings.trajectory},
      start_offset_{settings.dofs},
      resume_offset_{settings.dofs},
      closing_{closing_settings(settings), settings.dofs},
      zero_offsets_{settings.dofs, period_s_} {
  HYBRIDTEST_ASSERT(std::cmp_equal(compensation_.commands.size(), settings.dofs));
  HYBRIDTEST_ASSERT(std::cmp_equal(compensation_.forces.size(), settings.dofs));
  const SiteVector zero = SiteVector::Zero(settings.dofs);
  command_.displacement_m = zero;
  command_before_m_ = zero;
  wanted_command_m_ = zero;
  compensated_command_m_ = zero;
  target_ = trajectory_.point();
  no_motion_ = zero;
  feedback_ = {zero, zero};
  feedback_before_ = feedback_;
  reading_ = feedback_;
  compensated_force_n_ = zero;
  compensated_force_before_n_ = zero;
}

Instant ControlLoop::advance(Instant now) noexcept {
  while (ports_.requests.take(request_)) obey(request_, now);

  // A command is overdue only when there is no target that is still to be reached.
  const bool waits_for_target = follows_targets() && !is_paused_ && !trajectory_.has_target() && !is_reached_;
  command_age_s_ = waits_for_target ? to_seconds(now - last_target_at_) : 0.0;
  int periods = 0;
  for (; has_due_period(now) && periods < kPeriodsPerAdvance; ++periods) run_period();
  // In lockstep there are no control periods between two targets, so overdue commands are checked here. Where there was
  // one, it has checked the same values.
  if (!is_paced_by_time() && phase_ == Phase::running && periods == 0) static_cast<void>(passes_interlocks(false));
  return next_wake(now);
}

void ControlLoop::obey(const LoopRequest& request, Instant now) noexcept {
  struct Obey {
    ControlLoop& loop;
    Instant now;

    void operator()(const loop_request::Arm&) const noexcept { loop.arm(now); }
    void operator()(const loop_request::Start&) const noexcept { loop.start(now); }
    void operator()(const loop_request::Target& target) const noexcept { loop.take_target(target.point, now); }
    void operator()(const loop_request::ClockShift& clock) const noexcept { loop.wanted_clock_shift_ = clock.shift; }
    void operator()(const loop_request::Pause&) const noexcept { loop.is_paused_ = true; }
    void operator()(const loop_request::Resume&) const noexcept { loop.resume(now); }
    void operator()(const loop_request::Stop&) const noexcept { loop.stop(); }
    void operator()(const loop_request::EmergencyStop&) const noexcept {
      loop.emergency_stop_ = true;
      static_cast<void>(loop.passes_interlocks(false));
    }
  };
  std::visit(Obey{*this, now}, request);
}

void ControlLoop::arm(Instant now) noexcept {
  if (phase_ != Phase::disarmed) return;
  armed_at_ = now;
  try {
    rig_.arm();
  } catch (...) {
    faults_ |= FaultFlags::rig_fault;
    const RigFault fault = rig_.fault();
    ports_.reports.send(loop_report::ArmFailed{fault == RigFault::unknown ? RigFault::did_not_arm : fault});
    return;
  }
  for (auto& compensator : compensation_.commands) compensator->reset();
  for (auto& compensator : compensation_.forces) compensator->reset();
  energy_error_.reset();
  trajectory_.reset(no_motion_);
  zero_offsets_.reset();
  interlocks_ = {};
  if (settings_.captures_zero_offsets) {
    phase_ = Phase::zeroing;  // armed when they are captured
    return;
  }
  phase_ = Phase::standing;
  ports_.reports.send(loop_report::Armed{});
}

void ControlLoop::start(Instant now) noexcept {
  Phase& phase = phase_ == Phase::holding && !hold_is_final_ ? phase_before_hold_ : phase_;
  if (phase != Phase::standing) return;
  phase = Phase::running;
  last_target_at_ = now;
}

void ControlLoop::resume(Instant now) noexcept {
  is_paused_ = false;
  last_target_at_ = now;
  if (reset_by_operator(settings_.rules, interlocks_)) report_cleared();
}

void ControlLoop::take_target(const TargetPoint& target, Instant now) noexcept {
  if (!follows_targets()) return;
  if (!trajectory_.is_running()) {
    start_offset_.begin(no_motion_ - target.displacement_m, -target.velocity_m_per_s / settings_.time_scale,
                        std::max(settings_.ramp_in_s, settings_.step_s));
  }
  trajectory_.set_target(target);
  last_target_at_ = now;
}

bool ControlLoop::follows_targets() const noexcept {
  if (phase_ == Phase::running) return true;
  return phase_ == Phase::holding && phase_before_hold_ == Phase::running && !hold_is_final_;
}

void ControlLoop::stop() noexcept {
  if (std::exchange(stop_was_asked_, true)) return;
  constexpr auto kUntrustworthy = FaultFlags::not_finite | FaultFlags::rig_fault | FaultFlags::displacement_step |
                                  FaultFlags::force_step | FaultFlags::stuck_sensor;
  switch (phase_) {
    case Phase::disarmed:
    case Phase::zeroing:
    case Phase::standing: come_to_rest(); break;
    case Phase::running:
      closing_.begin(command_.displacement_m, (command_.displacement_m - command_before_m_) / period_s_,
                     settings_.returns_at_end);
      phase_ = Phase::closing;
      break;
    case Phase::holding:
      if (any(faults_ & kUntrustworthy) || !settings_.returns_at_end) {
        come_to_rest();
      } else {
        begin_return();
      }
      break;
    case Phase::closing: break;
    case Phase::at_rest: come_to_rest(); break;
  }
}

void ControlLoop::come_to_rest() noexcept {
  rig_.stop_motion();
  phase_ = Phase::at_rest;
  if (stop_was_asked_) ports_.reports.send(loop_report::AtRest{});
}

/// Starts at once from the present command.
void ControlLoop::begin_return() noexcept {
  closing_.begin(command_.displacement_m, no_motion_, true);
  phase_ = Phase::closing;
}

Instant ControlLoop::period_due() const noexcept {
  return armed_at_ + clock_shift_ + from_seconds(static_cast<double>(command_.sample) * period_s_);
}

bool ControlLoop::has_due_period(Instant now) const noexcept {
  if (phase_ == Phase::disarmed || phase_ == Phase::at_rest) return false;
  if (is_paced_by_time()) return now >= period_due();
  if (phase_ == Phase::zeroing || phase_ == Phase::closing) return true;
  return phase_ == Phase::running && trajectory_.has_target();
}

Instant ControlLoop::next_wake(Instant now) const noexcept {
  if (phase_ == Phase::disarmed || phase_ == Phase::at_rest) return kNever;
  if (has_due_period(now)) return now;
  if (is_paced_by_time()) return period_due();
  if (phase_ != Phase::running || is_paused_) return kNever;
  // One nanosecond past the limit: at the limit itself the command is not overdue yet.
  return last_target_at_ + from_seconds(settings_.limits.command_age_s) + Duration{1};
}

void ControlLoop::run_period() noexcept {
  command_.time_s = static_cast<double>(command_.sample) * period_s_;
  copy_values(command_.displacement_m, command_before_m_);
  motion_flags_ = MeasurementFlags::none;
  if (phase_ == Phase::running) {
    is_reached_ = trajectory_.advance(period_s_, reached_) || is_reached_;
    shape_command();
    if (passes_interlocks(false)) limit_motion();
  } else if (follows_targets()) {
    shape_command();  // keeps the compensator up to date while the site stands
  }
  if (phase_ == Phase::closing) {
    closing_.advance();
    command_.displacement_m = closing_.displacement_m();
    target_.displacement_m = command_.displacement_m;
  }
  exchange();
  if (phase_ == Phase::zeroing) capture_zero_offsets();
  if (follows_targets()) {
    compensate_forces();
    observe_tracking();
  }
  // A target reached while an interlock holds is measured when the interlock has cleared.
  if (passes_interlocks(true)) {
    if (is_reached_ && phase_ == Phase::running) report_measurement();
  } else {
    reached_.fraction = 1.0;
  }
  record();
  ++command_.sample;
  const Duration slew = from_seconds(kClockSlewMost * period_s_);
  clock_shift_ += std::clamp(wanted_clock_shift_ - clock_shift_, -slew, slew);
  if (phase_ == Phase::closing && closing_.is_over()) come_to_rest();
}

void ControlLoop::shape_command() noexcept {
  const TrajectoryPoint& path = trajectory_.point();
  copy_values(path.displacement_m, target_.displacement_m);
  copy_values(path.velocity_m_per_s, target_.velocity_m_per_s);
  copy_values(path.acceleration_m_per_s2, target_.acceleration_m_per_s2);
  if (!start_offset_.is_over()) {
    target_.displacement_m += start_offset_.displacement_m();
    target_.velocity_m_per_s += start_offset_.velocity_m_per_s();
    start_offset_.advance(period_s_);
  }
  for (Eigen::Index k = 0; k < settings_.dofs; ++k) {
    const CompensatorInput input{target_.displacement_m[k], target_.velocity_m_per_s[k],
                                 target_.acceleration_m_per_s2[k], feedback_.displacement_m[k], feedback_.force_n[k]};
    wanted_command_m_[k] = compensation_.commands[static_cast<std::size_t>(k)]->command(input);
  }
  copy_values(wanted_command_m_, compensated_command_m_);
  if (resume_offset_.is_over()) return;
  wanted_command_m_ += resume_offset_.displacement_m();
  resume_offset_.advance(period_s_);
}

void ControlLoop::limit_motion() noexcept {
  const double reach_m = settings_.limits.velocity_m_per_s * period_s_;
  for (Eigen::Index k = 0; k < settings_.dofs; ++k) {
    const double before_m = command_.displacement_m[k];
    if (!std::isfinite(wanted_command_m_[k])) continue;  // never commanded, even where the interlock only warns
    const double slow_m = std::clamp(wanted_command_m_[k], before_m - reach_m, before_m + reach_m);
    const double limited_m = std::clamp(slow_m, -settings_.limits.displacement_m, settings_.limits.displacement_m);
    if (limited_m != wanted_command_m_[k]) motion_flags_ |= MeasurementFlags::saturated;
    command_.displacement_m[k] = limited_m;
  }
}

void ControlLoop::exchange() noexcept {
  copy_feedback(feedback_, feedback_before_);
  rig_fault_ = rig_.exchange(command_, reading_) != RigStatus::healthy;
  copy_feedback(reading_, feedback_);
  zero_offsets_.take_off(feedback_);
}

void ControlLoop::capture_zero_offsets() noexcept {
  zero_offsets_.capture(feedback_);
  if (!zero_offsets_.is_captured()) return;
  zero_offsets_.take_off(feedback_);
  // The next sample differs from this one by the offset; the step interlocks must not compare the two.
  interlocks_.has_sample = false;
  phase_ = Phase::standing;
  for (Eigen::Index k = 0; k < settings_.dofs; ++k) {
    ports_.reports.send(loop_report::ZeroOffset{.dof = static_cast<int>(k),
                                                .displacement_m = zero_offsets_.offset().displacement_m[k],
                                                .force_n = zero_offsets_.offset().force_n[k]});
  }
  ports_.reports.send(loop_report::Armed{});
}

void ControlLoop::compensate_forces() noexcept {
  copy_values(compensated_force_n_, compensated_force_before_n_);
  for (Eigen::Index k = 0; k < settings_.dofs; ++k) {
    compensated_force_n_[k] = compensation_.forces[static_cast<std::size_t>(k)]->corrected_force(
        {target_.displacement_m[k], feedback_.displacement_m[k], feedback_.force_n[k]});
  }
}

void ControlLoop::observe_tracking() noexcept {
  // A value that is not finite would stay in the sums; the interlock `not_finite` acts on it.
  if (!target_.displacement_m.allFinite() || !feedback_.displacement_m.allFinite() || !feedback_.force_n.allFinite()) {
    return;
  }
  energy_error_.sample(target_.displacement_m, feedback_.displacement_m, feedback_.force_n);
  tracking_.sample(target_.displacement_m, feedback_.displacement_m);
}

InterlockInput ControlLoop::interlock_input(bool is_new_sample) const noexcept {
  SitePhase phase = SitePhase::resting;
  if (follows_targets()) phase = SitePhase::running;
  if (phase_ == Phase::zeroing || phase_ == Phase::standing) phase = SitePhase::standing;
  return {.phase = phase,
          .target_displacement_m = target_.displacement_m,
          .target_velocity_m_per_s = target_.velocity_m_per_s,
          .command_displacement_m = phase_ == Phase::running ? wanted_command_m_ : command_.displacement_m,
          .measured_displacement_m = feedback_.displacement_m,
          .force_n = feedback_.force_n,
          .energy_error_ratio = energy_error_.ratio(),
          .tracking_lag_sine = tracking_.lag_sine(),
          .command_age_s = command_age_s_,
          .expects_commands = follows_targets() && !is_paused_,
          .rig_fault = rig_fault_,
          .emergency_stop = emergency_stop_,
          .is_new_sample = is_new_sample,
          .period_s = period_s_};
}

bool ControlLoop::passes_interlocks(bool is_new_sample) noexcept {
  const InterlockVerdict verdict =
      judge(settings_.limits, settings_.rules, interlock_input(is_new_sample), interlocks_);
  for (int i = 0; i < verdict.trip_count; ++i) report(verdict.trips[static_cast<std::size_t>(i)]);
  if (verdict.has_cleared) report_cleared();
  act(verdict);
  return verdict.action < SafetyAction::hold;
}

void ControlLoop::act(const InterlockVerdict& verdict) noexcept {
  switch (verdict.action) {
    case SafetyAction::none:
    case SafetyAction::warn:
      if (phase_ == Phase::holding && !hold_is_final_) go_on();
      break;
    case SafetyAction::hold: hold(verdict.is_final); break;
    case SafetyAction::ramp_to_zero:
      if (phase_ != Phase::closing && phase_ != Phase::at_rest && phase_ != Phase::disarmed) begin_return();
      break;
    case SafetyAction::release:
      if (phase_ == Phase::at_rest && !emergency_stop_) break;
      stop_was_asked_ = stop_was_asked_ || emergency_stop_;
      come_to_rest();
      break;
  }
}

void ControlLoop::hold(bool is_final) noexcept {
  if (phase_ == Phase::holding) hold_is_final_ = hold_is_final_ || is_final;
  if (phase_ != Phase::zeroing && phase_ != Phase::standing && phase_ != Phase::running) return;
  phase_before_hold_ = phase_;
  phase_ = Phase::holding;  // the last command is kept
  hold_is_final_ = is_final;
  trajectory_.halt();
  target_.velocity_m_per_s.setZero();
}

/// Continues after a hold, from rest and from the command that was held.
void ControlLoop::go_on() noexcept {
  phase_ = phase_before_hold_;
  if (phase_ != Phase::running) return;
  resume_offset_.begin(command_.displacement_m - compensated_command_m_, no_motion_,
                       std::max({settings_.ramp_in_s, settings_.step_s, kHalt_s_min}));
}

void ControlLoop::report(const InterlockTrip& trip) noexcept {
  const FaultFlags fault = fault_of(trip.kind);
  const auto [observed, limit] = values_of(trip);
  if (!trip.is_final) {
    ports_.reports.send(loop_report::Warning{fault, observed, limit, model_time_s()});
    return;
  }
  faults_ |= fault;
  ports_.reports.send(loop_report::Fault{fault, observed, limit, model_time_s()});
}

/// The values of a report, see interlock_cause(). An interlock itself knows magnitudes alone.
std::pair<double, double> ControlLoop::values_of(const InterlockTrip& trip) const noexcept {
  switch (trip.kind) {
    case InterlockKind::rig_status: return {static_cast<double>(rig_.fault()), 0.0};
    case InterlockKind::not_finite: return first_not_finite();
    case InterlockKind::energy_error: return {energy_error_.ratio(), trip.limit};
    default: return {trip.observed, trip.limit};
  }
}

/// A SiteSignal, and its interface degree of freedom from 1.
std::pair<double, double> ControlLoop::first_not_finite() const noexcept {
  const InterlockInput input = interlock_input(false);
  const std::array<std::pair<SiteSignal, const SiteVector*>, 4> signals{
      {{SiteSignal::measured_force, &input.force_n},
       {SiteSignal::measured_displacement, &input.measured_displacement_m},
       {SiteSignal::target, &input.target_displacement_m},
       {SiteSignal::command, &input.command_displacement_m}}};
  for (const auto& [signal, values] : signals) {
    for (Eigen::Index k = 0; k < values->size(); ++k) {
      if (!std::isfinite((*values)[k])) return {static_cast<double>(signal), static_cast<double>(k + 1)};
    }
  }
  return {static_cast<double>(SiteSignal::unknown), 0.0};
}

void ControlLoop::report_cleared() noexcept { ports_.reports.send(loop_report::Cleared{model_time_s()}); }

void ControlLoop::report_measurement() noexcept {
  is_reached_ = false;
  const auto at_target = [&](const SiteVector& before, const SiteVector& after, SiteVector& value) {
    if (reached_.fraction >= 1.0) {
      copy_values(after, value);
    } else {
      value = before + reached_.fraction * (after - before);
    }
  };
  auto& measurement = *std::get_if<StepMeasurement>(&measurement_);
  measurement.step = reached_.step;
  measurement.model_time_s = reached_.model_time_s;
  copy_values(reached_.displacement_m, measurement.target_displacement_m);
  copy_values(command_.displacement_m, measurement.imposed_displacement_m);
  at_target(feedback_before_.displacement_m, feedback_.displacement_m, measurement.measured_displacement_m);
  at_target(compensated_force_before_n_, compensated_force_n_, measurement.force_n);
  measurement.flags = reached_.flags | motion_flags_;
  ports_.reports.send(measurement_);
}

double ControlLoop::model_time_s() const noexcept { return trajectory_.point().path_time_s / settings_.time_scale; }

void ControlLoop::record() noexcept {
  record_.append({.sample = command_.sample,
                  .time_s = command_.time_s,
                  .model_time_s = model_time_s(),
                  .target_displacement_m = target_.displacement_m,
                  .command_displacement_m = command_.displacement_m,
                  .measured_displacement_m = feedback_.displacement_m,
                  .measured_force_n = feedback_.force_n,
                  .compensated_force_n = compensated_force_n_,
                  .energy_error_j = energy_error_.energy_error_j(),
                  .tracking_lag_sine = tracking_.lag_sine(),
                  .faults = faults_,
                  .target_velocity_m_per_s = target_.velocity_m_per_s,
                  .energy_error_ratio = energy_error_.ratio(),
                  .command_age_s = follows_targets() && !is_paused_ ? command_age_s_ : 0.0,
                  .follows_targets = follows_targets()});
}

}  // namespace hybridtest
