#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "coordinator/clock_windows.hpp"
#include "core/messages.hpp"
#include "core/node.hpp"
#include "core/presence.hpp"
#include "recording/summary/clock_relation.hpp"
#include "transport/transport.hpp"

namespace hybridtest {

/// One participant that a check of the links expects.
struct ExpectedParticipant {
  ParticipantId id;
  Eigen::Index dofs = 0;  // of its interface; the coordinator has none
};

struct LinkCheckSettings {
  Identity identity;
  std::string version;  // of the software of this participant
  /// The wall clock at the Instant zero, since 1970.
  Duration wall_zero{};
  /// Between two commands: as often as the test sends them.
  Duration period = std::chrono::milliseconds{10};
  int commands = 500;
  /// For the others to appear.
  Duration patience = std::chrono::seconds{30};
};

/// Of the link between the coordinator and one substructure.
struct LinkMeasurement {
  ParticipantId substructure;
  int sent = 0;
  int answered = 0;
  double round_trip_s_min = 0.0;
  double round_trip_s_median = 0.0;
  double round_trip_s_p99 = 0.0;
  /// Wall clock of the substructure less that of the coordinator in the middle of the check, and how far off that may
  /// be: estimated as that of a test is, see ClockRelation.
  double clock_offset_s = 0.0;
  double clock_uncertainty_s = 0.0;

  [[nodiscard]] double lost_ratio() const noexcept {
    return sent == 0 ? 0.0 : static_cast<double>(sent - answered) / sent;
  }
};

/// Another participant as it was heard.
struct HeardParticipant {
  ParticipantStatus status;
  std::string version;  // empty until it was heard
};

/// Greets the others and hears their greetings: what a participant of a check does besides measuring.
class LinkGreeting {
 public:
  LinkGreeting(const LinkCheckSettings& settings, Transport& transport);

  void listen(Instant now) noexcept;
  /// @return when it wants to greet again.
  [[nodiscard]] Instant greet(Instant now) noexcept;

  [[nodiscard]] const std::vector<HeardParticipant>& heard() const noexcept { return heard_; }
  [[nodiscard]] const HeardParticipant* find(const ParticipantId& id) const noexcept;
  /// What the coordinator has told.
  [[nodiscard]] const std::vector<LinkMeasurement>& told() const noexcept { return told_; }
  void tell(std::vector<LinkMeasurement> measurements) { telling_ = std::move(measurements); }

 private:
  void hear(const ParticipantStatus& status);
  void hear(const SignalBlock& block);
  void send_block(std::uint16_t part, std::vector<LiveSignal> signals);

  const LinkCheckSettings settings_;
  std::unique_ptr<Inbox<ParticipantStatus>> statuses_in_;
  std::unique_ptr<Outbox<ParticipantStatus>> statuses_out_;
  std::unique_ptr<Inbox<SignalBlock>> blocks_in_;
  std::unique_ptr<Outbox<SignalBlock>> blocks_out_;
  std::vector<HeardParticipant> heard_;
  std::vector<LinkMeasurement> told_;
  std::vector<LinkMeasurement> telling_;
  Instant next_greeting_{};
  std::uint64_t sequence_ = 0;
};

/// The coordinator's side of a check: sends commands of the size of the test at its rate to every substructure, and
/// measures their answers. Nothing moves: no site listens in the partition of a check.
class LinkProbe final : public Node {
 public:
  LinkProbe(const LinkCheckSettings& settings, const std::vector<ExpectedParticipant>& substructures,
            Transport& transport);

  [[nodiscard]] Instant advance(Instant now) noexcept override;
  [[nodiscard]] bool is_done() const noexcept { return phase_ == Phase::done; }
  [[nodiscard]] const LinkGreeting& greeting() const noexcept { return greeting_; }
  /// One for each substructure, in their order.
  [[nodiscard]] std::vector<LinkMeasurement> measurements() const;

 private:
  enum class Phase : std::uint8_t { waiting, measuring, settling, telling, done };
  struct Link {
    ParticipantId id;
    DisplacementCommand command;
    bool is_there = false;
    int sent = 0;
    std::vector<Duration> send_times{};   // by step, wall clock
    std::vector<double> round_trips_s{};  // by answer
    std::vector<bool> answered{};         // by step
    std::vector<ClockBounds> clock{};     // of its wall clock
  };
  /// Where the windows of the clocks go.
  class ClockSink final : public RowSink {
   public:
    explicit ClockSink(std::vector<Link>& links) noexcept : links_{links} {}
    void append(std::span<const double> row) noexcept override;

   private:
    std::vector<Link>& links_;
  };

  [[nodiscard]] Duration wall(Instant now) const noexcept { return settings_.wall_zero + now.time_since_epoch(); }
  [[nodiscard]] bool is_there(std::size_t substructure) const noexcept;
  [[nodiscard]] Instant wait(Instant now) noexcept;
  [[nodiscard]] Instant measure(Instant now) noexcept;
  void take_answers(Instant now) noexcept;

  const LinkCheckSettings settings_;
  Transport& transport_;
  LinkGreeting greeting_;
  std::unique_ptr<Outbox<DisplacementCommand>> commands_;
  std::unique_ptr<Inbox<ForceMeasurement>> answers_;
  std::vector<Link> links_;
  ClockWindows clocks_;
  ClockSink clock_sink_{links_};
  Phase phase_ = Phase::waiting;
  Instant phase_end_ = kNever;
  Instant next_command_{};
  int sent_ = 0;
};

/// A substructure's side: answers each command at once, until the coordinator has told what it measured.
class LinkEcho final : public Node {
 public:
  LinkEcho(const LinkCheckSettings& settings, SubstructureIndex substructure, Eigen::Index dofs, Transport& transport);

  [[nodiscard]] Instant advance(Instant now) noexcept override;
  [[nodiscard]] bool is_done() const noexcept { return is_done_; }
  [[nodiscard]] const LinkGreeting& greeting() const noexcept { return greeting_; }
  /// What the coordinator measured on this link; nullptr when nothing was heard of it.
  [[nodiscard]] const LinkMeasurement* measurement() const noexcept;

 private:
  const LinkCheckSettings settings_;
  LinkGreeting greeting_;
  std::unique_ptr<Inbox<DisplacementCommand>> commands_;
  std::unique_ptr<Outbox<ForceMeasurement>> answers_;
  ForceMeasurement answer_;
  Instant give_up_{};
  bool is_done_ = false;
};

}  // namespace hybridtest
