#include "report/live/test_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/event_text.hpp"
#include "core/exit_code.hpp"
#include "core/faults.hpp"
#include "recording/run_file.hpp"
#include "runtime/progress.hpp"

namespace hybridtest {
namespace {

constexpr std::size_t kEvents = 500;
constexpr std::size_t kSignals = 256;
constexpr std::size_t kParticipants = 64;
constexpr std::size_t kFormer = 16;
/// A repeat on the other path comes within this number of events.
constexpr std::size_t kRepeats = 64;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::string_view kLinkAwaited = "not heard by the coordinator, which waits for its link";

/// Statuses come four times per lease; the lease itself is not announced.
constexpr Duration kSilence = std::chrono::seconds{2};
constexpr int kMissedStatuses = 4;
constexpr Duration kRateWindow = std::chrono::seconds{2};
constexpr Duration kRateShortest = std::chrono::milliseconds{300};
/// Steps that were on their way when the test was paused.
constexpr Duration kPauseTakesEffect = std::chrono::seconds{1};

bool has_left(LifecycleState state) noexcept {
  return state == LifecycleState::finished || state == LifecycleState::refused || state == LifecycleState::lost;
}

bool contains(const std::vector<Incarnation>& all, Incarnation one) { return std::ranges::find(all, one) != all.end(); }

void remember(std::vector<Incarnation>& former, Incarnation one) {
  if (former.size() == kFormer) former.erase(former.begin());
  former.push_back(one);
}

std::string capital(std::string text) {
  if (!text.empty() && text.front() >= 'a' && text.front() <= 'z') text.front() = static_cast<char>(text.front() - 32);
  return text;
}

std::string listed(const std::vector<std::string>& ids) {
  std::string text;
  for (const std::string& id : ids) text += (text.empty() ? "" : ", ") + id;
  return text;
}

std::string_view text_of(Severity severity) noexcept {
  switch (severity) {
    case Severity::information: return "information";
    case Severity::warning: return "warning";
    case Severity::fault: return "fault";
  }
  return "unknown";
}

nlohmann::json in_words(FaultFlags faults) {
  nlohmann::json words = nlohmann::json::array();
  for (std::uint32_t bit = 0; bit < 32; ++bit) {
    const auto flag = static_cast<FaultFlags>(1U << bit);
    if (!any(faults & flag)) continue;
    std::string word{name(flag)};
    std::ranges::replace(word, '_', ' ');
    words.push_back(word.ends_with("limit") ? word + " exceeded" : word);
  }
  return words;
}

bool is_whole(const SignalBlock& block) noexcept {
  const std::size_t points = block.model_time_s.size();
  const bool is_ordered = std::ranges::is_sorted(block.model_time_s);
  return points > 0 && is_ordered && std::ranges::all_of(block.signals, [points](const LiveSignal& signal) {
           return signal.least.size() == points && signal.most.size() == points && signal.last.size() == points;
         });
}

}  // namespace

TestView::TestView(std::string name, std::uint64_t first_cursor)
    : name_{std::move(name)}, cursor_{first_cursor}, begin_{first_cursor} {}

void TestView::begin_anew(Incarnation coordinator) {
  std::erase_if(participants_, [&](const auto& entry) {
    const ParticipantStatus& status = entry.second.status;
    return status.role == Role::coordinator ? status.incarnation != coordinator
                                            : entry.second.is_lost || has_left(status.state);
  });
  for (auto& [id, participant] : participants_) {
    participant.held_by.clear();
    participant.silent.clear();
  }
  events_.clear();
  streams_.clear();
  signal_count_ = 0;
  pace_.clear();
  step_ = -1.0;
  is_paused_ = false;
  stop_reason_ = StopReason::none;
  stopped_by_.clear();
  begin_ = ++cursor_;
}

void TestView::learn(const TestAnnouncement& announcement) {
  if (announcement_ && announcement_->coordinator == announcement.coordinator) return;
  if (contains(former_coordinators_, announcement.coordinator)) return;
  if (announcement_) {
    remember(former_coordinators_, announcement_->coordinator);
    begin_anew(announcement.coordinator);
  }
  announcement_ = announcement;
}

TestView::Participant* TestView::accept(const std::string& id, Incarnation incarnation,
                                        const ParticipantStatus& status) {
  const auto known = participants_.find(id);
  if (known == participants_.end()) {
    if (participants_.size() == kParticipants || status.state == LifecycleState::lost) return nullptr;
    if (status.role == Role::coordinator && contains(former_coordinators_, incarnation)) return nullptr;
    Participant participant;
    participant.status = status;
    return &participants_.emplace(id, std::move(participant)).first->second;
  }
  Participant& participant = known->second;
  if (participant.status.incarnation == incarnation) return &participant;
  // Of two processes with one id, the one that is in the test stays until it leaves.
  const bool is_free = participant.is_lost || has_left(participant.status.state);
  if (!is_free || contains(participant.former, incarnation) || status.state == LifecycleState::lost) return nullptr;
  std::vector<Incarnation> former = std::move(participant.former);
  remember(former, participant.status.incarnation);
  participant = {};
  participant.status = status;
  participant.former = std::move(former);
  return &participant;
}

void TestView::learn(const ParticipantStatus& status, std::size_t path, Instant now) {
  if (status.role == Role::operator_tool || path >= kLivePaths) return;
  Participant* participant = accept(status.id.text(), status.incarnation, status);
  if (participant == nullptr) return;
  if (status.state == LifecycleState::lost) {
    participant->is_heard_on[path] = false;
    const bool is_heard = std::ranges::any_of(participant->is_heard_on, [](bool heard) { return heard; });
    if (!is_heard && !has_left(participant->status.state)) participant->is_lost = true;
    return;
  }
  participant->is_heard_on[path] = true;
  if (status.clock < participant->status.clock) return;
  const bool is_new = status.clock > participant->status.clock;
  if (is_new) {
    const Duration gap = now - participant->heard;
    if (participant->heard != Instant{} && !participant->is_lost) {
      participant->longest_gap = std::max(participant->longest_gap, std::min(gap, kSilence * kMissedStatuses));
    }
    participant->is_lost = false;
  }
  if (is_new || participant->heard == Instant{}) participant->heard = now;
  participant->status = status;
  if (status.state != LifecycleState::running) participant->held_by.clear();
  if (has_left(status.state)) participant->silent.clear();
  if (status.role == Role::coordinator) note_step(static_cast<double>(status.last_step), now);
}

void TestView::note_step(double step, Instant now) {
  if (!(step > step_)) return;
  step_ = step;
  pace_.push_back({now, step});
  while (pace_.size() > 2 && now - pace_[1].at > kRateWindow) pace_.pop_front();
  // A resumption that was not heard.
  if (is_paused_ && now - paused_at_ > kPauseTakesEffect) is_paused_ = false;
}

void TestView::learn(const Event& event, Instant now, std::string_view time_utc) {
  const std::size_t repeats = std::min(kRepeats, events_.size());
  const bool is_repeat = std::any_of(events_.end() - static_cast<std::ptrdiff_t>(repeats), events_.end(),
                                     [&](const Logged& logged) { return logged.event == event; });
  if (is_repeat) return;
  const auto source = participants_.find(event.source.view());
  if (source != participants_.end() && contains(source->second.former, event.incarnation)) return;
  if (contains(former_coordinators_, event.incarnation)) return;
  events_.push_back({++cursor_, std::string{time_utc}, event});
  if (events_.size() > kEvents) events_.pop_front();
  if (source != participants_.end() && source->second.status.incarnation == event.incarnation) apply(event, now);
}

void TestView::apply(const Event& event, Instant now) {
  Participant& source = participants_.find(event.source.view())->second;
  if (event.severity == Severity::fault &&
      (event.code == EventCode::interlock_tripped || event.code == EventCode::command_overdue)) {
    source.held_by = describe(event);
  }
  if (event.code == EventCode::interlock_cleared) source.held_by.clear();
  if (source.status.role != Role::coordinator) return;
  const auto subject = participants_.find(event.subject.view());
  if (subject != participants_.end()) {
    if (event.code == EventCode::link_silent) subject->second.silent = describe(event);
    if (event.code == EventCode::link_back || event.code == EventCode::participant_lost) subject->second.silent.clear();
  }
  if (event.code == EventCode::test_paused) {
    is_paused_ = true;
    paused_at_ = now;
    pace_.clear();
  }
  if (event.code == EventCode::test_resumed) is_paused_ = false;
  if (event.code == EventCode::test_completed) stop_reason_ = StopReason::completed;
  if (event.code == EventCode::test_stopped) {
    const double reason = event.values[0];
    stop_reason_ =
        reason >= 0.0 && reason < 256.0 ? static_cast<StopReason>(static_cast<std::uint8_t>(reason)) : StopReason::none;
    stopped_by_ = event.subject.text();
  }
}

void TestView::learn(const SignalBlock& block, Instant now) {
  if (!is_whole(block) || block.signals.empty()) return;
  const auto sender = participants_.find(block.participant.view());
  const bool is_known = sender != participants_.end();
  if (is_known && sender->second.status.incarnation != block.incarnation) return;
  if (contains(former_coordinators_, block.incarnation)) return;
  const StreamKey key{block.participant.text(), block.group.text(), block.part};
  Stream& stream = streams_[key];
  if (stream.incarnation != block.incarnation || stream.signals.size() != block.signals.size()) {
    if (stream.incarnation != 0 && !is_known) return;
    signal_count_ -= stream.signals.size();
    stream = {};
    if (signal_count_ + block.signals.size() > kSignals) {
      streams_.erase(key);
      return;
    }
    stream.incarnation = block.incarnation;
    for (const LiveSignal& signal : block.signals) {
      stream.signals.push_back({{signal.name, signal.subject, signal.unit, signal.limit}, SignalHistory{}});
    }
    signal_count_ += block.signals.size();
    stream.newest_s = -std::numeric_limits<double>::infinity();
  } else if (block.sequence <= stream.sequence) {
    return;  // late, or the same on another path
  }
  stream.sequence = block.sequence;
  ++cursor_;
  for (std::size_t k = 0; k < block.model_time_s.size(); ++k) {
    const double time_s = block.model_time_s[k];
    if (!(time_s >= stream.newest_s)) continue;
    for (std::size_t i = 0; i < stream.signals.size(); ++i) {
      const LiveSignal& signal = block.signals[i];
      const LivePoint point{time_s, signal.least[k], signal.most[k], signal.last[k]};
      SignalHistory& history = stream.signals[i].history;
      if (time_s == stream.newest_s) {
        history.amend(point);
      } else {
        begin_ = std::max(begin_, history.add(cursor_, point));
      }
    }
    stream.newest_s = time_s;
  }
  if (is_known) sender->second.heard = std::max(sender->second.heard, now);
  if (block.group == FixedText<32>{"pace"}) {
    for (const LiveSignal& signal : block.signals) {
      if (signal.name == FixedText<48>{"step"}) note_step(signal.last.back(), now);
    }
  }
}

const TestView::Participant* TestView::coordinator() const {
  const auto known = participants_.find(kCoordinatorId);
  return known == participants_.end() ? nullptr : &known->second;
}

bool TestView::is_lost(const Participant& participant, Instant now) const {
  if (has_left(participant.status.state)) return false;
  return participant.is_lost || now - participant.heard > std::max(kSilence, participant.longest_gap * kMissedStatuses);
}

bool TestView::is_awaited(const Participant& participant, Instant now) const {
  const Participant* one = coordinator();
  const bool is_waiting = one != nullptr && one->status.state == LifecycleState::running && !is_lost(*one, now);
  return is_waiting && stop_reason_ == StopReason::none && !participant.silent.empty();
}

std::vector<std::string> TestView::held(Instant now) const {
  std::vector<std::string> ids;
  for (const auto& [id, participant] : participants_) {
    if (!participant.held_by.empty() && !is_lost(participant, now)) ids.push_back(id);
  }
  return ids;
}

std::vector<std::string> TestView::awaiting_coordinator(Instant now) const {
  std::vector<std::string> ids;
  for (const auto& [id, participant] : participants_) {
    if (participant.status.state == LifecycleState::waiting && !is_lost(participant, now)) ids.push_back(id);
  }
  return ids;
}

bool TestView::is_over(Instant now) const {
  if (!awaiting_coordinator(now).empty()) return false;
  if (const Participant* one = coordinator()) return has_left(one->status.state) || is_lost(*one, now);
  return std::ranges::all_of(participants_, [&](const auto& entry) {
    return has_left(entry.second.status.state) || is_lost(entry.second, now);
  });
}

TestView::Phase TestView::phase(Instant now) const {
  const Participant* one = coordinator();
  if (one == nullptr) return participants_.empty() && !announcement_ ? Phase::waiting : Phase::assembling;
  if (has_left(one->status.state)) return Phase::stopped;
  if (is_lost(*one, now)) return Phase::lost;
  switch (one->status.state) {
    case LifecycleState::armed: return Phase::armed;
    case LifecycleState::stopping: return Phase::stopping;
    case LifecycleState::running: break;
    default: return Phase::assembling;
  }
  // The event of the end comes before the status.
  if (stop_reason_ != StopReason::none) return Phase::stopping;
  if (is_paused_) return Phase::paused;
  const bool is_held = std::ranges::any_of(
      participants_, [&](const auto& entry) { return !entry.second.held_by.empty() || is_awaited(entry.second, now); });
  return is_held ? Phase::held : Phase::running;
}

std::string_view TestView::text(Phase phase) noexcept {
  switch (phase) {
    case Phase::waiting: return "waiting";
    case Phase::assembling: return "assembling";
    case Phase::armed: return "armed";
    case Phase::running: return "running";
    case Phase::paused: return "paused";
    case Phase::held: return "held";
    case Phase::stopping: return "stopping";
    case Phase::stopped: return "stopped";
    case Phase::lost: return "lost";
  }
  return "unknown";
}

std::vector<std::string> TestView::missing() const {
  std::vector<std::string> missing;
  if (!announcement_) return missing;
  for (const SubstructureAnnouncement& announced : announcement_->substructures) {
    const std::string id = announced.id.text();
    if (!participants_.contains(id)) missing.push_back(id);
  }
  return missing;
}

std::string TestView::why(Phase phase, Instant now) const {
  switch (phase) {
    case Phase::paused: return "paused by the operator";
    case Phase::held:
      // The interlocks of the others follow from it.
      for (const auto& [id, participant] : participants_) {
        if (is_awaited(participant, now)) return participant.silent;
      }
      for (const auto& [id, participant] : participants_) {
        if (!participant.held_by.empty()) return id + ": " + participant.held_by;
      }
      return {};
    case Phase::stopping:
    case Phase::stopped: {
      if (stop_reason_ == StopReason::none) return {};
      const std::string who = stopped_by_.empty() ? "" : " (" + stopped_by_ + ")";
      return std::string{test_end(stop_reason_).verdict} + who;
    }
    case Phase::lost: {
      const double silence_s = to_seconds(now - coordinator()->heard);
      return "nothing heard of the coordinator for " + std::to_string(static_cast<long>(silence_s)) + " s";
    }
    case Phase::assembling: {
      const std::vector<std::string> ids = missing();
      return ids.empty() ? std::string{} : "waiting for " + listed(ids);
    }
    default: return {};
  }
}

std::string TestView::verdict(Phase phase, Instant now) const {
  const std::string reason = why(phase, now);
  switch (phase) {
    case Phase::waiting: return "Waiting: nobody has announced a test of this name.";
    case Phase::assembling: return reason.empty() ? "Assembling." : "Assembling: " + reason + ".";
    case Phase::armed: return "Armed: the rigs can move.";
    case Phase::running: return "Running.";
    case Phase::paused: return "Paused: the rigs hold their positions.";
    case Phase::held: return "Held: " + reason + ".";
    case Phase::stopping: return reason.empty() ? "Stopping." : "Stopping: " + reason + ".";
    case Phase::stopped: return reason.empty() ? "Over; its end was not heard." : capital(reason) + ".";
    case Phase::lost: {
      const std::vector<std::string> ids = awaiting_coordinator(now);
      const std::vector<std::string> holding = held(now);
      const std::string held_text = holding.empty() ? "" : " Holding: " + listed(holding) + ".";
      if (ids.empty()) return capital(reason) + "." + held_text + " Look at its process and its network.";
      return capital(reason) + ". Holding and waiting for it: " + listed(ids) +
             ". To go on, type `hybridtest run --resume RUN`.";
    }
  }
  return {};
}

double TestView::steps_per_second() const {
  if (pace_.size() < 2) return kNone;
  const Duration span = pace_.back().at - pace_.front().at;
  if (span < kRateShortest) return kNone;
  return (pace_.back().step - pace_.front().step) / to_seconds(span);
}

nlohmann::json TestView::test_json(Instant now) const {
  const Phase at = phase(now);
  nlohmann::json test{{"name", name_},
                      {"phase", text(at)},
                      {"why", why(at, now)},
                      {"verdict", verdict(at, now)},
                      {"stop_reason", stop_reason_ == StopReason::none ? "" : hybridtest::name(stop_reason_)},
                      {"has_report", false}};
  for (const char* unknown : {"mode", "step", "last_step", "model_time_s", "duration_s", "step_s", "time_scale",
                              "steps_per_second", "left_s"}) {
    test[unknown] = nullptr;
  }
  if (step_ >= 0.0) test["step"] = static_cast<std::int64_t>(step_);
  const bool stands_still =
      std::ranges::any_of(participants_, [&](const auto& entry) { return is_awaited(entry.second, now); });
  const bool moves = at == Phase::running || (at == Phase::held && !stands_still);
  const double rate = moves ? steps_per_second() : kNone;
  test["steps_per_second"] = rate;  // NaN becomes null
  if (!announcement_) return test;
  const double last_step = std::round(announcement_->duration_s / announcement_->step_s);
  test["mode"] = hybridtest::name(announcement_->mode);
  test["duration_s"] = announcement_->duration_s;
  test["step_s"] = announcement_->step_s;
  test["time_scale"] = announcement_->time_scale;
  if (std::isfinite(last_step)) test["last_step"] = last_step;
  if (step_ >= 0.0) test["model_time_s"] = step_ * announcement_->step_s;
  if (rate > 0.0) test["left_s"] = std::max(0.0, last_step - std::max(step_, 0.0)) / rate;
  return test;
}

nlohmann::json TestView::exchange_json(const std::string& substructure) const {
  nlohmann::json exchange;
  for (const auto& [key, stream] : streams_) {
    if (std::get<1>(key) != "exchange") continue;
    for (const Signal& signal : stream.signals) {
      if (signal.about.subject.view() != substructure) continue;
      const std::string unit = signal.about.unit.empty() ? "" : "_" + signal.about.unit.text();
      exchange[signal.about.name.text() + unit] = signal.history.newest().last;
    }
  }
  return exchange;
}

nlohmann::json TestView::participants_json(Instant now) const {
  nlohmann::json all = nlohmann::json::array();
  for (const auto& [id, participant] : participants_) {
    const ParticipantStatus& status = participant.status;
    const std::string_view state = is_awaited(participant, now) ? kLinkAwaited
                                   : is_lost(participant, now)  ? "lost"
                                                                : hybridtest::name(status.state);
    all.push_back({{"id", id},
                   {"role", hybridtest::name(status.role)},
                   {"state", state},
                   {"heard_s_ago", to_seconds(now - participant.heard)},
                   {"last_step", status.last_step == kNoStep ? nlohmann::json{} : nlohmann::json(status.last_step)},
                   {"faults", in_words(status.faults)},
                   {"exchange", exchange_json(id)}});
  }
  if (!announcement_) return all;
  for (const SubstructureAnnouncement& announced : announcement_->substructures) {
    if (participants_.contains(announced.id.view())) continue;
    all.push_back({{"id", announced.id.text()},
                   {"role", hybridtest::name(announced.role)},
                   {"state", "missing"},
                   {"heard_s_ago", nullptr},
                   {"last_step", nullptr},
                   {"faults", nlohmann::json::array()},
                   {"exchange", nullptr}});
  }
  return all;
}

nlohmann::json TestView::interlocks_json() const {
  nlohmann::json all = nlohmann::json::array();
  for (const auto& [key, stream] : streams_) {
    if (std::get<1>(key) != "interlocks") continue;
    for (const Signal& signal : stream.signals) {
      const LivePoint newest = signal.history.newest();
      const double limit = signal.about.limit;
      // The largest since the point before, so that a bar does not miss a peak.
      const double observed = std::fmax(std::abs(newest.least), std::abs(newest.most));
      all.push_back({{"participant", std::get<0>(key)},
                     {"name", signal.about.name.text()},
                     {"unit", signal.about.unit.text()},
                     {"observed", observed},
                     {"limit", limit},
                     {"share", limit > 0.0 ? observed / limit : kNone},
                     {"peak_share", limit > 0.0 ? signal.history.peak() / limit : kNone}});
    }
  }
  return all;
}

nlohmann::json TestView::events_json(std::uint64_t since) const {
  nlohmann::json all = nlohmann::json::array();
  for (const Logged& logged : events_) {
    if (logged.cursor <= since) continue;
    const Event& event = logged.event;
    all.push_back({{"cursor", logged.cursor},
                   {"time_utc", logged.time_utc},
                   {"source", event.source.text()},
                   {"severity", text_of(event.severity)},
                   {"text", describe(event)},
                   {"model_time_s", event.step == kNoStep ? kNone : event.model_time_s},
                   {"step", event.step == kNoStep ? nlohmann::json{} : nlohmann::json(event.step)}});
  }
  return all;
}

template <class Points>
std::vector<SignalSlice> TestView::slices(const Points& points) const {
  std::vector<SignalSlice> all;
  for (const auto& [key, stream] : streams_) {
    for (const Signal& signal : stream.signals) {
      std::vector<LivePoint> kept = points(signal.history);
      if (kept.empty()) continue;
      all.push_back({std::get<0>(key), std::get<1>(key), signal.about.name.text(), signal.about.subject.text(),
                     signal.about.unit.text(), signal.about.limit, std::move(kept)});
    }
  }
  return all;
}

nlohmann::json TestView::entry(Instant now) const {
  nlohmann::json heard_s_ago;
  if (!participants_.empty()) {
    const auto newest =
        std::ranges::max_element(participants_, {}, [](const auto& known) { return known.second.heard; });
    heard_s_ago = to_seconds(now - newest->second.heard);
  }
  return {{"name", name_}, {"phase", text(phase(now))}, {"heard_s_ago", heard_s_ago}};
}

LiveAnswer TestView::news(std::uint64_t since, Instant now) const {
  const bool is_reset = since < begin_ || since > cursor_ || since == 0;
  LiveAnswer answer;
  answer.head = {{"cursor", cursor_},
                 {"reset", is_reset},
                 {"test", test_json(now)},
                 {"participants", participants_json(now)},
                 {"interlocks", interlocks_json()},
                 {"events", events_json(is_reset ? 0 : since)}};
  answer.signals = is_reset ? slices([](const SignalHistory& history) { return history.recent(); })
                            : slices([since](const SignalHistory& history) { return history.since(since); });
  return answer;
}

LiveAnswer TestView::whole() const {
  LiveAnswer answer;
  answer.head = {{"cursor", cursor_}};
  answer.signals = slices([](const SignalHistory& history) { return history.whole(); });
  return answer;
}

}  // namespace hybridtest
