#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "coordinator/clock_windows.hpp"
#include "coordinator/command_repeats.hpp"
#include "coordinator/excitation/applied_load.hpp"
#include "coordinator/force_bridge.hpp"
#include "coordinator/motion_source.hpp"
#include "coordinator/rehearsal.hpp"
#include "coordinator/step_ledger.hpp"
#include "core/messages.hpp"
#include "core/node.hpp"
#include "core/ports.hpp"
#include "core/presence.hpp"
#include "core/records.hpp"
#include "mechanics/structure/interface_map.hpp"

namespace hybridtest {

/// What the coordinator knows of a substructure.
struct CoupledSubstructure {
  ParticipantId id;
  Role role = Role::numerical_substructure;
  InterfaceMap interface;
  Eigen::MatrixXd initial_stiffness_n_per_m{};  // over the interface; for bridges in real time
};

struct CoordinatorSettings {
  FixedText<64> test_name;
  CouplingMode mode = CouplingMode::lockstep;
  double step_s = 0.0;
  double duration_s = 0.0;
  double time_scale = 1.0;  // paced: wall time over model time
  Step last_step = 0;       // the test has the steps 0 .. last_step; a program that leads ends it earlier
  std::vector<CoupledSubstructure> substructures;
  /// Of the elastic part, which the coordinator computes by itself, n x n. Empty without one.
  Eigen::SparseMatrix<double> stiffness_n_per_m;
  AppliedLoad load;
  /// Degrees of freedom in the table of steps.
  std::vector<Eigen::Index> recorded_dofs;
  bool stop_on_recording_failure = false;            // when any participant cannot record
  Duration settle = std::chrono::milliseconds{300};  // waits for the status of an older coordinator
  Duration discovery_timeout = std::chrono::seconds{30};
  Duration arm_timeout = std::chrono::seconds{10};
  Duration stop_timeout = std::chrono::seconds{10};  // for the other participants to come to rest
  /// A command is sent again after this time while it is not known yet how long an answer takes, see CommandRepeats; in
  /// paced mode the length of a step is added.
  Duration repeat_after = std::chrono::milliseconds{200};
  BridgingSettings bridging;  // in real time
};

struct CoordinatorPorts {
  Outbox<TestAnnouncement>& announcements;
  Inbox<TestControl>& control_in;
  Outbox<TestControl>& control_out;
  Inbox<ForceMeasurement>& measurements;
  Outbox<DisplacementCommand>& commands;
  /// Whether the commands and measurements of a substructure are connected, at this end. Empty: always.
  std::function<bool(SubstructureIndex)> is_linked = {};
};

/// Tables of `coordinator.h5`.
struct CoordinatorRecord {
  RowSink& steps;
  RowSink& exchanges;
  RowSink* bridges = nullptr;  // of a test in real time
  RowSink* clocks = nullptr;   // what the exchanges say of the clocks; none without
  RowSink* answers = nullptr;  // of a test that can be resumed
};

/// One command to all substructures and its answers, as the table `answers` has them.
struct AnsweredCommand {
  Step step = kNoStep;
  std::uint16_t iteration = 0;
  bool is_trial = false;
  // One per substructure, at the interface:
  std::vector<InterfaceVector> displacement_m{};
  std::vector<InterfaceVector> velocity_m_per_s{};
  std::vector<InterfaceVector> force_n{};
};

/// A test whose coordinator died, as the recording has it.
struct ResumedTest {
  Incarnation first_coordinator = 0;
  Instant started{};        // the test, by the clock of this process
  Instant last_recorded{};  // the last step in the recording, likewise
};

/// State of the test, for the progress display and the summary.
struct CoordinatorReport {
  LifecycleState state = LifecycleState::joining;
  StopReason reason = StopReason::none;
  Step completed_steps = 0;  // counts step 0
  Duration running_time{};   // from start to the end of stepping
};

/// The integration coordinator. It waits for the participants, arms and starts them, and steps the
/// structure through the test. In each step it sends one command to every substructure and
/// takes one force from it, several where the source of motion iterates. It ends the test after the last step or at the
/// first fault.
///
/// In real time, the command of step n is sent n - 1 steps after that of step 1, or as soon as the forces of the step
/// before are there. Its answers are expected a step and a usual round trip later; what has not come by its deadline
/// after that is bridged.
class Coordinator final : public Node {
 public:
  Coordinator(CoordinatorSettings settings, std::unique_ptr<MotionSource> source, Presence& presence,
              CoordinatorPorts ports, CoordinatorRecord record);

