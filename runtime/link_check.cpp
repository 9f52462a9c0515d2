#include "runtime/link_check.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

namespace hybridtest {
namespace {

constexpr const char* kCheckGroup = "link_check";
constexpr std::string_view kVersionSignal = "version";
constexpr Duration kGreetingPeriod = std::chrono::milliseconds{200};
/// For the answers to the last commands.
constexpr Duration kSettling = std::chrono::seconds{1};
/// Results are sent without receipt, so several times.
constexpr Duration kTelling = std::chrono::seconds{2};
/// Of a substructure, beyond what the coordinator needs.
constexpr Duration kEchoMargin = std::chrono::seconds{10};

/// What the coordinator tells of a link, in this order; [-] or [s].
constexpr std::array<const char*, 7> kToldSignals{
    "sent", "answered", "round_trip_min", "round_trip_median", "round_trip_p99", "clock_offset", "clock_uncertainty"};

LiveSignal check_signal(std::string_view name, std::string_view subject, double value) {
  LiveSignal signal;
  signal.name = name;
  signal.subject = subject;
  signal.least = signal.most = signal.last = {value};
  return signal;
}

std::vector<LiveSignal> as_signals(const LinkMeasurement& link) {
  const std::array<double, kToldSignals.size()> values{
      static_cast<double>(link.sent), static_cast<double>(link.answered),
      link.round_trip_s_min,          link.round_trip_s_median,
      link.round_trip_s_p99,          link.clock_offset_s,
      link.clock_uncertainty_s};
  std::vector<LiveSignal> signals;
  for (std::size_t i = 0; i < values.size(); ++i) {
    signals.push_back(check_signal(kToldSignals[i], link.substructure.view(), values[i]));
  }
  return signals;
}

std::optional<LinkMeasurement> as_measurement(const SignalBlock& block) {
  if (block.signals.size() != kToldSignals.size()) return std::nullopt;
  std::array<double, kToldSignals.size()> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const LiveSignal& signal = block.signals[i];
    if (signal.name.view() != kToldSignals[i] || signal.last.empty()) return std::nullopt;
    values[i] = signal.last.front();
  }
  if (!(values[0] >= 0.0 && values[0] < 1e9 && values[1] >= 0.0 && values[1] < 1e9)) return std::nullopt;
  LinkMeasurement link;
  link.substructure = ParticipantId{block.signals.front().subject.view()};
  link.sent = static_cast<int>(values[0]);
  link.answered = static_cast<int>(values[1]);
  link.round_trip_s_min = values[2];
  link.round_trip_s_median = values[3];
  link.round_trip_s_p99 = values[4];
  link.clock_offset_s = values[5];
  link.clock_uncertainty_s = values[6];
  return link;
}

/// The smallest value that the given part of the sorted values does not pass.
double quantile(const std::vector<double>& sorted, double part) {
  if (sorted.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto rank = static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1) + 0.5);
  return sorted[std::min(rank, sorted.size() - 1)];
}

/// As large as a command of the test.
DisplacementCommand full_command(SubstructureIndex substructure, Eigen::Index dofs, Incarnation coordinator) {
  DisplacementCommand command;
  command.substructure = substructure;
  command.coordinator = coordinator;
  command.is_rehearsal = true;
  command.point_count = kCommandPoints;
  for (CommandPoint& point : command.points) {
    point.displacement_m = point.velocity_m_per_s = point.acceleration_m_per_s2 = InterfaceVector::Zero(dofs);
  }
  return command;
}

}  // namespace

LinkGreeting::LinkGreeting(const LinkCheckSettings& settings, Transport& transport)
    : settings_{settings},
      statuses_in_{transport.status_inbox()},
      statuses_out_{transport.status_outbox()},
      blocks_in_{transport.signal_inbox()},
      blocks_out_{transport.signal_outbox()} {}

const HeardParticipant* LinkGreeting::find(const ParticipantId& id) const noexcept {
  const auto found = std::ranges::find(heard_, id, [](const HeardParticipant& one) { return one.status.id; });
  return found == heard_.end() ? nullptr : &*found;
}

void LinkGreeting::listen(Instant) noexcept {
  ParticipantStatus status;
  while (statuses_in_->take(status)) hear(status);
  SignalBlock block;
  while (blocks_in_->take(block)) hear(block);
}

