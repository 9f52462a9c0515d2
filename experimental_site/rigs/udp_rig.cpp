#include "experimental_site/rigs/udp_rig.hpp"

#include <stdexcept>
#include <utility>

#include "core/assert.hpp"
#include "core/config_error.hpp"
#include "core/parameters/checked_parameter.hpp"

namespace hybridtest {
namespace {

static_assert(std::atomic<std::uint32_t>::is_always_lock_free, "exchange() must not lock");

/// Interval at which connect() and arm() repeat their request until it is answered.
constexpr Duration kRepeat = std::chrono::milliseconds{20};
/// Where every second datagram is lost, at least one of these arrives in 99 of 100 cases.
constexpr int kStopDatagrams = 7;
/// More than the default receive queue of a socket, so that an exchange after a pause gets the newest.
constexpr int kAnswersPerExchange = 512;
/// One byte more than a datagram, so that a longer one is detected.
constexpr std::size_t kReceiveBytes = 2 * kMeasurementBytes;

std::int64_t whole_samples(Duration duration, Duration control_period) {
  return (duration + control_period - Duration{1}) / control_period;
}

}  // namespace

UdpRig::UdpRig(const Settings& settings, std::unique_ptr<DatagramPort> port)
    : settings_{settings},
      port_{std::move(port)},
      watchdog_samples_{0},
      row_(link_layout().columns.size(), 0.0),
      answers_{settings.actuators} {
  HYBRIDTEST_ASSERT(port_ != nullptr);
  HYBRIDTEST_ASSERT(settings.actuators >= 1 && settings.actuators <= kMaxSiteDofs);
  const double period_s = to_seconds(settings.control_period);
  static_cast<void>(checked("control_period_s", period_s, {.low = 0.0, .high = 4.29, .low_open = true}));
  static_cast<void>(checked("watchdog_s", to_seconds(settings.watchdog), {.low = 2.0 * period_s}));
  const Range waits =
      settings.follows_datagrams ? kNotNegative : Range{.low = 0.0, .high = period_s, .high_open = true};
  static_cast<void>(checked("reply_wait_s", to_seconds(settings.reply_wait), waits));
  static_cast<void>(checked("connect_timeout_s", to_seconds(settings.connect_timeout), kPositive));
  watchdog_samples_ = whole_samples(settings.watchdog, settings.control_period);
  rest_.displacement_m = SiteVector::Zero(settings.actuators);
}

TableLayout UdpRig::link_layout() {
  return {"rig_link",
          {{"sample", "1"},
           {"command_sequence", "1"},
           {"answered_sequence", "1"},
           {"controller_sequence", "1"},
           {"controller_time_s", "s"},
           {"controller_state", "1"},
           {"controller_status", "1"},
           {"commands_discarded", "1"},
           {"silent_samples", "1"},
           {"answers_received", "1"},
           {"answers_skipped", "1"},
           {"answers_stale", "1"},
           {"answers_invalid", "1"}}};
}

void UdpRig::record_to(const RigTables& tables) { link_record_ = &tables(link_layout().name); }

void UdpRig::connect() {
  port_->open();
  phase_ = Phase::disconnected;
  loop_count_ = 0;
  answers_.begin(sequence_ + 1);
  const bool is_ready = repeat_until(ControllerRequest::inactive, [this] {
    return answers_.has_any() && answers_.newest().state == ControllerState::inactive;
  });
  if (!answers_.has_any()) throw std::runtime_error{silence()};
  if (!is_ready) {
    throw std::runtime_error{"the controller " + settings_.name + " does not become inactive; its state is " +
                             std::to_string(static_cast<int>(answers_.newest().state)) + ", its status bits " +
                             std::to_string(answers_.newest().status) +
                             ": clear its fault, and check that no other computer commands it"};
  }
  const bool follows_datagrams = (answers_.newest().status & kFollowsDatagrams) != 0;
  if (follows_datagrams != settings_.follows_datagrams) {
    throw std::runtime_error{"the controller " + settings_.name +
                             (follows_datagrams ? " follows the datagrams; expected a controller with its own clock"
                                                : " has its own clock; expected a controller that follows the "
                                                  "datagrams, as a simulator does")};
  }
  phase_ = Phase::connected;
}

void UdpRig::arm() {
  // One atomic step, so that it does not undo a stop_motion() from another thread.
  Phase expected = Phase::connected;
  if (!phase_.compare_exchange_strong(expected, Phase::armed)) {
    if (expected == Phase::armed) return;
    throw std::runtime_error{
        "the udp rig cannot be armed: it is not connected, or it was stopped after that; "
        "connect it again"};
  }
  const bool is_active = repeat_until(ControllerRequest::active, [this] {
    return answers_.newest().state == ControllerState::active || phase_ != Phase::armed;
  });
  if (is_active && phase_ == Phase::armed) {
    answered_ = answers_.newest().command_sequence;
    silent_samples_ = 0;
    return;
  }
  stop_motion();
  throw std::runtime_error{"the controller " + settings_.name + " did not become active; its state is " +
                           std::to_string(static_cast<int>(answers_.newest().state)) + ", its status bits " +
                           std::to_string(answers_.newest().status)};
}

RigStatus UdpRig::exchange(const ActuatorCommand& command, RigFeedback& feedback) noexcept {
  const Phase phase = phase_;
  const auto fits = [this](const SiteVector& vector) { return vector.size() == settings_.actuators; };
  if (phase == Phase::disconnected || !fits(command.displacement_m) || !command.displacement_m.allFinite() ||
      !fits(feedback.displacement_m) || !fits(feedback.force_n)) {
    return RigStatus::fault;
  }
  ++loop_count_;
  const auto request = phase == Phase::armed     ? ControllerRequest::active
                       : phase == Phase::stopped ? ControllerRequest::stop
                                                 : ControllerRequest::inactive;
  const std::uint32_t sent = send(request, command);
  take_answers(sent);
  watch();
  feedback.displacement_m = answers_.newest().displacement_m;
  feedback.force_n = answers_.newest().force_n;
  record(command.sample, sent);
  return status(phase);
}

RigFault UdpRig::fault() const noexcept {
  if (phase_ == Phase::disconnected) return RigFault::not_connected;
  const MeasurementDatagram& newest = answers_.newest();
  if ((newest.status & kEmergencyStopped) != 0) return RigFault::controller_emergency_stop;
  if (newest.state == ControllerState::fault) return RigFault::controller_fault;
  if (silent_samples_ >= watchdog_samples_) return RigFault::no_answer;
  if ((newest.status & kWatchdogExpired) != 0) return RigFault::controller_watchdog;
  return newest.state == ControllerState::active ? RigFault::invalid_command : RigFault::controller_stopped;
}

void UdpRig::stop_motion() noexcept {
  phase_ = Phase::stopped;
  for (int i = 0; i < kStopDatagrams; ++i) send(ControllerRequest::stop, rest_);
}

bool UdpRig::repeat_until(ControllerRequest request, const std::function<bool()>& is_done) {
  const std::int64_t attempts = whole_samples(settings_.connect_timeout, kRepeat);
  std::array<std::byte, kReceiveBytes> buffer{};
  for (std::int64_t attempt = 0; attempt < attempts; ++attempt) {
    const std::uint32_t sent = send(request, rest_);
    Duration patience = kRepeat;
    for (int i = 0; i < kAnswersPerExchange; ++i) {
      const auto size = port_->receive(buffer, patience);
      if (!size) break;
      answers_.take(std::span{buffer}.first(*size), sent);
      if (is_done()) return true;
    }
  }
  return is_done();
}

std::uint32_t UdpRig::send(ControllerRequest request, const ActuatorCommand& command) noexcept {
  CommandDatagram datagram;
  datagram.sequence = ++sequence_;
  datagram.loop_count = loop_count_;
  datagram.request = request;
  datagram.control_period_ns = static_cast<std::uint32_t>(settings_.control_period.count());
  datagram.time_ns = from_seconds(command.time_s).count();
  datagram.displacement_m = command.displacement_m;
  CommandBytes bytes;
  encode(datagram, bytes);
  port_->send(bytes);
  return datagram.sequence;
}

void UdpRig::take_answers(std::uint32_t awaited) noexcept {
  std::array<std::byte, kReceiveBytes> buffer;
  Duration patience = settings_.reply_wait;
  for (int i = 0; i < kAnswersPerExchange; ++i) {
    Duration no_patience{};
    const bool is_answered = answers_.newest().command_sequence == awaited;
    const auto size = port_->receive(buffer, is_answered ? no_patience : patience);
    if (!size) return;
    answers_.take(std::span{buffer}.first(*size), awaited);
  }
}

void UdpRig::watch() noexcept {
  const std::uint32_t answered = answers_.newest().command_sequence;
  silent_samples_ = answered == answered_ ? silent_samples_ + 1 : 0;
  answered_ = answered;
}

RigStatus UdpRig::status(Phase phase) const noexcept {
  const ControllerState state = answers_.newest().state;
  const bool is_wrong = state == ControllerState::fault || (phase == Phase::armed && state != ControllerState::active);
  return is_wrong || silent_samples_ >= watchdog_samples_ ? RigStatus::fault : RigStatus::healthy;
}

std::string UdpRig::silence() const {
  std::string text = "no answer from the controller " + settings_.name;
  if (answers_.last_defect() != DatagramDefect::none) {
    text += " that is valid; the last datagram had " + std::string{describe(answers_.last_defect())};
    if (answers_.last_defect() == DatagramDefect::actuators) {
      text += ", expected " + std::to_string(settings_.actuators);
    }
    return text;
  }
  return text + ": check that it is running and that the network passes datagrams in both directions";
}

void UdpRig::record(std::int64_t sample, std::uint32_t sent) noexcept {
  if (link_record_ == nullptr) return;
  const MeasurementDatagram& newest = answers_.newest();
  const UdpAnswers::Counts& counts = answers_.counts();
  std::size_t next = 0;
  for (const double value :
       {static_cast<double>(sample), static_cast<double>(sent), static_cast<double>(newest.command_sequence),
        static_cast<double>(newest.sequence), to_seconds(Duration{newest.time_ns}), static_cast<double>(newest.state),
        static_cast<double>(newest.status), static_cast<double>(newest.discarded), static_cast<double>(silent_samples_),
        static_cast<double>(counts.received), static_cast<double>(counts.skipped), static_cast<double>(counts.stale),
        static_cast<double>(counts.invalid)}) {
    row_[next++] = value;
  }
  link_record_->append(row_);
}

}  // namespace hybridtest
