#include "numerical_substructure/numerical_node.hpp"

#include <cstring>
#include <utility>

#include "core/message_copies.hpp"
#include "core/refused_resumption.hpp"
#include "core/rehearsal_answer.hpp"

namespace hybridtest {

NumericalNode::NumericalNode(SubstructureIndex index, CouplingMode mode, std::unique_ptr<SubstructureModel> model,
                             Presence& presence, MembershipPorts membership, Inbox<DisplacementCommand>& commands,
                             Outbox<ForceMeasurement>& measurements, RowSink& steps, std::vector<Eigen::Index> recorded,
                             std::size_t remembered)
    : index_{index},
      mode_{mode},
      model_{std::move(model)},
      presence_{presence},
      membership_{presence, membership},
      commands_{commands},
      measurements_{measurements},
      steps_{steps},
      memory_{remembered, model_->interface_dofs()},
      force_n_{InterfaceVector::Zero(model_->interface_dofs())},
      recorded_{std::move(recorded)},
      row_(2 + 2 * recorded_.size()) {}

Instant NumericalNode::advance(Instant now) noexcept {
  static_cast<void>(presence_.advance(now));
  if (requested_stop_ != StopReason::none) presence_.set_state(LifecycleState::finished);
  for (Request request = membership_.next_request(now); request != Request::none;
       request = membership_.next_request(now)) {
    obey(request);
    if (is_done()) break;
  }
  if (is_pending_ && !is_done()) await_model(now);
  while (!is_pending_ && !has_failed_ && commands_.take(command_)) serve(command_, now);
  const Instant wake = presence_.tell(now);
  return is_done() ? kNever : wake;
}

bool NumericalNode::is_done() const noexcept {
  return presence_.state() == LifecycleState::finished || presence_.state() == LifecycleState::refused;
}

void NumericalNode::obey(Request request) noexcept {
  switch (request) {
    case Request::arm:
      if (!is_restored_) model_->reset();
      presence_.set_state(LifecycleState::armed);
      break;
    case Request::start: presence_.set_state(LifecycleState::running); break;
    case Request::stop:
    case Request::emergency_stop: presence_.set_state(LifecycleState::finished); break;
    case Request::pause:
    case Request::resume:
    case Request::none: break;  // without commands the model does not move
  }
}

void NumericalNode::serve(const DisplacementCommand& command, Instant now) noexcept {
  if (command.coordinator != membership_.coordinator()) return;
  if (command.is_rehearsal) {
    if (presence_.state() != LifecycleState::armed) return;
    answer_rehearsal(command, presence_.identity().incarnation, now.time_since_epoch(), answer_);
    measurements_.send(answer_);
    return;
  }
  // A command can overtake the start message; it then starts the test.
  if (presence_.state() == LifecycleState::armed) presence_.set_state(LifecycleState::running);
  if (presence_.state() != LifecycleState::running) return;
  if (!command.fits(force_n_.size())) return;

  const CommandPoint& newest = command.newest();
  const std::pair asked{newest.step, command.iteration};
  const std::pair answered{last_point_.step, last_iteration_};
  if (membership_.has_successor()) {
    // The newest point may be a trial, of which a step has several: it is compared with its own answer.
    if (const CommandPoint* other = memory_.first_other(command, last_step_)) {
      refuse(Recall::different, *other, now);
      return;
    }
    if (asked <= answered) {
      answer_again(command, now);
      return;
    }
  }
  if (asked < answered) return;
  if (asked == answered) {
    answer(command, now, MeasurementFlags::repeated);
    return;
  }
  // In real time the model goes on behind a gap that the points of the command do not fill.
  const bool may_skip = mode_ == CouplingMode::real_time && last_step_ != kNoStep;
  const auto is_next = [&](const CommandPoint& point) {
    return may_skip ? point.step > last_step_ : point.step == last_step_ + 1;
  };
  for (int i = command.point_count - 1; i > 0; --i) {
    const CommandPoint& point = command.points[static_cast<std::size_t>(i)];
    if (is_next(point) && !compute(point, false, now)) return;
  }
  if (!is_next(newest) || !compute(newest, command.is_trial, now)) return;
  answer_newest(now);
}

void NumericalNode::answer_again(const DisplacementCommand& command, Instant now) noexcept {
  const CommandPoint& point = command.newest();
  switch (const Recall recall = memory_.recall(point, command.iteration, answer_)) {
    case Recall::answered: send_answer(command, now, MeasurementFlags::repeated); break;
    case Recall::pending: break;
    case Recall::different:
    case Recall::forgotten: refuse(recall, point, now); break;
  }
}

void NumericalNode::refuse(Recall recall, const CommandPoint& point, Instant now) noexcept {
  report_refused_resumption(recall, point, memory_, presence_, now);
  requested_stop_ = StopReason::resume_refused;
  presence_.set_state(LifecycleState::finished);
}

NumericalNode::Restored NumericalNode::restore(const CommandPoint& point, std::uint16_t iteration,
                                               const InterfaceVector& recorded_force_n) noexcept {
  if (!std::exchange(is_restored_, true)) model_->reset();
  if (!compute(point, false, Instant{})) return Restored::not_at_once;
  last_iteration_ = iteration;
  memory_.keep_command(point.step, iteration, point.displacement_m);
  memory_.keep_answer(point.step, iteration, point.model_time_s, point.displacement_m, point.displacement_m, force_n_,
                      MeasurementFlags::none);
  const bool is_same = recorded_force_n.size() == force_n_.size() &&
                       std::memcmp(recorded_force_n.data(), force_n_.data(),
                                   sizeof(double) * static_cast<std::size_t>(force_n_.size())) == 0;
  return is_same ? Restored::same : Restored::different;
}

void NumericalNode::answer_newest(Instant now) noexcept {
  last_iteration_ = command_.iteration;
  memory_.keep_command(last_point_.step, last_iteration_, last_point_.displacement_m);
  memory_.keep_answer(last_point_.step, last_iteration_, last_point_.model_time_s, last_point_.displacement_m,
                      last_point_.displacement_m, force_n_, MeasurementFlags::none);
  answer(command_, now, MeasurementFlags::none);
}

bool NumericalNode::compute(const CommandPoint& point, bool is_trial, Instant now) noexcept {
  if (is_tried_) model_->revert();
  message_copies::carry(point, computed_, message_copies::Copy{});
  is_trial_ = is_trial;
  return conclude(is_trial ? model_->begin_trial(point.displacement_m, point.velocity_m_per_s, force_n_, now)
                           : model_->begin_step(point.displacement_m, point.velocity_m_per_s, force_n_, now),
                  now);
}

void NumericalNode::await_model(Instant now) noexcept {
  if (!conclude(model_->take_answer(force_n_, now), now)) return;
  if (last_point_.step == command_.newest().step) {
    answer_newest(now);
  } else {
    serve(command_, now);  // goes on with the points that follow
  }
}

bool NumericalNode::conclude(ModelAnswer answer, Instant now) noexcept {
  is_pending_ = answer == ModelAnswer::pending;
  if (answer == ModelAnswer::failed) {
    has_failed_ = true;
    const ModelFailure failure = model_->failure();
    presence_.raise(FaultFlags::model_failed);
    presence_.report(now, Severity::fault, EventCode::model_failed, presence_.identity().id,
                     {static_cast<double>(failure.fault), failure.value}, computed_.step, computed_.model_time_s);
  }
  if (answer != ModelAnswer::ready) return false;
  is_tried_ = is_trial_;
  std::swap(last_point_, computed_);
  if (!is_trial_) record_step(last_point_);
  return true;
}

void NumericalNode::record_step(const CommandPoint& point) noexcept {
  last_step_ = point.step;
  presence_.set_last_step(point.step);

  std::size_t next = 0;
  row_[next++] = static_cast<double>(point.step);
  row_[next++] = point.model_time_s;
  for (const Eigen::Index k : recorded_) {
    row_[next++] = point.displacement_m[k];
    row_[next++] = force_n_[k];
  }
  steps_.append(row_);
}

void NumericalNode::answer(const DisplacementCommand& command, Instant now, MeasurementFlags flags) noexcept {
  answer_.step = last_point_.step;
  answer_.iteration = last_iteration_;
  answer_.model_time_s = last_point_.model_time_s;
  copy_values(last_point_.displacement_m, answer_.imposed_displacement_m);
  copy_values(last_point_.displacement_m, answer_.measured_displacement_m);
  copy_values(force_n_, answer_.force_n);
  send_answer(command, now, flags);
}

void NumericalNode::send_answer(const DisplacementCommand& command, Instant now, MeasurementFlags flags) noexcept {
  answer_.substructure = index_;
  answer_.sender = presence_.identity().incarnation;
  answer_.flags = flags;
  answer_.receive_time = now.time_since_epoch();
  answer_.send_time = now.time_since_epoch();
  answer_.command_send_time = command.send_time;
  measurements_.send(answer_);
}

TableLayout NumericalNode::steps_layout(const std::vector<std::string>& dofs) {
  TableLayout layout{"steps", {{"step", ""}, {"model_time_s", "s"}}};
  for (const std::string& dof : dofs) {
    layout.columns.push_back({"displacement_" + dof + "_m", "m"});
    layout.columns.push_back({"force_" + dof + "_n", "N"});
  }
  return layout;
}

}  // namespace hybridtest