void LinkGreeting::hear(const ParticipantStatus& status) {
  if (status.state == LifecycleState::lost) return;
  const auto known = std::ranges::find(heard_, status.id, [](const HeardParticipant& one) { return one.status.id; });
  if (known != heard_.end()) {
    known->status = status;
  } else if (heard_.size() <= kMaxSubstructures) {
    heard_.push_back({.status = status, .version = {}});
  }
}

void LinkGreeting::hear(const SignalBlock& block) {
  if (block.group.view() != kCheckGroup || block.signals.empty()) return;
  const LiveSignal& first = block.signals.front();
  if (first.name.view() == kVersionSignal) {
    const auto known = std::ranges::find(heard_, block.participant, [](const auto& one) { return one.status.id; });
    if (known != heard_.end()) known->version = first.subject.text();
    return;
  }
  const auto told = as_measurement(block);
  if (!told || block.participant != ParticipantId{kCoordinatorId}) return;
  const auto known = std::ranges::find(told_, told->substructure, &LinkMeasurement::substructure);
  if (known != told_.end()) {
    *known = *told;
  } else if (told_.size() < kMaxSubstructures) {
    told_.push_back(*told);
  }
}

void LinkGreeting::send_block(std::uint16_t part, std::vector<LiveSignal> signals) {
  SignalBlock block;
  block.participant = settings_.identity.id;
  block.incarnation = settings_.identity.incarnation;
  block.group = kCheckGroup;
  block.part = part;
  block.sequence = sequence_++;
  block.model_time_s = {0.0};
  block.signals = std::move(signals);
  blocks_out_->send(block);
}

Instant LinkGreeting::greet(Instant now) noexcept {
  if (now < next_greeting_) return next_greeting_;
  next_greeting_ = now + kGreetingPeriod;
  ParticipantStatus status;
  status.id = settings_.identity.id;
  status.role = settings_.identity.role;
  status.incarnation = settings_.identity.incarnation;
  status.scenario_digest = settings_.identity.scenario_digest;
  status.clock = now.time_since_epoch();
  statuses_out_->send(status);
  send_block(0, {check_signal(kVersionSignal, settings_.version, 0.0)});
  for (std::size_t i = 0; i < telling_.size(); ++i) {
    send_block(static_cast<std::uint16_t>(i + 1), as_signals(telling_[i]));
  }
  return next_greeting_;
}

LinkProbe::LinkProbe(const LinkCheckSettings& settings, const std::vector<ExpectedParticipant>& substructures,
                     Transport& transport)
    : settings_{settings},
      transport_{transport},
      greeting_{settings, transport},
      commands_{transport.command_outbox(static_cast<std::uint16_t>(substructures.size()))},
      answers_{transport.measurement_inbox(static_cast<std::uint16_t>(substructures.size()))},
      clocks_{substructures.size()},
      phase_end_{Instant{} + settings.patience} {
  for (std::size_t i = 0; i < substructures.size(); ++i) {
    Link link;
    link.id = substructures[i].id;
    link.command =
        full_command(static_cast<SubstructureIndex>(i), substructures[i].dofs, settings.identity.incarnation);
    links_.push_back(std::move(link));
  }
}

bool LinkProbe::is_there(std::size_t substructure) const noexcept {
  const HeardParticipant* heard = greeting_.find(links_[substructure].id);
  return heard != nullptr && !heard->version.empty() &&
         transport_.reachable(static_cast<SubstructureIndex>(substructure));
}

Instant LinkProbe::advance(Instant now) noexcept {
  greeting_.listen(now);
  take_answers(now);
  Instant next = greeting_.greet(now);
  switch (phase_) {
    case Phase::waiting: next = std::min(next, wait(now)); break;
    case Phase::measuring: next = std::min(next, measure(now)); break;
    case Phase::settling:
      if (now >= phase_end_) {
        phase_ = Phase::telling;
        phase_end_ = now + kTelling;
        greeting_.tell(measurements());
      }
      next = std::min(next, phase_end_);
      break;
    case Phase::telling:
      if (now >= phase_end_) phase_ = Phase::done;
      next = std::min(next, phase_end_);
      break;
    case Phase::done: break;
  }
  return next;
}

Instant LinkProbe::wait(Instant now) noexcept {
  bool all_are_there = true;
  for (std::size_t i = 0; i < links_.size(); ++i) {
    links_[i].is_there = is_there(i);
    all_are_there = all_are_there && links_[i].is_there;
  }
  if (!all_are_there && now < phase_end_) return phase_end_;
  phase_ = Phase::measuring;
  next_command_ = now;
  return now;
}