  [[nodiscard]] Instant advance(Instant now) noexcept override;

  /// Before the first advance(): takes a command of the recording with its answers, in the order of the recording.
  /// @return false when the source of motion commands something else, in any bit, or has no command of its own.
  [[nodiscard]] bool replay(const AnsweredCommand& recorded) noexcept;
  /// The row of `steps` of the step that replay() completed last; its wall time is 0.
  [[nodiscard]] std::span<const double> replayed_row() const noexcept { return row_; }
  /// After the last replay(): this coordinator takes the place of the one that recorded.
  void resume(const ResumedTest& test) noexcept { resumed_ = test; }

  /// Ends the test safely, as Ctrl-C does, at the next advance().
  void request_stop(StopReason reason) noexcept { requested_stop_ = reason; }
  /// The process of the OpenSees that leads has ended, and will not connect again.
  void lead_has_left() noexcept { lead_has_left_ = true; }

  [[nodiscard]] bool is_done() const noexcept { return phase_ == Phase::done; }
  [[nodiscard]] CoordinatorReport report() const noexcept;

  /// @param ground_motions   how many. The first, or 0 without one, has the column ground_acceleration_m_per_s2; number
  /// k
  ///                         from 2 has ground_acceleration_k_m_per_s2.
  /// @param has_forces       a column with the applied force for each degree of freedom, ground motions left out.
  [[nodiscard]] static TableLayout steps_layout(const std::vector<std::string>& dofs, std::size_t ground_motions,
                                                bool has_forces);
  [[nodiscard]] static TableLayout exchanges_layout();
  [[nodiscard]] static TableLayout bridges_layout();
  /// One row per command, substructure and interface degree of freedom.
  [[nodiscard]] static TableLayout answers_layout();

 private:
  enum class Phase : std::uint8_t { settling, assembling, arming, rehearsing, running, stopping, done };

  void take_control_messages(Instant now) noexcept;
  void settle(Instant now) noexcept;
  void assemble(Instant now) noexcept;
  void arm(Instant now) noexcept;
  void rehearse(Instant now) noexcept;
  void send_rehearsal(std::uint16_t round, Instant now) noexcept;
  void judge_rehearsal(Instant now) noexcept;
  void start(Instant now) noexcept;
  void run(Instant now) noexcept;
  void stop(Instant now) noexcept;

  void watch_participants(Instant now) noexcept;
  void watch_links(Instant now) noexcept;
  /// Opens the next command, if the source has one.
  /// @return false when it has none yet or the test ends.
  [[nodiscard]] bool open_next(Instant now) noexcept;
  void tell_events(Instant now) noexcept;
  void open_command(Instant now) noexcept;
  void send_command(SubstructureIndex substructure, Instant now) noexcept;
  void repeat_unanswered(Instant now) noexcept;
  /// When the first unanswered command is to be sent again.
  [[nodiscard]] Instant first_repeat() const noexcept;
  /// The open step has a deadline.
  [[nodiscard]] bool has_deadline() const noexcept { return is_real_time() && ledger_.step() > 0; }
  [[nodiscard]] bool is_real_time() const noexcept { return settings_.mode == CouplingMode::real_time; }
  /// In real time: when a site ends the step, if a message takes no time.
  [[nodiscard]] Instant time_of(Step step) const noexcept {
    return step_zero_ + from_seconds(static_cast<double>(step) * settings_.step_s);
  }
  [[nodiscard]] Instant deadline_of(Step step) const noexcept {
    return time_of(step) + usual_round_trip_ + settings_.bridging.deadline;
  }
  void take_answer(const ForceMeasurement& answer, Instant now) noexcept;
  void keep_early(const ForceMeasurement& answer) noexcept;
  /// Answers kept of each substructure.
  [[nodiscard]] std::size_t early_each() const noexcept {
    return static_cast<std::size_t>(settings_.bridging.most_in_a_row) + 1;
  }
  void take_early(Instant now) noexcept;
  void bridge_unanswered() noexcept;
  /// Counts what missed its deadline in the step. @return false when there are too many in a row, which ends the test.
  [[nodiscard]] bool watch_deadlines(Instant now) noexcept;
  void record_bridges(bool at_end) noexcept;
  void complete_command(Instant now) noexcept;
  /// @return false when a force is not finite, which ends the test.
  [[nodiscard]] bool collect_forces(Instant now) noexcept;
  /// Goes on to the next trial of the step.
  void go_on_trying(Instant now) noexcept;
  void complete_step(Instant now) noexcept;
  /// K u of the elastic part, added to the forces of the substructures.
  void add_elastic_force() noexcept;
  void record_step(Instant now) noexcept;
  /// The last completed step, into `row_`.
  void fill_step_row(double wall_time_s) noexcept;
  void record_answers() noexcept;
  /// The load of the open step; then the source takes the forces.
  void advance_source() noexcept;
  /// Everyone who takes part in a resumed test has accepted this coordinator, or has restored its state.
  [[nodiscard]] bool everyone_goes_on() const noexcept;
  void record_exchanges() noexcept;
  /// @param who   ended the test: a participant's id or `operator`.
  void begin_stop(Instant now, StopReason reason, const ParticipantId& who = {}) noexcept;
  /// The substructure that keeps the test waiting while the others have answered; nullptr without one.
  [[nodiscard]] const CoupledSubstructure* owes_answer(const CoupledSubstructure& except) const noexcept;
  void watch_pace(Instant now) noexcept;
  void end_unassembled(Instant now, LifecycleState wanted) noexcept;
  /// At this end; the substructure is ready when it is at its own.
  [[nodiscard]] bool is_linked(std::size_t substructure) const noexcept;
  [[nodiscard]] bool everyone_is_linked() const noexcept;
  [[nodiscard]] bool everyone_is(LifecycleState state) const noexcept;
  [[nodiscard]] Instant next_wake(Instant now, Instant presence_wake) const noexcept;
  void report(Instant now, Severity severity, EventCode code, const ParticipantId& subject = {},
              std::array<double, 2> values = {}) noexcept;
  void control(ControlVerb verb, StopReason reason = StopReason::none) noexcept;
  void fill_point(const InterfaceMap& interface, Step step, const MotionState& motion,
                  CommandPoint& point) const noexcept;
  static void fill_rates(const InterfaceMap& interface, const MotionState& motion, CommandPoint& point) noexcept;

