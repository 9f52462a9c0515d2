#include "experimental_site/control_loop.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "core/assert.hpp"

namespace hybridtest {
namespace {

/// In lockstep the return to zero has no pace of its own; other work gets its turn in between.
constexpr int kPeriodsPerAdvance = 256;

/// Every so many control periods one goes to the live views.
constexpr std::int64_t kSignalDecimation = 16;

}  // namespace

ControlLoop::ControlLoop(const ControlLoopSettings& settings, Rig& rig, SiteCompensation compensation,
                         EnergyErrorMonitor energy_error, ControlLoopPorts ports, RowSink& control_record)
    : settings_{settings},
      rig_{rig},
      compensation_{std::move(compensation)},
      energy_error_{std::move(energy_error)},
      ports_{ports},
      control_record_{control_record},
      trajectory_{settings.dofs, settings.step_s, settings.time_scale},
      period_s_{settings.step_s / settings.periods_per_step} {
  HYBRIDTEST_ASSERT(std::cmp_equal(compensation_.commands.size(), settings.dofs));
  HYBRIDTEST_ASSERT(std::cmp_equal(compensation_.forces.size(), settings.dofs));
  const InterfaceVector zero = InterfaceVector::Zero(settings.dofs);
  command_.displacement_m = zero;
  wanted_command_m_ = zero;
  last_target_m_ = zero;
  no_motion_ = zero;
  feedback_ = {zero, zero};
  feedback_before_ = feedback_;
  compensated_force_n_ = zero;
  compensated_force_before_n_ = zero;
  ramp_begin_m_ = zero;
  row_.resize(5 + 5 * static_cast<std::size_t>(settings.dofs));
}

Instant ControlLoop::advance(Instant now) noexcept {
  LoopRequest request;
  while (ports_.requests.take(request)) obey(request, now);

  const bool expects_commands = phase_ == Phase::running && !is_paused_;
  command_age_s_ = expects_commands ? to_seconds(now - last_target_at_) : 0.0;
  for (int periods = 0; has_due_period(now) && periods < kPeriodsPerAdvance; ++periods) run_period();
  // Between two targets lockstep has no control periods that would notice their absence.
  if (settings_.mode == CouplingMode::lockstep && phase_ == Phase::running) {
    static_cast<void>(passes_interlocks());
  }
  return next_wake(now);
}

void ControlLoop::obey(const LoopRequest& request, Instant now) noexcept {
  switch (request.kind) {
    case LoopRequest::Kind::arm: arm(now); break;
    case LoopRequest::Kind::start:
      if (phase_ != Phase::standing) break;
      phase_ = Phase::running;
      last_target_at_ = now;
      break;
    case LoopRequest::Kind::target:
      if (phase_ != Phase::running) break;
      trajectory_.set_target(request.target);
      last_target_at_ = now;
      break;
    case LoopRequest::Kind::pause: is_paused_ = true; break;
    case LoopRequest::Kind::resume:
      is_paused_ = false;
      last_target_at_ = now;
      break;
    case LoopRequest::Kind::stop: stop(); break;
    case LoopRequest::Kind::emergency_stop:
      rig_.stop_motion();
      faults_ |= FaultFlags::emergency_stop;
      stop_was_asked_ = true;
      come_to_rest();
      break;
  }
}

void ControlLoop::arm(Instant now) noexcept {
  if (phase_ != Phase::disarmed) return;
  LoopReport report;
  try {
    rig_.arm();
  } catch (...) {
    faults_ |= FaultFlags::rig_fault;
    report.kind = LoopReport::Kind::arm_failed;
    report.fault = FaultFlags::rig_fault;
    ports_.reports.send(report);
    return;
  }
  for (auto& compensator : compensation_.commands) compensator->reset();
  for (auto& compensator : compensation_.forces) compensator->reset();
  energy_error_.reset();
  trajectory_.reset(no_motion_);
  phase_ = Phase::standing;
  armed_at_ = now;
  report.kind = LoopReport::Kind::armed;
  ports_.reports.send(report);
}

void ControlLoop::stop() noexcept {
  if (std::exchange(stop_was_asked_, true)) return;
  const bool is_untrustworthy = any(faults_ & (FaultFlags::not_finite | FaultFlags::rig_fault));
  switch (phase_) {
    case Phase::disarmed:
    case Phase::standing: come_to_rest(); break;
    case Phase::running: begin_ramp(); break;
    case Phase::holding:
      if (is_untrustworthy) {
        come_to_rest();
      } else {
        begin_ramp();
      }
      break;
    case Phase::ramping: break;
    case Phase::at_rest: come_to_rest(); break;
  }
}

void ControlLoop::come_to_rest() noexcept {
  rig_.stop_motion();
  phase_ = Phase::at_rest;
  if (!stop_was_asked_) return;
  LoopReport report;
  report.kind = LoopReport::Kind::at_rest;
  ports_.reports.send(report);
}

void ControlLoop::begin_ramp() noexcept {
  phase_ = Phase::ramping;
  ramp_begin_m_ = command_.displacement_m;
  ramp_period_ = 0;
  // A raised cosine is fastest in its middle, pi/2 times its mean; it stays below half the limit.
  const double least_s = std::numbers::pi * ramp_begin_m_.cwiseAbs().maxCoeff() / settings_.limits.velocity_m_per_s;
  const double periods = std::ceil(std::max(settings_.return_time_s, least_s) / period_s_);
  ramp_periods_ = std::max<std::int64_t>(1, static_cast<std::int64_t>(periods));  // also from zero in no time
}

bool ControlLoop::has_due_period(Instant now) const noexcept {
  if (phase_ == Phase::disarmed || phase_ == Phase::at_rest) return false;
  if (settings_.mode == CouplingMode::paced) {
    return now >= armed_at_ + from_seconds(static_cast<double>(command_.sample) * period_s_);
  }
  return phase_ == Phase::ramping || (phase_ == Phase::running && trajectory_.has_target());
}

Instant ControlLoop::next_wake(Instant now) const noexcept {
  if (phase_ == Phase::disarmed || phase_ == Phase::at_rest) return kNever;
  if (has_due_period(now)) return now;
  if (settings_.mode == CouplingMode::paced) {
    return armed_at_ + from_seconds(static_cast<double>(command_.sample) * period_s_);
  }
  if (phase_ != Phase::running || is_paused_) return kNever;
  // One nanosecond past the limit: at the limit itself the command is not overdue yet.
  return last_target_at_ + from_seconds(settings_.limits.command_age_s) + Duration{1};
}

void ControlLoop::run_period() noexcept {
  command_.time_s = static_cast<double>(command_.sample) * period_s_;
  ReachedTarget reached;
  bool is_reached = false;
  motion_flags_ = MeasurementFlags::none;
  if (phase_ == Phase::running) {
    is_reached = trajectory_.advance(period_s_, reached);
    shape_command();
    if (passes_interlocks()) limit_motion();
  }
  if (phase_ == Phase::ramping) ramp_command();
  exchange();
  if (phase_ == Phase::running) {
    compensate_forces();
    energy_error_.sample(trajectory_.point().displacement_m, feedback_.displacement_m, feedback_.force_n);
    if (passes_interlocks() && is_reached) report_measurement(reached);
  }
  record();
  ++command_.sample;
  if (phase_ == Phase::ramping && ramp_period_ >= ramp_periods_) come_to_rest();
}

void ControlLoop::shape_command() noexcept {
  const TrajectoryPoint& point = trajectory_.point();
  last_target_m_ = point.displacement_m;
  for (Eigen::Index k = 0; k < settings_.dofs; ++k) {
    const CompensatorInput input{point.displacement_m[k], point.velocity_m_per_s[k], point.acceleration_m_per_s2[k],
                                 feedback_.displacement_m[k], feedback_.force_n[k]};
    wanted_command_m_[k] = compensation_.commands[static_cast<std::size_t>(k)]->command(input);
  }
}

void ControlLoop::limit_motion() noexcept {
  const double reach_m = settings_.limits.velocity_m_per_s * period_s_;
  for (Eigen::Index k = 0; k < settings_.dofs; ++k) {
    const double before_m = command_.displacement_m[k];
    const double slow_m = std::clamp(wanted_command_m_[k], before_m - reach_m, before_m + reach_m);
    const double limited_m = std::clamp(slow_m, -settings_.limits.displacement_m, settings_.limits.displacement_m);
    if (limited_m != wanted_command_m_[k]) motion_flags_ |= MeasurementFlags::saturated;
    command_.displacement_m[k] = limited_m;
  }
}

void ControlLoop::ramp_command() noexcept {
  ++ramp_period_;
  const double x = static_cast<double>(ramp_period_) / static_cast<double>(ramp_periods_);
  command_.displacement_m = (0.5 * (1.0 + std::cos(std::numbers::pi * x))) * ramp_begin_m_;
  last_target_m_ = command_.displacement_m;
}

void ControlLoop::exchange() noexcept {
  feedback_before_ = feedback_;
  rig_fault_ = rig_.exchange(command_, feedback_) != RigStatus::healthy;
}

void ControlLoop::compensate_forces() noexcept {
  compensated_force_before_n_ = compensated_force_n_;
  for (Eigen::Index k = 0; k < settings_.dofs; ++k) {
    compensated_force_n_[k] = compensation_.forces[static_cast<std::size_t>(k)]->corrected_force(
        {last_target_m_[k], feedback_.displacement_m[k], feedback_.force_n[k]});
  }
}

bool ControlLoop::passes_interlocks() noexcept {
  const TrajectoryPoint& point = trajectory_.point();
  const InterlockVerdict verdict =
      judge(settings_.limits,
            InterlockInput{point.displacement_m, point.velocity_m_per_s, wanted_command_m_, feedback_.displacement_m,
                           feedback_.force_n, energy_error_.ratio(), command_age_s_, !is_paused_, rig_fault_});
  if (verdict.action == SafetyAction::none) return true;
  trip(verdict);
  return false;
}

void ControlLoop::trip(const InterlockVerdict& verdict) noexcept {
  faults_ |= verdict.fault;
  if (verdict.action == SafetyAction::ramp_to_zero) {
    begin_ramp();
  } else {
    phase_ = Phase::holding;  // the last command stays
  }
  LoopReport report;
  report.kind = LoopReport::Kind::fault;
  report.fault = verdict.fault;
  report.observed = verdict.observed;
  report.limit = verdict.limit;
  report.model_time_s = trajectory_.point().path_time_s / settings_.time_scale;
  ports_.reports.send(report);
}

void ControlLoop::report_measurement(const ReachedTarget& reached) noexcept {
  const auto at_target = [&](const InterfaceVector& before, const InterfaceVector& after) -> InterfaceVector {
    if (reached.fraction >= 1.0) return after;
    return before + reached.fraction * (after - before);
  };
  LoopReport report;
  report.kind = LoopReport::Kind::measurement;
  StepMeasurement& measurement = report.measurement;
  measurement.step = reached.target.step;
  measurement.model_time_s = reached.target.model_time_s;
  measurement.target_displacement_m = reached.target.displacement_m;
  measurement.imposed_displacement_m = command_.displacement_m;
  measurement.measured_displacement_m = at_target(feedback_before_.displacement_m, feedback_.displacement_m);
  measurement.force_n = at_target(compensated_force_before_n_, compensated_force_n_);
  measurement.flags = reached.flags | motion_flags_;
  ports_.reports.send(report);
}

void ControlLoop::record() noexcept {
  const double model_time_s = trajectory_.point().path_time_s / settings_.time_scale;
  std::size_t next = 0;
  row_[next++] = static_cast<double>(command_.sample);
  row_[next++] = command_.time_s;
  row_[next++] = model_time_s;
  for (Eigen::Index k = 0; k < settings_.dofs; ++k) {
    row_[next++] = last_target_m_[k];
    row_[next++] = command_.displacement_m[k];
    row_[next++] = feedback_.displacement_m[k];
    row_[next++] = feedback_.force_n[k];
    row_[next++] = compensated_force_n_[k];
  }
  row_[next++] = energy_error_.energy_error_j();
  row_[next++] = static_cast<double>(static_cast<std::uint32_t>(faults_));
  control_record_.append(row_);
  if (command_.sample % kSignalDecimation == 0) {
    ports_.signals.send({model_time_s, last_target_m_[0], command_.displacement_m[0], feedback_.displacement_m[0],
                         feedback_.force_n[0]});
  }
}

TableLayout ControlLoop::control_layout(int dofs) {
  TableLayout layout{"control", {{"sample", ""}, {"time_s", "s"}, {"model_time_s", "s"}}};
  for (int k = 1; k <= dofs; ++k) {
    const std::string suffix = dofs == 1 ? "" : "_" + std::to_string(k);
    layout.columns.push_back({"target_displacement_m" + suffix, "m"});
    layout.columns.push_back({"command_displacement_m" + suffix, "m"});
    layout.columns.push_back({"measured_displacement_m" + suffix, "m"});
    layout.columns.push_back({"measured_force_n" + suffix, "N"});
    layout.columns.push_back({"compensated_force_n" + suffix, "N"});
  }
  layout.columns.push_back({"energy_error_j", "J"});
  layout.columns.push_back({"faults", ""});
  return layout;
}

}  // namespace hybridtest
