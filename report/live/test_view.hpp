#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "core/messages.hpp"
#include "report/live/live_answer.hpp"

namespace hybridtest {

/// Network paths on which one test can be heard: the network, and the loopback interface alone.
inline constexpr std::size_t kLivePaths = 2;

/// What an observer knows of one test: taken from messages, given as JSON (docs/watch.md). Its memory is bounded. A
/// test that begins anew, with another coordinator, replaces the one before; messages of a process that was replaced,
/// and messages that come again or late, change nothing.
class TestView {
 public:
  /// @param first_cursor   another one in each process, so that a page notices that the server was started again.
  TestView(std::string name, std::uint64_t first_cursor);

  void learn(const TestAnnouncement& announcement);
  /// @param path   on which it was heard; whoever is lost on one path and heard on the other is not lost.
  void learn(const ParticipantStatus& status, std::size_t path, Instant now);
  void learn(const Event& event, Instant now, std::string_view time_utc);
  void learn(const SignalBlock& block, Instant now);

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  /// `name`, `phase`, `heard_s_ago`.
  [[nodiscard]] nlohmann::json entry(Instant now) const;
  /// Everything after the cursor; everything that is known when the cursor is not one of ours or too old.
  [[nodiscard]] LiveAnswer news(std::uint64_t since, Instant now) const;
  /// The signals from the first point on.
  [[nodiscard]] LiveAnswer whole() const;
  /// It ended, or nobody in it is heard of.
  [[nodiscard]] bool is_over(Instant now) const;

 private:
  enum class Phase : std::uint8_t { waiting, assembling, armed, running, paused, held, stopping, stopped, lost };

  struct Participant {
    ParticipantStatus status;
    std::vector<Incarnation> former;  // processes that this one replaced
    std::array<bool, kLivePaths> is_heard_on{};
    bool is_lost = false;
    Instant heard{};
    Duration longest_gap{};  // between two of its statuses
    std::string held_by;     // interlock that it holds for, in words
    std::string silent;      // that the coordinator does not hear it and waits for its link, in words
  };
  struct Logged {
    std::uint64_t cursor = 0;
    std::string time_utc;
    Event event;
  };
  struct Signal {
    LiveSignal about;  // without points
    SignalHistory history;
  };
  /// The signals of one part of a group.
  struct Stream {
    Incarnation incarnation = 0;
    std::uint64_t sequence = 0;
    double newest_s = 0.0;  // model time
    std::vector<Signal> signals;
  };
  using StreamKey = std::tuple<std::string, std::string, std::uint16_t>;  // participant, group, part
  struct Pace {
    Instant at{};
    double step = 0.0;
  };

  void begin_anew(Incarnation coordinator);
  [[nodiscard]] Participant* accept(const std::string& id, Incarnation incarnation, const ParticipantStatus& status);
  void note_step(double step, Instant now);
  void apply(const Event& event, Instant now);
  [[nodiscard]] const Participant* coordinator() const;
  [[nodiscard]] bool is_lost(const Participant& participant, Instant now) const;
  [[nodiscard]] Phase phase(Instant now) const;
  [[nodiscard]] std::string why(Phase phase, Instant now) const;
  [[nodiscard]] std::string verdict(Phase phase, Instant now) const;
  [[nodiscard]] std::vector<std::string> missing() const;
  /// The coordinator waits for its link.
  [[nodiscard]] bool is_awaited(const Participant& participant, Instant now) const;
  /// Those that hold and wait for a coordinator.
  [[nodiscard]] std::vector<std::string> awaiting_coordinator(Instant now) const;
  /// Those that an interlock holds.
  [[nodiscard]] std::vector<std::string> held(Instant now) const;
  /// Over the last two seconds; NaN when it is not known.
  [[nodiscard]] double steps_per_second() const;
  [[nodiscard]] nlohmann::json test_json(Instant now) const;
  [[nodiscard]] nlohmann::json participants_json(Instant now) const;
  [[nodiscard]] nlohmann::json exchange_json(const std::string& substructure) const;
  [[nodiscard]] nlohmann::json interlocks_json() const;
  [[nodiscard]] nlohmann::json events_json(std::uint64_t since) const;
  template <class Points>
  [[nodiscard]] std::vector<SignalSlice> slices(const Points& points) const;

  static std::string_view text(Phase phase) noexcept;

  std::string name_;
  std::uint64_t cursor_;
  std::uint64_t begin_;  // a page that knows less takes everything anew
  std::optional<TestAnnouncement> announcement_;
  std::vector<Incarnation> former_coordinators_;
  std::map<std::string, Participant, std::less<>> participants_;
  std::deque<Logged> events_;
  std::map<StreamKey, Stream> streams_;
  std::size_t signal_count_ = 0;
  std::deque<Pace> pace_;
  double step_ = -1.0;
  bool is_paused_ = false;
  Instant paused_at_{};
  StopReason stop_reason_ = StopReason::none;
  std::string stopped_by_;
};

}  // namespace hybridtest
