#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/node.hpp"
#include "report/live/live_source.hpp"
#include "report/live/test_view.hpp"
#include "runtime/network_options.hpp"
#include "runtime/operator_control.hpp"
#include "transport/fast_dds/fast_dds_transport.hpp"

namespace hybridtest {

/// Observes tests on all network paths. It reads announcements, statuses, events and live signals, never commands and
/// measurements; no participant waits for it, whether it runs or not. It sends nothing but requests of the operator.
class Observer final : public Node, public LiveSource {
 public:
  /// @param only_test      observed from now on, and no other; without it, every test that is announced, at most
  ///                       sixteen at a time.
  /// @param first_cursor   see TestView.
  /// @param may_control    requests may be made; credentials that only permit to look do without.
  /// @param time_utc       the time of the wall clock, for the log of events.
  Observer(const NetworkOptions& network, const std::optional<std::string>& only_test, std::uint64_t first_cursor,
           bool may_control, std::function<std::string()> time_utc);
  ~Observer() override;

  [[nodiscard]] Instant advance(Instant now) noexcept override;
  /// It asks to run every few milliseconds, so that the waker of one path is enough.
  [[nodiscard]] Waker& waker() noexcept { return paths_.front().search->waker(); }

  [[nodiscard]] nlohmann::json tests(Instant now) const override;
  [[nodiscard]] std::optional<LiveAnswer> news(std::string_view test, std::uint64_t since, Instant now) const override;
  [[nodiscard]] std::optional<LiveAnswer> whole(std::string_view test) const override;
  bool request(std::string_view test, ControlVerb verb, Instant now) override;
  /// No test goes on.
  [[nodiscard]] bool is_over(Instant now) const;

 private:
  struct Path {
    std::unique_ptr<fast_dds::TestSearch> search;
    std::unique_ptr<Inbox<TestAnnouncement>> announcements;  // none with only_test
  };
  struct Observed;

  void observe(const std::string& test, Instant now);
  [[nodiscard]] bool make_room(Instant now);
  [[nodiscard]] Observed* find(std::string_view test) const;

  mutable std::mutex mutex_;  // of everything below
  std::vector<Path> paths_;
  std::map<std::string, std::unique_ptr<Observed>, std::less<>> observed_;
  std::uint64_t first_cursor_;
  bool may_control_;
  Incarnation incarnation_;
  std::function<std::string()> time_utc_;
};

}  // namespace hybridtest
