#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/messages.hpp"
#include "core/node.hpp"
#include "core/ports.hpp"
#include "runtime/network_options.hpp"
#include "transport/transport.hpp"

namespace hybridtest {

/// A participant that was found, and whether it obeyed.
struct FoundParticipant {
  std::string id;
  Role role = Role::operator_tool;
  Instant discovered{};
  std::optional<Duration> obeyed_after{};  // from the discovery
};

/// A request of the operator on one network path, repeated until all have obeyed. `stop` and `emergency_stop` count as
/// obeyed when a participant leaves the test. An emergency stop is sent at once to each participant that is discovered
/// and needs no coordinator; a `stop` waits for the coordinator, one second after the last discovery at most. `pause`
/// and `resume` count when the coordinator reports them. A test in real time refuses a pause.
class OperatorRequest {
 public:
  /// @param sender   the incarnation of the operator's process.
  OperatorRequest(ControlVerb verb, Incarnation sender) noexcept : verb_{verb}, sender_{sender} {}

  /// @param now   when the message arrived; of a participant that was known before, when it was discovered.
  void learn(const ParticipantStatus& status, Instant now);
  void learn(const Event& event, Instant now);
  void learn(const TestAnnouncement& announcement);
  /// The message that is to be sent now, if one is.
  [[nodiscard]] std::optional<TestControl> due(Instant now);

  [[nodiscard]] const std::vector<FoundParticipant>& found() const noexcept { return found_; }
  [[nodiscard]] Instant last_discovery() const noexcept { return last_discovery_; }
  /// Everyone who takes part has been found.
  [[nodiscard]] bool is_complete() const;
  /// Those that the coordinator announced and that were not found.
  [[nodiscard]] std::vector<std::string> missing() const;
  /// Whoever has to obey has done so. For `pause` and `resume` that is the coordinator.
  [[nodiscard]] bool is_obeyed() const;
  /// The coordinator has said that this test cannot do it.
  [[nodiscard]] bool is_refused() const noexcept { return is_refused_; }
  /// It ends the test.
  [[nodiscard]] bool stops() const noexcept {
    return verb_ == ControlVerb::stop || verb_ == ControlVerb::emergency_stop;
  }

 private:
  [[nodiscard]] bool may_send(Instant now) const;
  void note_obeyed(const std::string& id, Instant now);
  [[nodiscard]] bool coordinator_obeyed() const;
  [[nodiscard]] bool contains(const std::string& id) const;
  [[nodiscard]] std::span<const SubstructureAnnouncement> announced() const noexcept;

  ControlVerb verb_;
  Incarnation sender_;
  std::vector<FoundParticipant> found_;
  TestAnnouncement announcement_;
  bool is_announced_ = false;
  bool test_is_over_ = false;
  bool is_refused_ = false;
  Instant last_discovery_{};
  Instant send_due_{};
};

/// A request of the operator on all network paths at once: a test that runs on this machine only talks through its
/// loopback interface, another one through the network.
class OperatorControl final : public Node {
 public:
  OperatorControl(const NetworkOptions& network, const std::string& test_name, ControlVerb verb);
  ~OperatorControl() override;

  [[nodiscard]] Instant advance(Instant now) noexcept override;
  /// Each path asks to run every few milliseconds, so that one waker is enough.
  [[nodiscard]] Waker& waker() noexcept { return transports_.front()->waker(); }
  /// The path on which most participants of the test were found.
  [[nodiscard]] const OperatorRequest& best() const;

 private:
  struct Path;

  std::vector<std::unique_ptr<Transport>> transports_;
  std::vector<std::unique_ptr<Path>> paths_;
};

}  // namespace hybridtest