  CoordinatorSettings settings_;
  std::unique_ptr<MotionSource> source_;
  Presence& presence_;
  CoordinatorPorts ports_;
  CoordinatorRecord record_;

  std::optional<ResumedTest> resumed_;
  Phase phase_ = Phase::settling;
  Instant phase_began_{};
  bool began_ = false;
  std::uint64_t watched_ = 0;  // Presence::changes() at which all participants could go on
  StepLedger ledger_;
  std::vector<DisplacementCommand> commands_;  // newest one per substructure, with its history
  ForceMeasurement measurement_;               // the one being taken
  std::vector<CommandRepeats> repeats_;        // one per substructure
  Instant repeat_due_ = kNever;                // no command is sent again before
  Instant step_due_{};                         // paced: earliest time to send the commands of the open step
  bool command_is_open_ = false;               // the source has given one
  bool command_is_sent_ = false;
  bool is_paused_ = false;
  ClockWindows clocks_;
  bool clock_is_fresh_ = false;  // nothing was sent since it was read: what is taken now had come by then
  // In real time:
  std::optional<Rehearsal> rehearsal_;
  std::vector<ForceBridge> bridges_;  // one per substructure
  /// Answers to later steps: a site goes on while the coordinator waits for others. Free where the step is kNoStep.
  std::vector<ForceMeasurement> early_;
  struct Misses {
    int in_a_row = 0;
    int longest = 0;
    std::int64_t total = 0;
  };
  std::vector<Misses> misses_;   // likewise
  Duration usual_round_trip_{};  // of the slowest substructure
  bool is_lossy_ = false;        // the rehearsal lost an answer
  Instant step_zero_{};
  StopReason requested_stop_ = StopReason::none;
  bool lead_has_left_ = false;
  StopReason reason_ = StopReason::none;
  Step completed_steps_ = 0;
  Step recorded_steps_ = 0;
  int iterations_ = 0;  // trials of the last completed step
  Instant started_{};
  Instant step_completed_{};  // the last one; paced: or the end of a pause
  double longest_stall_s_ = 0.0;
  std::vector<Instant> heard_before_silence_;  // zero while a substructure is not silent
  Instant links_due_{};
  SubstructureIndex last_to_answer_ = 0;
  Duration running_time_{};
  Instant stop_by_{};  // then the coordinator leaves, whether the others are at rest or not
  Instant control_repeat_due_{};
  Eigen::VectorXd restoring_force_n_;
  Eigen::VectorXd applied_force_n_;
  Eigen::VectorXd forces_n_;  // of the loads that are forces; empty without them
  std::vector<double> row_;
};

}  // namespace hybridtest
