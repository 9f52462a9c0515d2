#include "coordinator/coordinator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "core/assert.hpp"
#include "core/client_fault.hpp"
#include "core/message_copies.hpp"
#include "core/stall.hpp"

namespace hybridtest {
namespace {

using std::chrono::milliseconds;

/// Interval at which arm and stop are sent again until every participant has followed them.
constexpr Duration kControlRepeat = milliseconds{250};

/// Interval at which silent links are looked for.
constexpr Duration kLinkLook = milliseconds{100};

/// For the others to leave a test that was never armed: nothing moves.
constexpr Duration kLeaveUnarmed = milliseconds{500};

/// In real time, where the rehearsal lost answers: copies of the first command that starts the time of a site. Without
/// it the site would start when the second comes, and answer after every deadline.
constexpr int kStartCopies = 4;

/// Recorded as the times of an exchange that was not answered.
constexpr double kUnanswered = std::numeric_limits<double>::quiet_NaN();

[[nodiscard]] bool has_reached(LifecycleState state, LifecycleState wanted) noexcept {
  if (wanted == LifecycleState::armed) return state == LifecycleState::armed || state == LifecycleState::running;
  if (wanted == LifecycleState::finished) {
    return state == LifecycleState::finished || state == LifecycleState::refused || state == LifecycleState::lost;
  }
  return state == wanted;
}

}  // namespace

Coordinator::Coordinator(CoordinatorSettings settings, std::unique_ptr<MotionSource> source, Presence& presence,
                         CoordinatorPorts ports, CoordinatorRecord record)
    : settings_{std::move(settings)},
      source_{std::move(source)},
      presence_{presence},
      ports_{ports},
      record_{record},
      ledger_{settings_.substructures.size()},
      commands_(settings_.substructures.size()),
      clocks_{settings_.substructures.size()},
      heard_before_silence_(settings_.substructures.size()),
      restoring_force_n_{Eigen::VectorXd::Zero(source_->current().displacement_m.size())},
      applied_force_n_{Eigen::VectorXd::Zero(source_->current().displacement_m.size())} {
  HYBRIDTEST_ASSERT(settings_.substructures.size() <= kMaxSimulatedSubstructures);
  HYBRIDTEST_ASSERT(settings_.load.covers(settings_.last_step, restoring_force_n_.size()));
  HYBRIDTEST_ASSERT(settings_.stiffness_n_per_m.size() == 0 ||
                    settings_.stiffness_n_per_m.rows() == restoring_force_n_.size());
  const bool has_forces = settings_.load.has_forces();
  if (has_forces) forces_n_.setZero(restoring_force_n_.size());
  row_.resize(4 + std::max<std::size_t>(1, settings_.load.ground_count()) +
              (has_forces ? 5 : 4) * settings_.recorded_dofs.size());
  if (is_real_time()) {
    HYBRIDTEST_ASSERT(record_.bridges != nullptr);
    rehearsal_.emplace(settings_.substructures.size(), from_seconds(settings_.step_s));
    misses_.resize(settings_.substructures.size());
    // Of the size of their answers, so that keeping one does not allocate.
    for (const CoupledSubstructure& substructure : settings_.substructures) {
      ForceMeasurement free;
      free.imposed_displacement_m = free.measured_displacement_m = free.force_n =
          InterfaceVector::Zero(substructure.interface.size());
      early_.insert(early_.end(), early_each(), free);
    }
    for (const CoupledSubstructure& substructure : settings_.substructures) {
      bridges_.emplace_back(settings_.bridging, substructure.initial_stiffness_n_per_m, substructure.interface.size());
    }
  }
  // In paced mode a site answers one step after the command: when its actuators have reached the target.
  const bool is_paced = settings_.mode == CouplingMode::paced;
  const Duration paced_step = is_paced ? from_seconds(settings_.step_s * settings_.time_scale) : Duration{};
  for (const CoupledSubstructure& substructure : settings_.substructures) {
    repeats_.emplace_back(settings_.repeat_after + paced_step,
                          substructure.role == Role::experimental_site ? paced_step : Duration{});
  }
}

Instant Coordinator::advance(Instant now) noexcept {
  if (!std::exchange(began_, true)) phase_began_ = now;
  static_cast<void>(presence_.advance(now));
  take_control_messages(now);
  if (requested_stop_ != StopReason::none)
    begin_stop(now, std::exchange(requested_stop_, StopReason::none), kOperatorId);
  if (std::exchange(lead_has_left_, false) && phase_ < Phase::stopping) {
    report(now, Severity::fault, EventCode::opensees_lost, kOpenSeesId,
           {static_cast<double>(ClientFault::closed), 0.0});
    begin_stop(now, phase_ == Phase::running ? StopReason::opensees_lost : StopReason::participant_failed, kOpenSeesId);
  }
  if (presence_.is_duplicate() && phase_ != Phase::done && phase_ != Phase::stopping) {
    report(now, Severity::fault, EventCode::second_coordinator);
    reason_ = StopReason::refused;
    presence_.set_state(LifecycleState::refused);
    phase_ = Phase::done;
  }

  if (phase_ == Phase::settling) settle(now);
  if (phase_ == Phase::assembling) assemble(now);
  if (phase_ == Phase::arming) arm(now);
  if (phase_ == Phase::rehearsing) rehearse(now);
  if (phase_ == Phase::running) run(now);
  if (phase_ == Phase::stopping) stop(now);
  presence_.set_last_step(completed_steps_ - 1);
  return next_wake(now, presence_.tell(now));
}

CoordinatorReport Coordinator::report() const noexcept {
  return {presence_.state(), reason_, completed_steps_, running_time_};
}

void Coordinator::take_control_messages(Instant now) noexcept {
  TestControl message;
  while (ports_.control_in.take(message)) {
    if (message.sender == presence_.identity().incarnation || message.sender_role != Role::operator_tool) continue;
    // Sent again to all participants: the operator's tool may have exited before they discovered it.
    switch (message.verb) {
      case ControlVerb::stop:
        if (message.reason == StopReason::participant_failed) {
          begin_stop(now, message.reason);  // `hybridtest run` knows which one
        } else {
          begin_stop(now, StopReason::interrupted, kOperatorId);
        }
        break;
      case ControlVerb::emergency_stop:
        if (!any(presence_.faults() & FaultFlags::emergency_stop)) {
          report(now, Severity::fault, EventCode::emergency_stop);
        }
        presence_.raise(FaultFlags::emergency_stop);
        control(ControlVerb::emergency_stop, StopReason::emergency_stop);
        begin_stop(now, StopReason::emergency_stop, kOperatorId);
        break;
      case ControlVerb::pause:
        if (is_real_time()) {
          report(now, Severity::warning, EventCode::pause_refused);
          break;
        }
        // Reported again when it is asked for again: whoever asks has not heard the answer.
        is_paused_ = true;
        report(now, Severity::information, EventCode::test_paused);
        control(ControlVerb::pause);
        break;
      case ControlVerb::resume:
        is_paused_ = false;
        report(now, Severity::information, EventCode::test_resumed);
        control(ControlVerb::resume);
        step_due_ = std::max(step_due_, now);
        step_completed_ = now;
        break;
      case ControlVerb::arm:
      case ControlVerb::start: break;  // only the coordinator gives these
    }
  }
}

void Coordinator::settle(Instant now) noexcept {
  if (now - phase_began_ < settings_.settle) return;
  TestAnnouncement announcement;
  announcement.test_name = settings_.test_name;
  announcement.coordinator = presence_.identity().incarnation;
  if (resumed_) announcement.succeeds = resumed_->first_coordinator;
  announcement.scenario_digest = presence_.identity().scenario_digest;
  announcement.mode = settings_.mode;
  announcement.step_s = settings_.step_s;
  announcement.duration_s = settings_.duration_s;
  announcement.time_scale = settings_.time_scale;
  for (const CoupledSubstructure& substructure : settings_.substructures) {
    announcement.substructures.push_back(
        {substructure.id, substructure.role, static_cast<std::uint16_t>(substructure.interface.size())});
  }
  ports_.announcements.send(announcement);
  presence_.set_state(LifecycleState::ready);
  phase_ = Phase::assembling;
  phase_began_ = now;
}

void Coordinator::assemble(Instant now) noexcept {
  const bool has_source = source_->awaited(now).empty();
  tell_events(now);
  for (const auto& substructure : settings_.substructures) {
    const Peer* peer = presence_.find(substructure.id);
    if (peer == nullptr || peer->status.state != LifecycleState::refused) continue;
    // With the same scenario, it gave up before it heard of this coordinator.
    const bool gave_up = !resumed_ && peer->status.scenario_digest == presence_.identity().scenario_digest;
    EventCode code = EventCode::digest_mismatch;
    if (gave_up) code = EventCode::participant_missing;
    if (resumed_) code = EventCode::resume_refused;
    report(now, Severity::fault, code, substructure.id);
    begin_stop(now, gave_up ? StopReason::not_assembled : StopReason::refused, substructure.id);
    return;
  }
  if ((resumed_ ? everyone_goes_on() : everyone_is(LifecycleState::ready)) && everyone_is_linked() && has_source) {
    for (std::size_t i = 0; i < settings_.substructures.size(); ++i) {
      ledger_.bind(static_cast<SubstructureIndex>(i),
                   presence_.find(settings_.substructures[i].id)->status.incarnation);
    }
    phase_ = Phase::arming;
    phase_began_ = now;
    control_repeat_due_ = now;
  } else if (now - phase_began_ >= settings_.discovery_timeout) {
    end_unassembled(now, LifecycleState::ready);
  }
}

void Coordinator::arm(Instant now) noexcept {
  watch_participants(now);
  if (phase_ != Phase::arming) return;
  if (everyone_is(LifecycleState::armed)) {
    if (!resumed_) report(now, Severity::information, EventCode::test_armed);
    if (!rehearsal_) {
      start(now);
      return;
    }
    rehearsal_->begin(now);
    phase_ = Phase::rehearsing;
    return;
  }
  if (now - phase_began_ >= settings_.arm_timeout) {
    end_unassembled(now, LifecycleState::armed);
    return;
  }
  if (now >= control_repeat_due_) {
    control(ControlVerb::arm);
    control_repeat_due_ = now + kControlRepeat;
  }
}

void Coordinator::rehearse(Instant now) noexcept {
  watch_participants(now);
  if (phase_ != Phase::rehearsing) return;
  while (ports_.measurements.take(measurement_)) rehearsal_->take(measurement_, now);
  if (const std::optional<std::uint16_t> round = rehearsal_->next_round(now)) send_rehearsal(*round, now);
  if (rehearsal_->is_over(now)) judge_rehearsal(now);
}

void Coordinator::send_rehearsal(std::uint16_t round, Instant now) noexcept {
  for (std::size_t i = 0; i < commands_.size(); ++i) {
    DisplacementCommand& command = commands_[i];
    const Eigen::Index dofs = settings_.substructures[i].interface.size();
    command.substructure = static_cast<SubstructureIndex>(i);
    command.coordinator = presence_.identity().incarnation;
    command.is_rehearsal = true;
    command.iteration = round;
    command.point_count = dofs <= kMaxSiteDofs ? kCommandPoints : 1;  // as large as those of the test
    for (CommandPoint& point : command.points) {
      point.step = 0;
      point.displacement_m = point.velocity_m_per_s = point.acceleration_m_per_s2 = InterfaceVector::Zero(dofs);
    }
    send_command(command.substructure, now);
  }
}

void Coordinator::judge_rehearsal(Instant now) noexcept {
  const Duration available = from_seconds(settings_.step_s) - settings_.bridging.deadline;
  const CoupledSubstructure* too_slow = nullptr;
  for (std::size_t i = 0; i < commands_.size(); ++i) {
    const auto index = static_cast<SubstructureIndex>(i);
    const Duration round_trip = rehearsal_->percentile(index, 99);
    is_lossy_ = is_lossy_ || rehearsal_->percentile(index, 100) == Duration::max();
    usual_round_trip_ = std::max(usual_round_trip_, std::min(rehearsal_->percentile(index, 50), available));
    const bool is_in_time = round_trip <= available;
    const bool starts = is_in_time || settings_.bridging.start_anyway;
    const double round_trip_s =
        round_trip == Duration::max() ? std::numeric_limits<double>::infinity() : to_seconds(round_trip);
    Severity severity = Severity::information;
    if (!is_in_time) severity = starts ? Severity::warning : Severity::fault;
    report(now, severity, is_in_time ? EventCode::round_trip_rehearsed : EventCode::network_too_slow,
           settings_.substructures[i].id, {round_trip_s, to_seconds(available)});
    if (!starts && too_slow == nullptr) too_slow = &settings_.substructures[i];
    commands_[i].is_rehearsal = false;
    commands_[i].point_count = 0;
  }
  if (too_slow != nullptr) {
    begin_stop(now, StopReason::network_too_slow, too_slow->id);
  } else {
    start(now);
  }
}

void Coordinator::start(Instant now) noexcept {
  control(ControlVerb::start);
  presence_.set_state(LifecycleState::running);
  phase_ = Phase::running;
  phase_began_ = now;
  step_completed_ = now;
  step_due_ = now;
  if (!resumed_) {
    report(now, Severity::information, EventCode::test_started);
    started_ = now;
    return;
  }
  started_ = resumed_->started;
  report(now, Severity::warning, EventCode::test_continued, {},
         {static_cast<double>(completed_steps_), to_seconds(now - resumed_->last_recorded)});
  if (completed_steps_ > settings_.last_step) begin_stop(now, StopReason::completed);
}

void Coordinator::run(Instant now) noexcept {
  watch_participants(now);
  clock_is_fresh_ = true;
  if (record_.clocks != nullptr) clocks_.record(now, false, *record_.clocks);
  while (phase_ == Phase::running) {
    if (!command_is_open_ && !open_next(now)) return;
    if (!command_is_sent_) {
      if (is_paused_ || now < step_due_) return;
      const int copies = is_lossy_ && ledger_.step() == 1 ? kStartCopies : 1;
      for (int copy = 0; copy < copies; ++copy) {
        for (std::size_t i = 0; i < commands_.size(); ++i) send_command(static_cast<SubstructureIndex>(i), now);
      }
      command_is_sent_ = true;
      ledger_.open(ledger_.step(), ledger_.iteration(), now);
      for (std::size_t i = 0; i < commands_.size(); ++i) {
        for (int copy = 0; copy < copies; ++copy) ledger_.count_attempt(static_cast<SubstructureIndex>(i));
        repeats_[i].open(now);
      }
      repeat_due_ = first_repeat();
      // The previous step is recorded now, while the substructures work on this one.
      record_step(now);
    }
    if (is_real_time()) take_early(now);
    while (!ledger_.is_complete() && ports_.measurements.take(measurement_)) {
      take_answer(measurement_, now);
    }
    if (!ledger_.is_complete() && has_deadline()) {
      if (now < deadline_of(ledger_.step())) return;
      bridge_unanswered();
    }
    if (!ledger_.is_complete()) {
      repeat_unanswered(now);
      return;
    }
    complete_command(now);
  }
}

void Coordinator::watch_links(Instant now) noexcept {
  if (now < links_due_) return;
  links_due_ = now + kLinkLook;
  for (std::size_t i = 0; i < settings_.substructures.size(); ++i) {
    const ParticipantId& id = settings_.substructures[i].id;
    const Peer* peer = presence_.find(id);
    if (peer == nullptr || peer->status.state == LifecycleState::lost) continue;
    const bool is_silent = presence_.is_silent(*peer, now);
    Instant& heard = heard_before_silence_[i];
    if (is_silent == (heard != Instant{})) continue;
    const double silent_s = to_seconds((is_silent ? now : peer->last_seen) - (is_silent ? peer->last_seen : heard));
    if (is_silent) {
      report(now, Severity::warning, EventCode::link_silent, id, {silent_s, to_seconds(presence_.silence_most())});
    } else {
      report(now, Severity::information, EventCode::link_back, id, {silent_s, 0.0});
    }
    heard = is_silent ? peer->last_seen : Instant{};
  }
}

void Coordinator::watch_participants(Instant now) noexcept {
  watch_links(now);
  if (watched_ == presence_.changes()) return;
  // Whoever obeyed an emergency stop has left perhaps, and the others after it: the stop is the cause, and not the
  // loss.
  const bool is_emergency = std::ranges::any_of(settings_.substructures, [&](const CoupledSubstructure& substructure) {
    const Peer* peer = presence_.find(substructure.id);
    return peer != nullptr && any(peer->status.faults & FaultFlags::emergency_stop);
  });
  if (is_emergency) {
    begin_stop(now, StopReason::emergency_stop, kOperatorId);
    return;
  }
  const CoupledSubstructure* lost = nullptr;
  for (const auto& substructure : settings_.substructures) {
    const Peer* peer = presence_.find(substructure.id);
    const bool is_lost =
        peer == nullptr || peer->status.state == LifecycleState::lost || peer->status.state == LifecycleState::refused;
    if (!is_lost) continue;
    report(now, Severity::fault, EventCode::participant_lost, substructure.id);
    presence_.raise(FaultFlags::participant_lost);
    if (lost == nullptr) lost = &substructure;
  }
  if (lost != nullptr) {
    begin_stop(now, StopReason::participant_lost, lost->id);
    return;
  }
  constexpr FaultFlags kRecording = FaultFlags::records_dropped | FaultFlags::recording_failed;
  const CoupledSubstructure* recorder = nullptr;  // the first that cannot record
  bool has_recording_fault = any(presence_.faults() & kRecording);
  for (const auto& substructure : settings_.substructures) {
    const Peer* peer = presence_.find(substructure.id);
    has_recording_fault = has_recording_fault || any(peer->status.faults & kRecording);
    if (any(peer->status.faults & kRecording) && recorder == nullptr) recorder = &substructure;
    const bool has_other_fault = (peer->status.faults & kRecording) != peer->status.faults;
    const bool is_leaving =
        peer->status.state == LifecycleState::stopping || peer->status.state == LifecycleState::finished;
    // A site whose command is overdue is not the cause while another participant keeps the test waiting.
    const CoupledSubstructure* slow = owes_answer(substructure);
    if ((peer->status.faults | kRecording) == (FaultFlags::command_age | kRecording) && slow != nullptr) {
      report(now, Severity::fault, EventCode::answer_overdue, slow->id, {to_seconds(now - ledger_.opened()), 0.0});
      begin_stop(now, StopReason::participant_lost, slow->id);
      return;
    }
    // Nor is it where the program that leads has not asked for the next force.
    if ((peer->status.faults | kRecording) == (FaultFlags::command_age | kRecording) && phase_ == Phase::running &&
        !command_is_open_) {
      report(now, Severity::fault, EventCode::opensees_silent, {}, {to_seconds(now - step_completed_), 0.0});
      begin_stop(now, StopReason::opensees_lost, kOpenSeesId);
      return;
    }
    if (any(peer->status.faults & FaultFlags::resume_refused)) {
      begin_stop(now, StopReason::resume_refused, substructure.id);
      return;
    }
    if (any(peer->status.faults & FaultFlags::model_failed)) {
      begin_stop(now, StopReason::model_failed, substructure.id);
      return;
    }
    if (has_other_fault || is_leaving) {
      begin_stop(now, has_other_fault ? StopReason::interlock : StopReason::interrupted, substructure.id);
      return;
    }
  }
  if (has_recording_fault && settings_.stop_on_recording_failure) {
    begin_stop(now, StopReason::recording_failed, recorder == nullptr ? ParticipantId{kCoordinatorId} : recorder->id);
    return;
  }
  watched_ = presence_.changes();
}

const CoupledSubstructure* Coordinator::owes_answer(const CoupledSubstructure& except) const noexcept {
  if (phase_ != Phase::running || !command_is_sent_) return nullptr;
  for (std::size_t i = 0; i < settings_.substructures.size(); ++i) {
    const bool owes = !ledger_.has_answered(static_cast<SubstructureIndex>(i));
    if (owes && &settings_.substructures[i] != &except) return &settings_.substructures[i];
  }
  return nullptr;
}

void Coordinator::watch_pace(Instant now) noexcept {
  if (settings_.mode != CouplingMode::paced) return;
  const double taken_s = to_seconds(now - std::exchange(step_completed_, now));
  const double step_s = settings_.step_s * settings_.time_scale;
  // Of many in a row the longest are reported; the summary counts all of them.
  if (is_paused_ || !is_stall(taken_s, step_s) || taken_s < 1.5 * longest_stall_s_) return;
  longest_stall_s_ = taken_s;
  report(now, Severity::warning, EventCode::test_stalled, settings_.substructures[last_to_answer_].id,
         {taken_s, step_s});
}

void Coordinator::tell_events(Instant now) noexcept {
  while (const std::optional<LeadEvent> event = source_->take_event()) {
    report(now, Severity::warning, event->code, event->subject, event->values);
  }
}

bool Coordinator::open_next(Instant now) noexcept {
  const NextMotion next = source_->next(now);
  tell_events(now);
  switch (next) {
    case NextMotion::command: break;
    case NextMotion::none: record_step(now); return false;
    case NextMotion::end: {
      const LeadEnd end = source_->end();
      const LeadEvent& event = end.event;
      if (event.code != EventCode::none) report(now, Severity::fault, event.code, event.subject, event.values);
      begin_stop(now, end.reason, end.reason == StopReason::completed ? ParticipantId{} : ParticipantId{kOpenSeesId});
      return false;
    }
  }
  if (!source_->current().displacement_m.allFinite()) {
    presence_.raise(FaultFlags::not_finite);
    begin_stop(now, StopReason::not_finite, kCoordinatorId);
    return false;
  }
  open_command(now);
  return true;
}

void Coordinator::open_command(Instant now) noexcept {
  const MotionState& current = source_->current();
  const Step step = completed_steps_;
  const auto iteration = static_cast<std::uint16_t>(source_->iteration());
  ledger_.open(step, iteration, now);
  command_is_open_ = true;
  command_is_sent_ = false;
  for (std::size_t i = 0; i < commands_.size(); ++i) {
    DisplacementCommand& command = commands_[i];
    const InterfaceMap& interface = settings_.substructures[i].interface;
    // The history is for sites; of a wide interface it would make each command four times as large.
    const Step points = interface.size() <= kMaxSiteDofs ? kCommandPoints : 1;
    if (iteration == 0 && points > 1) {
      // Velocity and acceleration of the previous point are in equilibrium now; its displacement is what was commanded.
      if (step > 0) fill_rates(interface, source_->completed(), command.points[0]);
      for (std::size_t k = command.points.size() - 1; k > 0; --k) {
        message_copies::carry(command.points[k - 1], command.points[k], message_copies::Move{});
      }
    }
    fill_point(interface, step, current, command.points[0]);
    command.iteration = iteration;
    command.is_trial = source_->is_trial();
    command.point_count = static_cast<std::uint8_t>(std::min(step + 1, points));
    command.substructure = static_cast<SubstructureIndex>(i);
    command.coordinator = presence_.identity().incarnation;
    command.attempt = 0;
  }
}

void Coordinator::send_command(SubstructureIndex substructure, Instant now) noexcept {
  commands_[substructure].send_time = now.time_since_epoch();
  clock_is_fresh_ = false;
  ports_.commands.send(commands_[substructure]);
}

void Coordinator::repeat_unanswered(Instant now) noexcept {
  if (now < repeat_due_) return;
  for (std::size_t i = 0; i < commands_.size(); ++i) {
    const auto index = static_cast<SubstructureIndex>(i);
    if (now < repeats_[i].due()) continue;
    ++commands_[i].attempt;
    ledger_.count_attempt(index);
    send_command(index, now);
    repeats_[i].sent_again(now);
    if (repeats_[i].becomes_overdue(now)) {
      report(now, Severity::warning, EventCode::command_repeated, settings_.substructures[i].id,
             {static_cast<double>(commands_[i].attempt), 0.0});
    }
  }
  repeat_due_ = first_repeat();
}

Instant Coordinator::first_repeat() const noexcept {
  Instant first = kNever;
  for (const CommandRepeats& repeats : repeats_) first = std::min(first, repeats.due());
  return first;
}

void Coordinator::take_answer(const ForceMeasurement& answer, Instant now) noexcept {
  switch (ledger_.enter(answer, now)) {
    case LedgerEntry::accepted:
      last_to_answer_ = answer.substructure;
      repeats_[answer.substructure].answered(answer, now);
      if (clock_is_fresh_) clocks_.add(answer, now);
      break;
    case LedgerEntry::stale:
      if (is_real_time()) bridges_[answer.substructure].take_late(answer.step, answer.force_n);
      break;
    case LedgerEntry::early:
      if (is_real_time()) keep_early(answer);
      break;
    case LedgerEntry::duplicate:
    case LedgerEntry::foreign: break;
  }
}

void Coordinator::keep_early(const ForceMeasurement& answer) noexcept {
  const auto slots = std::span{early_}.subspan(answer.substructure * early_each(), early_each());
  const auto free = std::ranges::find(slots, kNoStep, &ForceMeasurement::step);
  if (free != slots.end()) *free = answer;  // what does not fit is bridged
}

void Coordinator::take_early(Instant now) noexcept {
  for (ForceMeasurement& answer : early_) {
    if (answer.step == kNoStep || answer.step > ledger_.step()) continue;
    take_answer(answer, now);
    answer.step = kNoStep;
  }
}

void Coordinator::bridge_unanswered() noexcept {
  for (std::size_t i = 0; i < commands_.size(); ++i) {
    const auto index = static_cast<SubstructureIndex>(i);
    if (ledger_.has_answered(index)) continue;
    ledger_.bridge(index, bridges_[i].bridge(ledger_.step(), commands_[i].newest().displacement_m));
  }
}

bool Coordinator::watch_deadlines(Instant now) noexcept {
  for (std::size_t i = 0; i < commands_.size(); ++i) {
    const auto index = static_cast<SubstructureIndex>(i);
    const ForceMeasurement& answer = ledger_.answer(index);
    if (!ledger_.is_bridged(index)) {
      bridges_[i].take(ledger_.step(), commands_[i].newest().displacement_m, answer.force_n);
    }
    Misses& misses = misses_[i];
    if (!any(answer.flags & (MeasurementFlags::bridged | MeasurementFlags::missed))) {
      misses.in_a_row = 0;
      continue;
    }
    ++misses.in_a_row;
    ++misses.total;
    const ParticipantId& id = settings_.substructures[i].id;
    if (misses.in_a_row > settings_.bridging.most_in_a_row) {
      report(now, Severity::fault, EventCode::deadlines_missed, id,
             {static_cast<double>(misses.in_a_row), static_cast<double>(settings_.bridging.most_in_a_row)});
      begin_stop(now, StopReason::deadlines_missed, id);
      return false;
    }
    // Of many gaps those that are longer than all before are reported; the summary counts all.
    if (misses.in_a_row <= misses.longest) continue;
    misses.longest = misses.in_a_row;
    report(now, Severity::warning, EventCode::answers_bridged, id,
           {static_cast<double>(misses.in_a_row), static_cast<double>(misses.total)});
  }
  record_bridges(false);
  return true;
}

void Coordinator::record_bridges(bool at_end) noexcept {
  for (std::size_t i = 0; i < bridges_.size(); ++i) {
    for (const BridgedStep& bridged : bridges_[i].closed(at_end)) {
      const std::array<double, 5> row{static_cast<double>(bridged.step), static_cast<double>(i),
                                      static_cast<double>(bridged.in_a_row), bridged.energy_added_j,
                                      bridged.came_late ? 1.0 : 0.0};
      record_.bridges->append(row);
    }
  }
}

void Coordinator::complete_command(Instant now) noexcept {
  record_exchanges();
  if (!collect_forces(now)) return;
  if (is_real_time() && !watch_deadlines(now)) return;
  record_answers();
  const bool was_trial = source_->is_trial();
  advance_source();
  if (was_trial) {
    go_on_trying(now);
  } else {
    complete_step(now);
  }
}

void Coordinator::advance_source() noexcept {
  settings_.load.ground_at(ledger_.step(), applied_force_n_);
  if (settings_.load.has_forces()) {
    settings_.load.forces_at(ledger_.step(), forces_n_);
    applied_force_n_ += forces_n_;
  }
  if (!source_->is_trial()) iterations_ = source_->iteration();
  command_is_open_ = false;
  source_->advance(restoring_force_n_, applied_force_n_);
}

bool Coordinator::collect_forces(Instant now) noexcept {
  restoring_force_n_.setZero();
  for (std::size_t i = 0; i < commands_.size(); ++i) {
    const InterfaceMap& interface = settings_.substructures[i].interface;
    const InterfaceVector& force_n = ledger_.answer(static_cast<SubstructureIndex>(i)).force_n;
    if (force_n.size() != interface.size() || !force_n.allFinite()) {
      report(now, Severity::fault, EventCode::measurement_not_finite, settings_.substructures[i].id);
      presence_.raise(FaultFlags::not_finite);
      begin_stop(now, StopReason::not_finite, settings_.substructures[i].id);
      return false;
    }
    interface.add_to_structure(force_n, restoring_force_n_);
    source_->take_force(static_cast<SubstructureIndex>(i), force_n);
  }
  add_elastic_force();
  return true;
}

void Coordinator::go_on_trying(Instant now) noexcept {
  const double missing_m = source_->missing_m();
  if (missing_m == 0.0 || !source_->current().displacement_m.allFinite()) return;
  report(now, Severity::fault, EventCode::no_equilibrium, {}, {static_cast<double>(source_->iteration()), missing_m});
  begin_stop(now, StopReason::no_equilibrium, kCoordinatorId);
}

void Coordinator::complete_step(Instant now) noexcept {
  const Step step = ledger_.step();
  ++completed_steps_;
  watch_pace(now);
  if (step == settings_.last_step) {
    record_step(now);
    report(now, Severity::information, EventCode::test_completed);
    begin_stop(now, StopReason::completed);
    return;
  }
  if (is_real_time()) {
    // A site starts its time when the first command after this one comes.
    if (step == 0) step_zero_ = now;
    step_due_ = time_of(step);
    return;
  }
  if (settings_.mode != CouplingMode::paced) return;
  // A step is sent one step ahead of its own time and not earlier. Lost time is not made up for.
  step_due_ = std::max(step_due_ + from_seconds(settings_.step_s * settings_.time_scale), now);
  if (step == 0) step_due_ = now;
}

void Coordinator::add_elastic_force() noexcept {
  if (settings_.stiffness_n_per_m.nonZeros() == 0) return;
  restoring_force_n_.noalias() += settings_.stiffness_n_per_m * source_->current().displacement_m;
}

void Coordinator::record_step(Instant now) noexcept {
  if (std::exchange(recorded_steps_, completed_steps_) == completed_steps_) return;
  fill_step_row(to_seconds(now - started_));
  record_.steps.append(row_);
}

void Coordinator::fill_step_row(double wall_time_s) noexcept {
  const MotionState& completed = source_->completed();
  const auto step = completed_steps_ - 1;
  std::size_t next = 0;
  row_[next++] = static_cast<double>(step);
  row_[next++] = static_cast<double>(step) * settings_.step_s;
  row_[next++] = wall_time_s;
  const std::size_t ground_motions = settings_.load.ground_count();
  if (ground_motions == 0) row_[next++] = 0.0;
  for (std::size_t k = 0; k < ground_motions; ++k) row_[next++] = settings_.load.ground_acceleration(k, step);
  for (const Eigen::Index dof : settings_.recorded_dofs) {
    row_[next++] = completed.displacement_m[dof];
    row_[next++] = completed.velocity_m_per_s[dof];
    row_[next++] = completed.acceleration_m_per_s2[dof];
    row_[next++] = restoring_force_n_[dof];
    if (settings_.load.has_forces()) row_[next++] = forces_n_[dof];
  }
  row_[next++] = iterations_;
}

void Coordinator::record_exchanges() noexcept {
  for (std::size_t i = 0; i < commands_.size(); ++i) {
    const auto index = static_cast<SubstructureIndex>(i);
    std::array<double, 7> row{static_cast<double>(ledger_.step()),
                              static_cast<double>(i),
                              kUnanswered,
                              static_cast<double>(ledger_.attempts(index)),
                              0.0,
                              kUnanswered,
                              static_cast<double>(ledger_.iteration())};
    if (ledger_.has_answered(index)) {
      const ForceMeasurement& answer = ledger_.answer(index);
      row[4] = static_cast<double>(static_cast<std::uint32_t>(answer.flags));
      if (!ledger_.is_bridged(index)) {
        row[2] = to_seconds(ledger_.round_trip(index)) * 1e6;
        row[5] = to_seconds(answer.send_time - answer.receive_time) * 1e6;
      }
    }
    record_.exchanges.append(row);
  }
}

void Coordinator::begin_stop(Instant now, StopReason reason, const ParticipantId& who) noexcept {
  if (phase_ == Phase::stopping || phase_ == Phase::done) return;
  reason_ = reason;
  const bool was_armed = phase_ >= Phase::arming || resumed_;
  stop_by_ = now + (was_armed ? settings_.stop_timeout : std::min(settings_.stop_timeout, kLeaveUnarmed));
  if (phase_ == Phase::running) {
    running_time_ = now - started_;
    record_step(now);
    if (command_is_sent_ && !ledger_.is_complete()) record_exchanges();
    record_bridges(true);
    if (record_.clocks != nullptr) clocks_.record(now, true, *record_.clocks);
  }
  report(now, reason == StopReason::completed ? Severity::information : Severity::warning, EventCode::test_stopped, who,
         {static_cast<double>(reason), 0.0});
  presence_.set_state(LifecycleState::stopping);
  phase_ = Phase::stopping;
  phase_began_ = now;
  control_repeat_due_ = now;
}

void Coordinator::stop(Instant now) noexcept {
  if (now >= control_repeat_due_) {
    control(ControlVerb::stop, reason_);
    control_repeat_due_ = now + kControlRepeat;
  }
  if (!everyone_is(LifecycleState::finished) && now < stop_by_) return;
  presence_.set_state(LifecycleState::finished);
  phase_ = Phase::done;
}

void Coordinator::end_unassembled(Instant now, LifecycleState wanted) noexcept {
  ParticipantId first;
  for (std::size_t i = 0; i < settings_.substructures.size(); ++i) {
    const CoupledSubstructure& substructure = settings_.substructures[i];
    const Peer* peer = presence_.find(substructure.id);
    const bool is_there = peer != nullptr && has_reached(peer->status.state, wanted);
    if (is_there && is_linked(i)) continue;
    report(now, Severity::fault, EventCode::participant_missing, substructure.id, {is_there ? 1.0 : 0.0, 0.0});
    if (first.empty()) first = substructure.id;
  }
  if (const ParticipantId awaited = source_->awaited(now); !awaited.empty()) {
    report(now, Severity::fault, EventCode::opensees_missing, awaited);
    if (first.empty()) first = kOpenSeesId;
  }
  begin_stop(now, StopReason::not_assembled, first);
}

bool Coordinator::is_linked(std::size_t substructure) const noexcept {
  return !ports_.is_linked || ports_.is_linked(static_cast<SubstructureIndex>(substructure));
}

bool Coordinator::everyone_is_linked() const noexcept {
  for (std::size_t i = 0; i < settings_.substructures.size(); ++i) {
    if (!is_linked(i)) return false;
  }
  return true;
}

bool Coordinator::everyone_is(LifecycleState wanted) const noexcept {
  return std::ranges::all_of(settings_.substructures, [&](const CoupledSubstructure& substructure) {
    const Peer* peer = presence_.find(substructure.id);
    // A participant that never joined has nothing to finish.
    if (peer == nullptr) return wanted == LifecycleState::finished;
    return has_reached(peer->status.state, wanted);
  });
}

Instant Coordinator::next_wake(Instant now, Instant presence_wake) const noexcept {
  switch (phase_) {
    case Phase::settling: return std::min(presence_wake, phase_began_ + settings_.settle);
    case Phase::assembling: return std::min(presence_wake, phase_began_ + settings_.discovery_timeout);
    case Phase::arming: return std::min(presence_wake, control_repeat_due_);
    case Phase::rehearsing: return std::min(presence_wake, rehearsal_->wake());
    case Phase::running: {
      if (!command_is_open_) return std::min(presence_wake, source_->wake());
      if (is_paused_) return presence_wake;
      if (!command_is_sent_) return std::min(presence_wake, std::max(step_due_, now));
      return std::min(presence_wake, has_deadline() ? deadline_of(ledger_.step()) : repeat_due_);
    }
    case Phase::stopping: return std::min({presence_wake, control_repeat_due_, stop_by_});
    case Phase::done: return kNever;
  }
  return kNever;
}

void Coordinator::report(Instant now, Severity severity, EventCode code, const ParticipantId& subject,
                         std::array<double, 2> values) noexcept {
  const Step step = completed_steps_ - 1;
  presence_.report(now, severity, code, subject, values, step,
                   step == kNoStep ? 0.0 : static_cast<double>(step) * settings_.step_s);
}

void Coordinator::control(ControlVerb verb, StopReason reason) noexcept {
  TestControl message;
  message.verb = verb;
  message.sender = presence_.identity().incarnation;
  message.sender_role = Role::coordinator;
  message.reason = reason;
  ports_.control_out.send(message);
}

void Coordinator::fill_point(const InterfaceMap& interface, Step step, const MotionState& motion,
                             CommandPoint& point) const noexcept {
  point.step = step;
  point.model_time_s = static_cast<double>(step) * settings_.step_s;
  interface.to_interface(motion.displacement_m, point.displacement_m);
  fill_rates(interface, motion, point);
}

void Coordinator::fill_rates(const InterfaceMap& interface, const MotionState& motion, CommandPoint& point) noexcept {
  interface.to_interface(motion.velocity_m_per_s, point.velocity_m_per_s);
  interface.to_interface(motion.acceleration_m_per_s2, point.acceleration_m_per_s2);
}

TableLayout Coordinator::steps_layout(const std::vector<std::string>& dofs, std::size_t ground_motions,
                                      bool has_forces) {
  TableLayout layout{
      "steps", {{"step", ""}, {"model_time_s", "s"}, {"wall_time_s", "s"}, {"ground_acceleration_m_per_s2", "m/s2"}}};
  for (std::size_t k = 2; k <= ground_motions; ++k) {
    layout.columns.push_back({"ground_acceleration_" + std::to_string(k) + "_m_per_s2", "m/s2"});
  }
  for (const std::string& dof : dofs) {
    layout.columns.push_back({"displacement_" + dof + "_m", "m"});
    layout.columns.push_back({"velocity_" + dof + "_m_per_s", "m/s"});
    layout.columns.push_back({"acceleration_" + dof + "_m_per_s2", "m/s2"});
    layout.columns.push_back({"restoring_force_" + dof + "_n", "N"});
    if (has_forces) layout.columns.push_back({"applied_force_" + dof + "_n", "N"});
  }
  layout.columns.push_back({"iterations", ""});
  return layout;
}

TableLayout Coordinator::bridges_layout() {
  return {"bridges",
          {{"step", ""}, {"substructure", ""}, {"in_a_row", ""}, {"energy_added_j", "J"}, {"came_late", ""}}};
}

TableLayout Coordinator::exchanges_layout() {
  return {"exchanges",
          {{"step", ""},
           {"substructure", ""},
           {"round_trip_us", "us"},
           {"attempts", ""},
           {"flags", ""},
           {"turnaround_us", "us"},
           {"iteration", ""}}};
}

}  // namespace hybridtest
