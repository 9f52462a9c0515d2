#include "experimental_site/site_link.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace hybridtest {

SiteLink::SiteLink(SubstructureIndex index, int dofs, Presence& presence, MembershipPorts membership,
                   SiteLinkPorts ports, RowSink& steps)
    : index_{index},
      dofs_{dofs},
      presence_{presence},
      membership_{presence, membership},
      ports_{ports},
      steps_{steps},
      row_(3 + 3 * static_cast<std::size_t>(dofs)) {
  block_.substructure = index;
}

Instant SiteLink::advance(Instant now) noexcept {
  const Instant wake = presence_.advance(now);
  if (requested_stop_ != StopReason::none) begin_stop(std::exchange(requested_stop_, StopReason::none));
  for (Request request = membership_.next_request(now); request != Request::none && !is_done();
       request = membership_.next_request(now)) {
    obey(request);
  }
  DisplacementCommand command;
  while (ports_.commands.take(command)) pass_on(command, now);
  LoopReport report;
  while (ports_.reports.take(report)) heed(report, now);
  batch_signals();
  if (!is_done()) return wake;
  static_cast<void>(presence_.advance(now));  // the last word goes out
  return kNever;
}

bool SiteLink::is_done() const noexcept {
  return presence_.state() == LifecycleState::finished || presence_.state() == LifecycleState::refused;
}

void SiteLink::obey(Request request) noexcept {
  switch (request) {
    case Request::arm: ask(LoopRequest::Kind::arm); break;
    case Request::start:
      ask(LoopRequest::Kind::start);
      presence_.set_state(LifecycleState::running);
      break;
    case Request::pause: ask(LoopRequest::Kind::pause); break;
    case Request::resume: ask(LoopRequest::Kind::resume); break;
    case Request::stop: begin_stop(membership_.stop_reason()); break;
    case Request::emergency_stop:
      ask(LoopRequest::Kind::emergency_stop);
      begin_stop(StopReason::interlock);
      break;
    case Request::none: break;
  }
}

void SiteLink::begin_stop(StopReason reason) noexcept {
  if (presence_.state() == LifecycleState::stopping) return;
  stop_reason_ = reason;
  presence_.set_state(LifecycleState::stopping);
  ask(LoopRequest::Kind::stop);
}

void SiteLink::ask(LoopRequest::Kind kind) noexcept {
  LoopRequest request;
  request.kind = kind;
  ports_.requests.send(request);
}

void SiteLink::pass_on(const DisplacementCommand& command, Instant now) noexcept {
  if (command.coordinator != membership_.coordinator()) return;
  // A command can overtake the start message; it says the same.
  if (presence_.state() == LifecycleState::armed) obey(Request::start);
  if (presence_.state() != LifecycleState::running) return;
  const Step newest = command.newest().step;
  if (newest < passed_on_ || !command.fits(dofs_)) return;
  command_send_time_ = command.send_time;
  receive_time_ = now.time_since_epoch();
  if (newest == passed_on_) {
    if (measured_.step == newest) answer(now, MeasurementFlags::repeated);
    return;
  }
  for (int i = command.point_count - 1; i >= 0; --i) {
    const CommandPoint& point = command.points[static_cast<std::size_t>(i)];
    if (point.step != passed_on_ + 1) continue;
    LoopRequest request;
    request.kind = LoopRequest::Kind::target;
    request.target = point;
    if (!ports_.requests.send(request)) return;
    passed_on_ = point.step;
  }
}

void SiteLink::heed(const LoopReport& report, Instant now) noexcept {
  switch (report.kind) {
    case LoopReport::Kind::armed:
      loop_is_armed_ = true;
      presence_.set_state(LifecycleState::armed);
      break;
    case LoopReport::Kind::arm_failed:
    case LoopReport::Kind::fault:
      presence_.raise(report.fault);
      presence_.report(
          now, Severity::fault,
          report.fault == FaultFlags::command_age ? EventCode::command_overdue : EventCode::interlock_tripped,
          name(report.fault), {report.observed, report.limit}, passed_on_, report.model_time_s);
      break;
    case LoopReport::Kind::warning:
      presence_.report(now, Severity::warning, EventCode::interlock_warned, name(report.fault),
                       {report.observed, report.limit}, passed_on_, report.model_time_s);
      break;
    case LoopReport::Kind::cleared:
      presence_.report(now, Severity::information, EventCode::interlock_cleared, {}, {}, passed_on_,
                       report.model_time_s);
      break;
    case LoopReport::Kind::zero_offset:
      presence_.report(now, Severity::information, EventCode::zero_offset, "dof " + std::to_string(report.dof + 1),
                       {report.displacement_m, report.force_n});
      break;
    case LoopReport::Kind::measurement:
      measured_ = report.measurement;
      presence_.set_last_step(measured_.step);
      record_step();
      if (presence_.state() == LifecycleState::running) answer(now, MeasurementFlags::none);
      break;
    case LoopReport::Kind::at_rest: presence_.set_state(LifecycleState::finished); break;
  }
}

void SiteLink::answer(Instant now, MeasurementFlags flags) noexcept {
  ForceMeasurement measurement;
  measurement.substructure = index_;
  measurement.sender = presence_.identity().incarnation;
  measurement.step = measured_.step;
  measurement.model_time_s = measured_.model_time_s;
  measurement.imposed_displacement_m = measured_.imposed_displacement_m;
  measurement.measured_displacement_m = measured_.measured_displacement_m;
  measurement.force_n = measured_.force_n;
  measurement.flags = measured_.flags | flags;
  measurement.receive_time = receive_time_;
  measurement.send_time = now.time_since_epoch();
  measurement.command_send_time = command_send_time_;
  ports_.measurements.send(measurement);
}

void SiteLink::record_step() noexcept {
  std::size_t next = 0;
  row_[next++] = static_cast<double>(measured_.step);
  row_[next++] = measured_.model_time_s;
  for (Eigen::Index k = 0; k < dofs_; ++k) {
    row_[next++] = measured_.target_displacement_m[k];
    row_[next++] = measured_.measured_displacement_m[k];
    row_[next++] = measured_.force_n[k];
  }
  row_[next++] = static_cast<double>(static_cast<std::uint32_t>(measured_.flags));
  steps_.append(row_);
}

void SiteLink::batch_signals() noexcept {
  SignalSample sample;
  while (ports_.signals.take(sample)) {
    block_.samples[block_.sample_count++] = sample;
    if (block_.sample_count < kMaxSignalSamples) continue;
    ports_.signal_blocks.send(block_);
    block_.sample_count = 0;
  }
}

TableLayout SiteLink::steps_layout(int dofs) {
  TableLayout layout{"steps", {{"step", ""}, {"model_time_s", "s"}}};
  for (int k = 1; k <= dofs; ++k) {
    const std::string suffix = dofs == 1 ? "" : "_" + std::to_string(k);
    layout.columns.push_back({"target_displacement_m" + suffix, "m"});
    layout.columns.push_back({"measured_displacement_m" + suffix, "m"});
    layout.columns.push_back({"measured_force_n" + suffix, "N"});
  }
  layout.columns.push_back({"flags", ""});
  return layout;
}

Instant SiteNode::advance(Instant now) noexcept {
  // Requests flow down and reports come back within one call.
  static_cast<void>(link_.advance(now));
  const Instant loop_wake = loop_.advance(now);
  return std::min(link_.advance(now), loop_wake);
}

}  // namespace hybridtest
