#include "runtime/operator_control.hpp"

#include <algorithm>

#include "runtime/incarnation.hpp"
#include "transport/fast_dds/fast_dds_transport.hpp"

namespace hybridtest {
namespace {

constexpr Duration kControlPoll = std::chrono::milliseconds{5};
constexpr Duration kRepeat = std::chrono::milliseconds{20};
/// The answer to `pause` and `resume` is an event, which an operator hears only when it has discovered its sender.
constexpr Duration kRepeatQuestion = std::chrono::milliseconds{300};
/// A site that stops ends the whole test, and a coordinator that was not yet discovered is then gone unseen.
constexpr Duration kAwaitCoordinator = std::chrono::seconds{1};

}  // namespace

void OperatorRequest::learn(const ParticipantStatus& status, Instant now) {
  if (status.role == Role::operator_tool) return;
  const bool is_leaving = status.state == LifecycleState::stopping || status.state == LifecycleState::finished ||
                          status.state == LifecycleState::refused || status.state == LifecycleState::lost;
  const std::string id = status.id.text();
  if (!contains(id)) {
    // The last status of an earlier test of this name says nothing of a running one.
    if (found_.empty() && is_leaving && status.state != LifecycleState::stopping) return;
    found_.push_back({id, status.role, now, {}});
    last_discovery_ = now;
    send_due_ = now;
  }
  if (stops() && is_leaving && status.state != LifecycleState::lost) note_obeyed(id, now);
  // The coordinator leaves when the others have come to rest.
  if (status.role == Role::coordinator && status.state == LifecycleState::finished) test_is_over_ = true;
}

void OperatorRequest::learn(const Event& event, Instant now) {
  const bool answers = (verb_ == ControlVerb::pause && event.code == EventCode::test_paused) ||
                       (verb_ == ControlVerb::resume && event.code == EventCode::test_resumed);
  if (answers) note_obeyed(event.source.text(), now);
  if (verb_ == ControlVerb::pause && event.code == EventCode::pause_refused) is_refused_ = true;
}

void OperatorRequest::learn(const TestAnnouncement& announcement) {
  announcement_ = announcement;
  is_announced_ = true;
}

std::optional<TestControl> OperatorRequest::due(Instant now) {
  if (is_refused_ || now < send_due_ || !may_send(now)) return std::nullopt;
  send_due_ = now + (stops() ? kRepeat : kRepeatQuestion);
  TestControl message;
  message.verb = verb_;
  message.sender = sender_;
  message.sender_role = Role::operator_tool;
  message.reason = verb_ == ControlVerb::emergency_stop ? StopReason::emergency_stop : StopReason::interrupted;
  return message;
}

bool OperatorRequest::is_complete() const {
  if (test_is_over_) return true;
  if (!is_announced_ || !contains(std::string{kCoordinatorId})) return false;
  return std::ranges::all_of(announced(), [this](const auto& one) { return contains(one.id.text()); });
}

std::vector<std::string> OperatorRequest::missing() const {
  std::vector<std::string> missing;
  // A coordinator that obeys brings to rest everyone whom it announced.
  if (test_is_over_ || coordinator_obeyed()) return missing;
  if (!contains(std::string{kCoordinatorId})) missing.emplace_back(kCoordinatorId);
  for (const auto& one : announced()) {
    if (!contains(one.id.text())) missing.push_back(one.id.text());
  }
  return missing;
}

bool OperatorRequest::is_obeyed() const {
  if (stops()) return std::ranges::all_of(found_, [](const auto& one) { return one.obeyed_after.has_value(); });
  return coordinator_obeyed();
}

bool OperatorRequest::may_send(Instant now) const {
  if (verb_ == ControlVerb::emergency_stop) return !found_.empty();
  const bool knows_coordinator = contains(std::string{kCoordinatorId});
  if (verb_ == ControlVerb::stop) {
    return knows_coordinator || (!found_.empty() && now - last_discovery_ >= kAwaitCoordinator);
  }
  return knows_coordinator && now - last_discovery_ >= kRepeatQuestion;
}

void OperatorRequest::note_obeyed(const std::string& id, Instant now) {
  const auto one = std::ranges::find(found_, id, &FoundParticipant::id);
  if (one != found_.end() && !one->obeyed_after) one->obeyed_after = now - one->discovered;
}

bool OperatorRequest::coordinator_obeyed() const {
  return std::ranges::any_of(found_, [](const auto& one) { return one.role == Role::coordinator && one.obeyed_after; });
}

bool OperatorRequest::contains(const std::string& id) const {
  return std::ranges::find(found_, id, &FoundParticipant::id) != found_.end();
}

std::span<const SubstructureAnnouncement> OperatorRequest::announced() const noexcept {
  return announcement_.substructures;  // none before it is announced
}

struct OperatorControl::Path {
  Path(Transport& transport, ControlVerb verb, Incarnation sender)
      : request{verb, sender},
        statuses{transport.status_inbox()},
        events{transport.event_inbox()},
        announcements{transport.announcement_inbox()},
        control{transport.control_outbox()} {}

  void advance(Instant now) {
    ParticipantStatus status;
    while (statuses->take(status)) request.learn(status, now);
    Event event;
    while (events->take(event)) request.learn(event, now);
    TestAnnouncement announcement;
    while (announcements->take(announcement)) request.learn(announcement);
    if (const auto message = request.due(now)) control->send(*message);
  }

  OperatorRequest request;
  std::unique_ptr<Inbox<ParticipantStatus>> statuses;
  std::unique_ptr<Inbox<Event>> events;
  std::unique_ptr<Inbox<TestAnnouncement>> announcements;
  std::unique_ptr<Outbox<TestControl>> control;
};

OperatorControl::OperatorControl(const NetworkOptions& network, const std::string& test_name, ControlVerb verb) {
  for (const fast_dds::FastDdsSettings& settings : network.observer_paths()) {
    transports_.push_back(fast_dds::make_fast_dds_transport(settings, test_name));
  }
  const Incarnation sender = draw_incarnation();
  for (const auto& transport : transports_) paths_.push_back(std::make_unique<Path>(*transport, verb, sender));
}

OperatorControl::~OperatorControl() = default;

Instant OperatorControl::advance(Instant now) noexcept {
  for (const auto& path : paths_) path->advance(now);
  return now + kControlPoll;
}

const OperatorRequest& OperatorControl::best() const {
  return (*std::ranges::max_element(paths_, {}, [](const auto& path) { return path->request.found().size(); }))
      ->request;
}

}  // namespace hybridtest
