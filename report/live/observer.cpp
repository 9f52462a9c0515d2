#include "report/live/observer.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "runtime/incarnation.hpp"

namespace hybridtest {
namespace {

constexpr std::size_t kTests = 16;
constexpr Duration kObserverPoll = std::chrono::milliseconds{10};
/// A request that nobody obeys is not repeated for ever.
constexpr Duration kRequestPatience = std::chrono::seconds{15};

}  // namespace

/// A test, and its ports on each path.
struct Observer::Observed {
  /// What is known of a participant on this path.
  struct Heard {
    ParticipantStatus status;
    Instant first{};
  };
  struct Request {
    ControlVerb verb;
    OperatorRequest request;
    Instant begun{};
  };
  struct Ports {
    Ports(std::unique_ptr<Transport> made, bool may_control)
        : transport{std::move(made)},
          announcements{transport->announcement_inbox()},
          statuses{transport->status_inbox()},
          events{transport->event_inbox()},
          signals{transport->signal_inbox()},
          control{may_control ? transport->control_outbox() : nullptr} {}

    std::unique_ptr<Transport> transport;
    std::unique_ptr<Inbox<TestAnnouncement>> announcements;
    std::unique_ptr<Inbox<ParticipantStatus>> statuses;
    std::unique_ptr<Inbox<Event>> events;
    std::unique_ptr<Inbox<SignalBlock>> signals;
    std::unique_ptr<Outbox<TestControl>> control;  // none for those who only look
    std::map<std::string, Heard> heard;
    std::vector<Request> requests;
  };

  Observed(const std::string& name, std::uint64_t first_cursor) : test{name, first_cursor} {}

  void listen(std::size_t path, Instant now, const std::function<std::string()>& time_utc) {
    Ports& port = *ports[path];
    TestAnnouncement announcement;
    while (port.announcements->take(announcement)) test.learn(announcement);
    ParticipantStatus status;
    while (port.statuses->take(status)) {
      test.learn(status, path, now);
      for (Request& one : port.requests) one.request.learn(status, now);
      const std::string id = status.id.text();
      const auto known = port.heard.find(id);
      const bool is_same = known != port.heard.end() && known->second.status.incarnation == status.incarnation;
      port.heard[id] = {status, is_same ? known->second.first : now};
    }
    Event event;
    while (port.events->take(event)) {
      test.learn(event, now, time_utc());
      for (Request& one : port.requests) one.request.learn(event, now);
    }
    SignalBlock block;
    while (port.signals->take(block)) test.learn(block, now);
  }

  void send(Ports& port, Instant now) const {
    std::erase_if(port.requests, [&](const Request& one) {
      return now - one.begun > kRequestPatience || one.request.is_refused() ||
             (!one.request.found().empty() && one.request.is_obeyed());
    });
    for (Request& one : port.requests) {
      if (const auto message = one.request.due(now); message && port.control) port.control->send(*message);
    }
  }

  TestView test;
  std::vector<std::unique_ptr<Ports>> ports;  // one per path
};

Observer::Observer(const NetworkOptions& network, const std::optional<std::string>& only_test,
                   std::uint64_t first_cursor, bool may_control, std::function<std::string()> time_utc)
    : first_cursor_{first_cursor},
      may_control_{may_control},
      incarnation_{draw_incarnation()},
      time_utc_{std::move(time_utc)} {
  for (const fast_dds::FastDdsSettings& settings : network.observer_paths()) {
    Path path{fast_dds::make_test_search(settings), nullptr};
    if (!only_test) path.announcements = path.search->announcements();
    paths_.push_back(std::move(path));
  }
  if (only_test) observe(*only_test, Instant{});
}

Observer::~Observer() = default;

void Observer::observe(const std::string& test, Instant now) {
  if (observed_.contains(test) || !make_room(now)) return;
  auto observed = std::make_unique<Observed>(test, first_cursor_);
  for (const Path& path : paths_) {
    observed->ports.push_back(std::make_unique<Observed::Ports>(path.search->join(test), may_control_));
  }
  observed_.emplace(test, std::move(observed));
}

bool Observer::make_room(Instant now) {
  if (observed_.size() < kTests) return true;
  const auto over = std::ranges::find_if(observed_, [&](const auto& one) { return one.second->test.is_over(now); });
  if (over == observed_.end()) return false;
  observed_.erase(over);
  return true;
}

Observer::Observed* Observer::find(std::string_view test) const {
  const auto known = observed_.find(test);
  return known == observed_.end() ? nullptr : known->second.get();
}

Instant Observer::advance(Instant now) noexcept {
  const std::lock_guard lock{mutex_};
  try {
    for (const Path& path : paths_) {
      TestAnnouncement announcement;
      while (path.announcements && path.announcements->take(announcement)) {
        observe(announcement.test_name.text(), now);
      }
    }
  } catch (const std::exception&) {
    // A name that no test of ours has, or no memory for another test: it is not shown.
  }
  for (const auto& [name, observed] : observed_) {
    for (std::size_t path = 0; path < observed->ports.size(); ++path) {
      observed->listen(path, now, time_utc_);
      observed->send(*observed->ports[path], now);
    }
  }
  return now + kObserverPoll;
}

nlohmann::json Observer::tests(Instant now) const {
  const std::lock_guard lock{mutex_};
  nlohmann::json all = nlohmann::json::array();
  for (const auto& [name, observed] : observed_) all.push_back(observed->test.entry(now));
  return all;
}

std::optional<LiveAnswer> Observer::news(std::string_view test, std::uint64_t since, Instant now) const {
  const std::lock_guard lock{mutex_};
  const Observed* observed = find(test);
  if (observed == nullptr) return std::nullopt;
  return observed->test.news(since, now);
}

std::optional<LiveAnswer> Observer::whole(std::string_view test) const {
  const std::lock_guard lock{mutex_};
  const Observed* observed = find(test);
  if (observed == nullptr) return std::nullopt;
  return observed->test.whole();
}

bool Observer::request(std::string_view test, ControlVerb verb, Instant now) {
  const std::lock_guard lock{mutex_};
  Observed* observed = find(test);
  if (observed == nullptr) return false;
  for (const auto& port : observed->ports) {
    // The newest request counts, but nothing takes back an emergency stop.
    std::erase_if(port->requests, [](const auto& one) { return one.verb != ControlVerb::emergency_stop; });
    Observed::Request request{verb, OperatorRequest{verb, incarnation_}, now};
    for (const auto& [id, heard] : port->heard) {
      if (heard.status.state != LifecycleState::lost) request.request.learn(heard.status, heard.first);
    }
    port->requests.push_back(std::move(request));
    observed->send(*port, now);
  }
  return true;
}

bool Observer::is_over(Instant now) const {
  const std::lock_guard lock{mutex_};
  return std::ranges::all_of(observed_, [now](const auto& one) { return one.second->test.is_over(now); });
}

}  // namespace hybridtest