Instant LinkProbe::measure(Instant now) noexcept {
  const bool nobody_is_there = std::ranges::none_of(links_, &Link::is_there);
  if (sent_ >= settings_.commands || nobody_is_there) {
    phase_ = Phase::settling;
    phase_end_ = nobody_is_there ? now : now + kSettling;
    return phase_end_;
  }
  if (now < next_command_) return next_command_;
  for (Link& link : links_) {
    if (!link.is_there) continue;
    link.command.points[0].step = sent_;
    link.command.send_time = wall(now);
    link.send_times.push_back(link.command.send_time);
    link.answered.push_back(false);
    commands_->send(link.command);
    ++link.sent;
  }
  ++sent_;
  next_command_ += settings_.period;
  return next_command_;
}

void LinkProbe::take_answers(Instant now) noexcept {
  ForceMeasurement answer;
  while (answers_->take(answer)) {
    if (answer.substructure >= links_.size()) continue;
    Link& link = links_[answer.substructure];
    const auto step = static_cast<std::size_t>(answer.step);
    const bool is_new = answer.step >= 0 && step < link.send_times.size() && !link.answered[step] &&
                        answer.command_send_time == link.send_times[step];
    if (!is_new) continue;
    link.answered[step] = true;
    const double there_s = to_seconds(answer.receive_time - answer.command_send_time);
    const double back_s = to_seconds(wall(now) - answer.send_time);
    link.round_trips_s.push_back(there_s + back_s);
    clocks_.add(answer, Instant{wall(now)});
  }
  clocks_.record(Instant{wall(now)}, phase_ > Phase::measuring, clock_sink_);
}

/// Columns as in ClockWindows::layout().
void LinkProbe::ClockSink::append(std::span<const double> row) noexcept {
  links_[static_cast<std::size_t>(row[0])].clock.push_back({.there_at_s = row[2],
                                                            .there_s = row[3],
                                                            .back_at_s = row[5],
                                                            .back_s = row[6],
                                                            .exchanges = row[1],
                                                            .mean_there_s = row[4],
                                                            .mean_back_s = row[7]});
}

std::vector<LinkMeasurement> LinkProbe::measurements() const {
  std::vector<LinkMeasurement> all;
  for (const Link& link : links_) {
    std::vector<double> sorted = link.round_trips_s;
    std::ranges::sort(sorted);
    const ClockRelation clock = relate_clocks(link.clock).value_or(ClockRelation{});
    all.push_back({.substructure = link.id,
                   .sent = link.sent,
                   .answered = static_cast<int>(sorted.size()),
                   .round_trip_s_min = quantile(sorted, 0.0),
                   .round_trip_s_median = quantile(sorted, 0.5),
                   .round_trip_s_p99 = quantile(sorted, 0.99),
                   .clock_offset_s = clock.offset_s,
                   .clock_uncertainty_s = clock.offset_uncertainty_s});
  }
  return all;
}

LinkEcho::LinkEcho(const LinkCheckSettings& settings, SubstructureIndex substructure, Eigen::Index dofs,
                   Transport& transport)
    : settings_{settings},
      greeting_{settings, transport},
      commands_{transport.command_inbox(substructure)},
      answers_{transport.measurement_outbox(substructure)},
      give_up_{Instant{} + settings.patience} {
  answer_.substructure = substructure;
  answer_.sender = settings.identity.incarnation;
  answer_.imposed_displacement_m = answer_.measured_displacement_m = answer_.force_n = InterfaceVector::Zero(dofs);
}

Instant LinkEcho::advance(Instant now) noexcept {
  DisplacementCommand command;
  while (commands_->take(command)) {
    answer_.step = command.newest().step;
    answer_.iteration = command.iteration;
    answer_.receive_time = settings_.wall_zero + now.time_since_epoch();
    answer_.send_time = answer_.receive_time;
    answer_.command_send_time = command.send_time;
    answers_->send(answer_);
    give_up_ = std::max(give_up_, now + kEchoMargin);
  }
  greeting_.listen(now);
  if (measurement() != nullptr || now >= give_up_) is_done_ = true;
  return std::min(greeting_.greet(now), give_up_);
}

const LinkMeasurement* LinkEcho::measurement() const noexcept {
  const auto found = std::ranges::find(greeting_.told(), settings_.identity.id, &LinkMeasurement::substructure);
  return found == greeting_.told().end() ? nullptr : &*found;
}

}  // namespace hybridtest
