#include "experimental_site/site_link.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "core/refused_resumption.hpp"
#include "core/rehearsal_answer.hpp"

namespace hybridtest {
namespace {

/// Of the estimate of the drift. Long enough for several hundred commands at the rates of real-time tests.
constexpr Duration kClockWindow = std::chrono::milliseconds{500};

}  // namespace

SiteLink::SiteLink(SubstructureIndex index, int dofs, CouplingMode mode, Presence& presence, MembershipPorts membership,
                   SiteLinkPorts ports, RowSink& steps, std::size_t remembered)
    : index_{index},
      dofs_{dofs},
      mode_{mode},
      presence_{presence},
      membership_{presence, membership},
      ports_{ports},
      steps_{steps},
      memory_{remembered, dofs},
      row_(3 + 3 * static_cast<std::size_t>(dofs)) {}

Instant SiteLink::advance(Instant now) noexcept {
  take_messages(now);
  return pass_reports_on(now);
}

void SiteLink::take_messages(Instant now) noexcept {
  static_cast<void>(presence_.advance(now));
  if (requested_stop_ != StopReason::none) begin_stop(std::exchange(requested_stop_, StopReason::none));
  for (Request request = membership_.next_request(now); request != Request::none && !is_done();
       request = membership_.next_request(now)) {
    follow(request);
  }
  while (ports_.commands.take(command_)) pass_on(command_, now);
}

Instant SiteLink::pass_reports_on(Instant now) noexcept {
  static_cast<void>(presence_.advance(now));  // sends the state that the messages led to
  while (ports_.reports.take(report_)) handle(report_, now);
  const Instant wake = presence_.tell(now);
  return is_done() ? kNever : wake;
}

bool SiteLink::is_done() const noexcept {
  return presence_.state() == LifecycleState::finished || presence_.state() == LifecycleState::refused;
}

void SiteLink::follow(Request request) noexcept {
  switch (request) {
    case Request::arm: ports_.requests.send(loop_request::Arm{}); break;
    case Request::start:
      // Of a resumed test the loop has paused, and goes on.
      if (membership_.has_successor()) {
        ports_.requests.send(loop_request::Resume{});
      } else {
        ports_.requests.send(loop_request::Start{});
      }
      presence_.set_state(LifecycleState::running);
      break;
    case Request::pause: ports_.requests.send(loop_request::Pause{}); break;
    case Request::resume: ports_.requests.send(loop_request::Resume{}); break;
    case Request::stop: begin_stop(membership_.stop_reason()); break;
    case Request::emergency_stop:
      ports_.requests.send(loop_request::EmergencyStop{});
      begin_stop(StopReason::emergency_stop);
      break;
    case Request::none: break;
  }
}

void SiteLink::begin_stop(StopReason reason) noexcept {
  if (presence_.state() == LifecycleState::stopping) return;
  stop_reason_ = reason;
  presence_.set_state(LifecycleState::stopping);
  ports_.requests.send(loop_request::Stop{});
}

void SiteLink::pass_on(const DisplacementCommand& command, Instant now) noexcept {
  if (command.coordinator != membership_.coordinator()) return;
  if (mode_ == CouplingMode::real_time) follow_clock(command, now);
  if (command.is_rehearsal) {
    if (presence_.state() != LifecycleState::armed) return;
    answer_rehearsal(command, presence_.identity().incarnation, now.time_since_epoch(), answer_);
    ports_.measurements.send(answer_);
    return;
  }
  // A command can overtake the start message; it then starts the loop.
  if (presence_.state() == LifecycleState::armed) follow(Request::start);
  if (presence_.state() != LifecycleState::running) return;
  const Step newest = command.newest().step;
  // A specimen has no state to go back to.
  if (command.is_trial || !command.fits(dofs_)) return;
  if (newest < passed_on_ && !membership_.has_successor()) return;
  if (membership_.has_successor()) {
    if (const CommandPoint* other = memory_.first_other(command, passed_on_)) {
      refuse(Recall::different, *other, now);
      return;
    }
  }
  // A copy of a command that is being followed: its answer will tell the times of the first one.
  if (!membership_.has_successor() && newest == passed_on_ && answer_.step != newest) return;
  command_send_time_ = command.send_time;
  receive_time_ = now.time_since_epoch();
  if (membership_.has_successor() && newest <= passed_on_) {
    answer_again(command.newest(), now);
    return;
  }
  if (newest == passed_on_) {
    if (answer_.step == newest) answer(now, MeasurementFlags::repeated);
    return;
  }
  if (mode_ == CouplingMode::real_time && passed_on_ != kNoStep) {
    pass_on_in_time(command);
    return;
  }
  for (int i = command.point_count - 1; i >= 0; --i) {
    const CommandPoint& point = command.points[static_cast<std::size_t>(i)];
    if (point.step == passed_on_ + 1 && !pass_target_on(point)) return;
  }
}

void SiteLink::answer_again(const CommandPoint& point, Instant now) noexcept {
  switch (const Recall recall = memory_.recall(point, 0, answer_)) {
    case Recall::answered: send_answer(now, answer_.flags | MeasurementFlags::repeated); break;
    case Recall::pending: break;  // answered once it is measured
    case Recall::different:
    case Recall::forgotten: refuse(recall, point, now); break;
  }
}

void SiteLink::refuse(Recall recall, const CommandPoint& point, Instant now) noexcept {
  report_refused_resumption(recall, point, memory_, presence_, now);
  begin_stop(StopReason::resume_refused);
}

void SiteLink::pass_on_in_time(const DisplacementCommand& command) noexcept {
  // The first one after the initial target starts the time of the site: the newest step is the one that is due.
  const int oldest = passed_on_ == 0 ? 0 : command.point_count - 1;
  for (int i = oldest; i >= 0; --i) {
    const CommandPoint& point = command.points[static_cast<std::size_t>(i)];
    if (point.step > passed_on_ && !pass_target_on(point)) return;
  }
}

bool SiteLink::pass_target_on(const CommandPoint& point) noexcept {
  TargetPoint& target = std::get_if<loop_request::Target>(&target_)->point;
  target.step = point.step;
  target.model_time_s = point.model_time_s;
  target.displacement_m = point.displacement_m;
  target.velocity_m_per_s = point.velocity_m_per_s;
  target.acceleration_m_per_s2 = point.acceleration_m_per_s2;
  if (!ports_.requests.send(target_)) return false;
  passed_on_ = point.step;
  memory_.keep_command(point.step, 0, point.displacement_m);
  return true;
}

void SiteLink::follow_clock(const DisplacementCommand& command, Instant now) noexcept {
  if (window_began_ == kNever) window_began_ = now;
  least_delay_ = std::min(least_delay_, now.time_since_epoch() - command.send_time);
  if (now - window_began_ < kClockWindow) return;
  window_began_ = now;
  const Duration least = std::exchange(least_delay_, Duration::max());
  if (!first_delay_) first_delay_ = least;
  ports_.requests.send(loop_request::ClockShift{least - *first_delay_});
}

void SiteLink::handle(const LoopReport& report, Instant now) noexcept {
  struct Handle {
    SiteLink& link;
    Instant now;

    void operator()(const loop_report::Armed&) const noexcept { link.presence_.set_state(LifecycleState::armed); }
    void operator()(const loop_report::ArmFailed& failed) const noexcept {
      (*this)(loop_report::Fault{.fault = FaultFlags::rig_fault, .observed = static_cast<double>(failed.fault)});
    }
    void operator()(const loop_report::ZeroOffset& offset) const noexcept {
      link.presence_.report(now, Severity::information, EventCode::zero_offset, "dof " + std::to_string(offset.dof + 1),
                            {offset.displacement_m, offset.force_n});
    }
    void operator()(const StepMeasurement& measurement) const noexcept { link.take_measurement(measurement, now); }
    void operator()(const loop_report::Warning& warning) const noexcept {
      link.presence_.report(now, Severity::warning, EventCode::interlock_warned, name(warning.fault),
                            {warning.observed, warning.limit}, link.passed_on_, warning.model_time_s);
    }
    void operator()(const loop_report::Cleared& cleared) const noexcept {
      link.presence_.report(now, Severity::information, EventCode::interlock_cleared, {}, {}, link.passed_on_,
                            cleared.model_time_s);
    }
    void operator()(const loop_report::Fault& fault) const noexcept {
      link.presence_.raise(fault.fault);
      const bool is_overdue = fault.fault == FaultFlags::command_age;
      link.presence_.report(now, Severity::fault,
                            is_overdue ? EventCode::command_overdue : EventCode::interlock_tripped, name(fault.fault),
                            {fault.observed, fault.limit}, link.passed_on_, fault.model_time_s);
    }
    void operator()(const loop_report::AtRest&) const noexcept { link.presence_.set_state(LifecycleState::finished); }
  };
  std::visit(Handle{*this, now}, report);
}

void SiteLink::take_measurement(const StepMeasurement& measurement, Instant now) noexcept {
  answer_.step = measurement.step;
  answer_.model_time_s = measurement.model_time_s;
  answer_.imposed_displacement_m = measurement.imposed_displacement_m;
  answer_.measured_displacement_m = measurement.measured_displacement_m;
  answer_.force_n = measurement.force_n;
  measured_flags_ = measurement.flags;
  memory_.keep_answer(measurement.step, 0, measurement.model_time_s, measurement.imposed_displacement_m,
                      measurement.measured_displacement_m, measurement.force_n, measurement.flags);
  presence_.set_last_step(measurement.step);
  record_step(measurement);
  if (presence_.state() == LifecycleState::running) answer(now, MeasurementFlags::none);
}

void SiteLink::answer(Instant now, MeasurementFlags flags) noexcept {
  answer_.iteration = 0;  // a specimen is not tried
  send_answer(now, measured_flags_ | flags);
}

void SiteLink::send_answer(Instant now, MeasurementFlags flags) noexcept {
  answer_.substructure = index_;
  answer_.sender = presence_.identity().incarnation;
  answer_.flags = flags;
  answer_.receive_time = receive_time_;
  answer_.send_time = now.time_since_epoch();
  answer_.command_send_time = command_send_time_;
  ports_.measurements.send(answer_);
}

void SiteLink::record_step(const StepMeasurement& measurement) noexcept {
  std::size_t next = 0;
  row_[next++] = static_cast<double>(measurement.step);
  row_[next++] = measurement.model_time_s;
  for (Eigen::Index k = 0; k < dofs_; ++k) {
    row_[next++] = measurement.target_displacement_m[k];
    row_[next++] = measurement.measured_displacement_m[k];
    row_[next++] = measurement.force_n[k];
  }
  row_[next++] = static_cast<double>(static_cast<std::uint32_t>(measurement.flags));
  steps_.append(row_);
}

TableLayout SiteLink::steps_layout(int dofs) {
  TableLayout layout{"steps", {{"step", ""}, {"model_time_s", "s"}}};
  for (int k = 1; k <= dofs; ++k) {
    const std::string suffix = column_suffix(k, dofs);
    layout.columns.push_back({"target_displacement_m" + suffix, "m"});
    layout.columns.push_back({"measured_displacement_m" + suffix, "m"});
    layout.columns.push_back({"measured_force_n" + suffix, "N"});
  }
  layout.columns.push_back({"flags", ""});
  return layout;
}

Instant SiteNode::advance(Instant now) noexcept {
  // A command, the motion that it asks for and the answer all belong to one call.
  link_.take_messages(now);
  const Instant loop_wake = loop_.advance(now);
  return std::min(link_.pass_reports_on(now), loop_wake);
}

}  // namespace hybridtest
