#include "coordinator/coordinator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "core/event_text.hpp"
#include "core/ring_port.hpp"
#include "tests/support/kept_rows.hpp"

namespace hybridtest {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Incarnation kOwn = 99;
constexpr double kStep_s = 0.01;
constexpr double kGround_m_per_s2 = 2.0;

/// Moves by one millimetre a step, so that what it was given can be read off.
class CountingSource final : public MotionSource {
 public:
  explicit CountingSource(Eigen::Index dofs) {
    current_.displacement_m = current_.velocity_m_per_s = current_.acceleration_m_per_s2 = Eigen::VectorXd::Zero(dofs);
    completed_ = current_;
  }
  [[nodiscard]] const MotionState& current() const noexcept override { return current_; }
  [[nodiscard]] const MotionState& completed() const noexcept override { return completed_; }
  void advance(const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
               const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) noexcept override {
    if (is_trial()) {
      ++iteration_;
      current_.displacement_m.array() += 0.0001;
      if (iteration_ == missing_after) missing_ = 0.5;
      return;
    }
    iteration_ = 0;
    completed_ = current_;
    completed_.displacement_m.array() += correction_m;
    completed_.velocity_m_per_s = restoring_force_n;
    completed_.acceleration_m_per_s2 = applied_force_n;
    current_.displacement_m.array() += 0.001;
    if (++advances == diverges_after) current_.displacement_m[0] = std::numeric_limits<double>::infinity();
  }

  [[nodiscard]] ParticipantId awaited(Instant) noexcept override { return awaits; }
  [[nodiscard]] NextMotion next(Instant) noexcept override { return asks; }
  [[nodiscard]] LeadEnd end() const noexcept override { return ends; }
  [[nodiscard]] std::optional<LeadEvent> take_event() noexcept override { return std::exchange(tells, std::nullopt); }
  void take_force(SubstructureIndex substructure, const InterfaceVector& force_n) noexcept override {
    forces_n[substructure] = force_n[0];
  }

  // What a program that leads does.
  ParticipantId awaits;
  NextMotion asks = NextMotion::command;
  LeadEnd ends;
  std::optional<LeadEvent> tells;
  std::array<double, 2> forces_n{};  // by substructure

  [[nodiscard]] int iteration() const noexcept override { return iteration_; }
  [[nodiscard]] bool is_trial() const noexcept override { return iteration_ < trials; }
  [[nodiscard]] double missing_m() const noexcept override { return missing_; }

  int trials = 0;  // of each step
  int missing_after = -1;

  double correction_m = 0.0;  // of the displacement once the force is known
  int advances = 0;
  int diverges_after = -1;

 private:
  int iteration_ = 0;
  double missing_ = 0.0;
  MotionState current_;
  MotionState completed_;
};

/// A coordinator of two substructures, `a` at the only degree of freedom and `b` likewise, whose
/// part the test plays.
class CoordinatorTest : public testing::Test {
 protected:
  struct Substructure {
    ParticipantStatus status;
    bool answers = true;
  };

  void make(CouplingMode mode = CouplingMode::lockstep, Step last_step = 5, bool stop_on_recording_failure = false,
            double time_scale = 1.0, double stiffness_n_per_m = 0.0) {
    CoordinatorSettings settings;
    if (stiffness_n_per_m != 0.0) {
      settings.stiffness_n_per_m = Eigen::MatrixXd::Constant(1, 1, stiffness_n_per_m).sparseView();
    }
    settings.test_name = "test";
    settings.mode = mode;
    settings.step_s = kStep_s;
    settings.duration_s = kStep_s * static_cast<double>(last_step);
    settings.time_scale = time_scale;
    settings.last_step = last_step;
    settings.substructures = {{"a", Role::experimental_site, InterfaceMap{1, {{0}}}},
                              {"b", Role::numerical_substructure, InterfaceMap{1, {{0}}}}};
    settings.recorded_dofs = {0};
    settings.load = AppliedLoad{{{Eigen::VectorXd::Constant(1, -3.0),
                                  std::vector<double>(static_cast<std::size_t>(last_step) + 1, kGround_m_per_s2)}},
                                {}};
    settings.stop_on_recording_failure = stop_on_recording_failure;
    auto source = std::make_unique<CountingSource>(1);
    source_ = source.get();
    coordinator_ =
        std::make_unique<Coordinator>(settings, std::move(source), presence_,
                                      CoordinatorPorts{announcements_, control_in_, control_out_, measurements_,
                                                       commands_, [this](SubstructureIndex i) { return linked_[i]; }},
                                      CoordinatorRecord{steps_, exchanges_});
    for (std::size_t i = 0; i < 2; ++i) {
      substructures_[i].status.id = i == 0 ? "a" : "b";
      substructures_[i].status.incarnation = 10 + i;
    }
  }

  /// Time passes and the coordinator runs.
  Instant advance(Duration passed = {}) {
    now_ += passed;
    return coordinator_->advance(now_);
  }
  void say(std::size_t substructure, LifecycleState state, FaultFlags faults = FaultFlags::none) {
    ParticipantStatus& status = substructures_[substructure].status;
    status.state = state;
    status.faults = faults;
    status.clock = now_.time_since_epoch();
    statuses_.send(status);
  }
  void say_both(LifecycleState state) {
    say(0, state);
    say(1, state);
  }
  /// Heartbeats, so that nobody is lost while time passes.
  void keep_alive() {
    for (const Substructure& substructure : substructures_) statuses_.send(substructure.status);
  }
  void answer(std::size_t substructure, Step step, double force_n = 1.0, Incarnation sender = 0,
              std::uint16_t iteration = 0) {
    ForceMeasurement measurement;
    measurement.iteration = iteration;
    measurement.substructure = static_cast<SubstructureIndex>(substructure);
    measurement.sender = sender == 0 ? substructures_[substructure].status.incarnation : sender;
    measurement.step = step;
    measurement.force_n = InterfaceVector::Constant(1, force_n);
    measurements_.send(measurement);
  }
  /// The steps 0 to 4, a millisecond apart.
  void answer_five_steps() {
    for (Step step = 0; step < 5; ++step) {
      answer(0, step, 10.0);
      answer(1, step, 20.0);
      advance(milliseconds{1});
    }
  }
  /// Settled, everyone ready and armed; step 0 has gone out.
  void start() {
    advance();
    advance(milliseconds{300});
    say_both(LifecycleState::ready);
    advance();
    say_both(LifecycleState::armed);
    advance();
    say_both(LifecycleState::running);
    advance();
  }
  void operator_says(ControlVerb verb) {
    TestControl message;
    message.verb = verb;
    message.sender = 1234;
    control_in_.send(message);
    advance();
  }
  std::vector<DisplacementCommand> take_commands() { return take_all(commands_); }
  std::vector<TestControl> take_control() { return take_all(control_out_); }
  template <class Message>
  static std::vector<Message> take_all(RingPort<Message>& port) {
    std::vector<Message> taken;
    Message message;
    while (port.take(message)) taken.push_back(message);
    return taken;
  }
  /// Subjects of the events with this code since the last call.
  std::multiset<std::string> subjects(EventCode code) {
    for (const Event& event : take_all(events_)) told_.push_back(event);
    std::multiset<std::string> found;
    for (const Event& event : told_) {
      if (event.code == code) found.insert(event.subject.text());
    }
    return found;
  }
  [[nodiscard]] StopReason reason() const { return coordinator_->report().reason; }
  [[nodiscard]] Step completed() const { return coordinator_->report().completed_steps; }

  RingPort<ParticipantStatus> statuses_{256};
  RingPort<ParticipantStatus> own_statuses_{4096};
  RingPort<Event> events_{1024};
  RingPort<TestAnnouncement> announcements_{4};
  RingPort<TestControl> control_in_{16};
  RingPort<TestControl> control_out_{1024};
  RingPort<ForceMeasurement> measurements_{256};
  RingPort<DisplacementCommand> commands_{1024};
  KeptRows steps_{Coordinator::steps_layout({"floor"}, 1, false)};
  KeptRows exchanges_{Coordinator::exchanges_layout()};
  Presence presence_{Identity{"coordinator", Role::coordinator, kOwn, {}}, seconds{2}, statuses_, own_statuses_,
                     events_};
  std::array<Substructure, 2> substructures_;
  std::array<bool, 2> linked_{true, true};
  CountingSource* source_ = nullptr;
  std::unique_ptr<Coordinator> coordinator_;
  Instant now_{};
  std::vector<Event> told_;
};

TEST_F(CoordinatorTest, AnnouncesTestAfterListeningForOlderCoordinator) {
  make();
  TestAnnouncement announcement;
  advance();
  advance(milliseconds{299});
  EXPECT_FALSE(announcements_.take(announcement));
  advance(milliseconds{1});
  ASSERT_TRUE(announcements_.take(announcement));
  EXPECT_EQ(announcement.coordinator, kOwn);
  ASSERT_EQ(announcement.substructures.size(), 2U);
  EXPECT_EQ(announcement.substructures[1].id, "b");
  EXPECT_EQ(announcement.substructures[1].interface_dofs, 1);
  EXPECT_EQ(announcement.step_s, kStep_s);
}

/// Nothing else may wake it before its next heartbeat.
TEST_F(CoordinatorTest, TellsANewStateBeforeItSleeps) {
  make();
  advance();
  advance(milliseconds{300});
  EXPECT_EQ(take_all(own_statuses_).back().state, LifecycleState::ready);
  say_both(LifecycleState::ready);
  advance();
  say_both(LifecycleState::armed);
  advance();
  EXPECT_EQ(take_all(own_statuses_).back().state, LifecycleState::running);
}

TEST_F(CoordinatorTest, ArmsWhenAllAreReadyAndStartsWhenAllAreArmed) {
  make();
  advance();
  advance(milliseconds{300});
  say(0, LifecycleState::ready);
  advance();
  EXPECT_TRUE(take_control().empty());
  say(1, LifecycleState::ready);
  advance();
  auto control = take_control();
  ASSERT_EQ(control.size(), 1U);
  EXPECT_EQ(control[0].verb, ControlVerb::arm);
  advance(milliseconds{250});
  control = take_control();
  ASSERT_EQ(control.size(), 1U) << "arm is said again to who did not obey";
  say_both(LifecycleState::armed);
  EXPECT_TRUE(take_commands().empty());
  advance();
  control = take_control();
  ASSERT_EQ(control.size(), 1U);
  EXPECT_EQ(control[0].verb, ControlVerb::start);
  const auto commands = take_commands();
  ASSERT_EQ(commands.size(), 2U);
  EXPECT_EQ(commands[0].newest().step, 0);
  EXPECT_EQ(commands[1].substructure, 1);
}

TEST_F(CoordinatorTest, AsksForTrialsBeforeTheFinalDisplacement) {
  make();
  source_->trials = 2;
  start();
  for (std::uint16_t iteration = 0; iteration <= 2; ++iteration) {
    const auto commands = take_commands();
    ASSERT_EQ(commands.size(), 2U);
    EXPECT_EQ(commands[1].newest().step, 0);
    EXPECT_EQ(commands[1].point_count, 1) << "a trial is no point of the history";
    EXPECT_EQ(commands[1].iteration, iteration);
    EXPECT_EQ(commands[1].is_trial, iteration < 2);
    EXPECT_NEAR(commands[1].newest().displacement_m[0], 0.0001 * iteration, 1e-15);
    EXPECT_EQ(completed(), 0);
    if (iteration > 0) answer(0, 0, 77.0, 0, 0);  // a late one
    answer(0, 0, 10.0, 0, iteration);
    answer(1, 0, 20.0, 0, iteration);
    advance(milliseconds{1});
  }
  EXPECT_EQ(completed(), 1);
  ASSERT_EQ(steps_.size(), 1U);
  EXPECT_EQ(steps_.at(0, steps_.column("iterations")), 2.0);
  EXPECT_EQ(steps_.at(0, steps_.column("restoring_force_floor_n")), 30.0);
  EXPECT_EQ(exchanges_.column_values("iteration"), (std::vector<double>{0.0, 0.0, 1.0, 1.0, 2.0, 2.0}));
  EXPECT_EQ(take_commands().front().newest().step, 1);
}

TEST_F(CoordinatorTest, RepeatsATrialThatIsNotAnswered) {
  make();
  source_->trials = 1;
  start();
  static_cast<void>(take_commands());
  answer(0, 0);
  advance(milliseconds{250});
  const auto repeated = take_commands();
  ASSERT_EQ(repeated.size(), 1U);
  EXPECT_EQ(repeated[0].substructure, 1);
  EXPECT_EQ(repeated[0].iteration, 0);
  EXPECT_TRUE(repeated[0].is_trial);
  EXPECT_EQ(repeated[0].attempt, 1);
}

TEST_F(CoordinatorTest, EndsWithoutEquilibrium) {
  make();
  source_->trials = 3;
  source_->missing_after = 2;
  start();
  for (std::uint16_t iteration = 0; iteration < 2; ++iteration) {
    answer(0, 0, 1.0, 0, iteration);
    answer(1, 0, 1.0, 0, iteration);
    advance(milliseconds{1});
  }
  EXPECT_EQ(reason(), StopReason::no_equilibrium);
  static_cast<void>(subjects(EventCode::no_equilibrium));
  const auto told = std::ranges::find(told_, EventCode::no_equilibrium, &Event::code);
  ASSERT_NE(told, told_.end());
  EXPECT_EQ(told->values[0], 2.0);
  EXPECT_EQ(told->values[1], 0.5);
  EXPECT_EQ(steps_.size(), 0U);
}

TEST_F(CoordinatorTest, NamesSubstructureThatDidNotAppear) {
  make();
  advance();
  advance(milliseconds{300});
  say(0, LifecycleState::ready);
  advance(seconds{1});
  for (int i = 0; i < 29; ++i) {
    say(0, LifecycleState::ready);
    advance(seconds{1});
    ASSERT_EQ(reason(), i < 28 ? StopReason::none : StopReason::not_assembled) << i;
  }
  EXPECT_EQ(subjects(EventCode::participant_missing), (std::multiset<std::string>{"b"}));
}

TEST_F(CoordinatorTest, DoesNotArmBeforeCommandsAndMeasurementsConnect) {
  make();
  linked_[1] = false;
  advance();
  advance(milliseconds{300});
  for (int i = 0; i < 5; ++i) {
    say_both(LifecycleState::ready);
    advance(seconds{1});
  }
  EXPECT_TRUE(take_control().empty());
  linked_[1] = true;
  advance();
  const auto control = take_control();
  ASSERT_EQ(control.size(), 1U);
  EXPECT_EQ(control[0].verb, ControlVerb::arm);
}

TEST_F(CoordinatorTest, NamesSubstructureThatDidNotConnect) {
  make();
  linked_[1] = false;
  advance();
  advance(milliseconds{300});
  for (int i = 0; i < 31; ++i) {
    say_both(LifecycleState::ready);
    advance(seconds{1});
  }
  EXPECT_EQ(reason(), StopReason::not_assembled);
  EXPECT_EQ(subjects(EventCode::participant_missing), (std::multiset<std::string>{"b"}));
  const auto event = std::ranges::find(told_, EventCode::participant_missing, &Event::code);
  ASSERT_NE(event, told_.end());
  EXPECT_NE(describe(*event).find("'b' is ready, but the connection for its commands and measurements"),
            std::string::npos)
      << describe(*event);
}

TEST_F(CoordinatorTest, NamesSubstructureThatDidNotArm) {
  make();
  advance();
  advance(milliseconds{300});
  say_both(LifecycleState::ready);
  advance();
  say(1, LifecycleState::armed);
  for (int i = 0; i < 11; ++i) {
    keep_alive();
    advance(seconds{1});
  }
  EXPECT_EQ(reason(), StopReason::not_assembled);
  EXPECT_EQ(subjects(EventCode::participant_missing), (std::multiset<std::string>{"a"}));
}

TEST_F(CoordinatorTest, TellsWhoGaveUpBeforeTheStart) {
  make();
  advance();
  advance(milliseconds{300});
  say(1, LifecycleState::refused);
  advance();
  EXPECT_EQ(reason(), StopReason::not_assembled);
  EXPECT_EQ(subjects(EventCode::participant_missing), (std::multiset<std::string>{"b"}));
}

TEST_F(CoordinatorTest, EndsWhenASubstructureRefuses) {
  make();
  advance();
  advance(milliseconds{300});
  substructures_[1].status.scenario_digest.fill(1);
  say(1, LifecycleState::refused);
  advance();
  EXPECT_EQ(reason(), StopReason::refused);
  EXPECT_EQ(subjects(EventCode::digest_mismatch), (std::multiset<std::string>{"b"}));
}

TEST_F(CoordinatorTest, CompletesEveryStepOnceAndInOrder) {
  make();
  start();
  Step step = 0;
  while (completed() <= 5 && reason() == StopReason::none) {
    answer(0, step, 10.0);
    answer(0, step, 1e9);      // repeated by the network, or worse
    answer(1, step - 1, 1e9);  // late
    answer(1, step, 1e9, 77);  // of another process
    answer(1, step + 1, 1e9);  // of a step not asked for
    advance(milliseconds{1});
    ASSERT_EQ(completed(), step);
    answer(1, step, 20.0);
    advance(milliseconds{1});
    ASSERT_EQ(completed(), ++step);
  }
  EXPECT_EQ(reason(), StopReason::completed);
  EXPECT_EQ(completed(), 6);
  EXPECT_EQ(source_->advances, 6);
  ASSERT_EQ(steps_.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(steps_.at(i, steps_.column("step")), static_cast<double>(i));
    EXPECT_DOUBLE_EQ(steps_.at(i, steps_.column("displacement_floor_m")), 0.001 * static_cast<double>(i));
    EXPECT_EQ(steps_.at(i, steps_.column("restoring_force_floor_n")), 30.0);
    EXPECT_EQ(steps_.at(i, steps_.column("acceleration_floor_m_per_s2")), -3.0 * kGround_m_per_s2);
    EXPECT_EQ(steps_.at(i, steps_.column("ground_acceleration_m_per_s2")), kGround_m_per_s2);
  }
  ASSERT_EQ(exchanges_.size(), 12U);
  EXPECT_NEAR(exchanges_.at(3, exchanges_.column("round_trip_us")), 2000.0, 1e-6);
}

TEST_F(CoordinatorTest, AddsTheForceOfTheElasticPart) {
  make(CouplingMode::lockstep, 5, false, 1.0, 2.0e4);
  start();
  for (Step step = 0; step < 6; ++step) {
    answer(0, step, 10.0);
    answer(1, step, 20.0);
    advance(milliseconds{1});
  }
  ASSERT_EQ(steps_.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    const double displacement_m = steps_.at(i, steps_.column("displacement_floor_m"));
    EXPECT_DOUBLE_EQ(displacement_m, 0.001 * static_cast<double>(i));
    // The source of this test hands on as velocity the restoring force that it is given.
    EXPECT_EQ(steps_.at(i, steps_.column("velocity_floor_m_per_s")), 30.0 + 2.0e4 * displacement_m);
    EXPECT_EQ(steps_.at(i, steps_.column("restoring_force_floor_n")), 30.0 + 2.0e4 * displacement_m);
  }
}

TEST_F(CoordinatorTest, CommandCarriesPreviousSteps) {
  make();
  start();
  answer_five_steps();
  const auto commands = take_commands();
  ASSERT_EQ(commands.size(), 12U);
  const DisplacementCommand& newest = commands.back();
  ASSERT_EQ(newest.point_count, kCommandPoints);
  for (int i = 0; i < kCommandPoints; ++i) {
    const CommandPoint& point = newest.points[static_cast<std::size_t>(i)];
    EXPECT_EQ(point.step, 5 - i);
    EXPECT_DOUBLE_EQ(point.displacement_m[0], 0.001 * static_cast<double>(5 - i));
    EXPECT_DOUBLE_EQ(point.model_time_s, kStep_s * static_cast<double>(5 - i));
    // Final velocity once the step is complete; this source gives the restoring force for it.
    EXPECT_EQ(point.velocity_m_per_s[0], i > 0 ? 30.0 : 0.0);
  }
  EXPECT_EQ(commands[0].point_count, 1);
}

TEST_F(CoordinatorTest, CorrectionIsRecordedAndNotCommanded) {
  make();
  source_->correction_m = 0.0004;
  start();
  answer_five_steps();
  const auto commands = take_commands();
  ASSERT_EQ(commands.size(), 12U);
  for (const DisplacementCommand& command : commands) {
    for (int i = 0; i < command.point_count; ++i) {
      const CommandPoint& point = command.points[static_cast<std::size_t>(i)];
      EXPECT_DOUBLE_EQ(point.displacement_m[0], 0.001 * static_cast<double>(point.step));
    }
  }
  EXPECT_DOUBLE_EQ(steps_.at(3, steps_.column("displacement_floor_m")), 0.0034);
}

TEST_F(CoordinatorTest, RepeatsCommandToSilentSubstructures) {
  make();
  start();
  take_commands();
  answer(0, 0);
  advance(milliseconds{199});
  EXPECT_TRUE(take_commands().empty());
  advance(milliseconds{1});
  auto commands = take_commands();
  ASSERT_EQ(commands.size(), 1U);
  EXPECT_EQ(commands[0].substructure, 1);
  EXPECT_EQ(commands[0].attempt, 1);
  EXPECT_EQ(commands[0].newest().step, 0);
  advance(milliseconds{200});
  EXPECT_EQ(take_commands().size(), 1U);
  answer(1, 0);
  advance();
  EXPECT_EQ(subjects(EventCode::command_repeated), (std::multiset<std::string>{"b"})) << "said once a step";
  EXPECT_EQ(exchanges_.at(0, exchanges_.column("attempts")), 1.0);
  EXPECT_EQ(exchanges_.at(1, exchanges_.column("attempts")), 3.0);
}

TEST_F(CoordinatorTest, PacedModeDoesNotRetrySlowStep) {
  make(CouplingMode::paced, 5, false, 100.0);  // a step lasts a second
  start();
  answer(0, 0);
  answer(1, 0);
  advance();
  take_commands();
  for (int i = 0; i < 10; ++i) {
    keep_alive();
    advance(milliseconds{100});
    EXPECT_TRUE(take_commands().empty()) << "the actuator is still on its way";
  }
  keep_alive();
  advance(milliseconds{200});
  EXPECT_EQ(take_commands().size(), 2U);
}

TEST_F(CoordinatorTest, PacedModeSendsCommandsOnTime) {
  make(CouplingMode::paced, 20);
  start();  // step 0 is out
  std::vector<Instant> sent;
  Step answered = 0;
  for (int millisecond = 0; millisecond < 100; ++millisecond) {
    for (const DisplacementCommand& command : take_commands()) {
      if (command.substructure == 0) sent.push_back(now_);
    }
    if (sent.size() > static_cast<std::size_t>(answered)) {
      answer(0, answered);
      answer(1, answered);
      ++answered;
    }
    advance(milliseconds{1});
  }
  // One step ahead of its own time: step 1 goes out with step 0's answer, at most one step long
  // ahead, and each one after it a step later.
  ASSERT_GE(sent.size(), 5U);
  for (std::size_t i = 2; i < sent.size(); ++i) EXPECT_GE(sent[i] - sent[i - 1], milliseconds{10});
  EXPECT_LE(sent.size(), 12U);
}

TEST_F(CoordinatorTest, PausesAndResumes) {
  make();
  start();
  answer(0, 0);
  answer(1, 0);
  advance();
  take_commands();
  operator_says(ControlVerb::pause);
  answer(0, 1);
  answer(1, 1);
  advance();
  EXPECT_EQ(completed(), 2) << "what was asked is completed";
  EXPECT_TRUE(take_commands().empty()) << "and nothing new asked";
  operator_says(ControlVerb::resume);
  EXPECT_EQ(take_commands().size(), 2U);
  EXPECT_EQ(subjects(EventCode::test_paused).size(), 1U);
  EXPECT_EQ(subjects(EventCode::test_resumed).size(), 1U);
}

TEST_F(CoordinatorTest, NonFiniteForceEndsTest) {
  make();
  start();
  answer(0, 0);
  answer(1, 0, std::numeric_limits<double>::quiet_NaN());
  advance();
  EXPECT_EQ(reason(), StopReason::not_finite);
  EXPECT_EQ(source_->advances, 0);
  EXPECT_EQ(subjects(EventCode::measurement_not_finite), (std::multiset<std::string>{"b"}));
  EXPECT_EQ(exchanges_.size(), 2U) << "the exchange that ended the test is on record";
}

TEST_F(CoordinatorTest, WrongForceVectorSizeEndsTest) {
  make();
  start();
  answer(0, 0);
  ForceMeasurement measurement;
  measurement.substructure = 1;
  measurement.sender = substructures_[1].status.incarnation;
  measurement.step = 0;
  measurement.force_n = InterfaceVector::Zero(2);
  measurements_.send(measurement);
  advance();
  EXPECT_EQ(reason(), StopReason::not_finite);
  EXPECT_EQ(source_->advances, 0);
}

TEST_F(CoordinatorTest, NonFiniteMotionEndsTest) {
  make();
  source_->diverges_after = 3;
  start();
  for (Step step = 0; step < 5; ++step) {
    answer(0, step);
    answer(1, step);
    advance();
  }
  EXPECT_EQ(reason(), StopReason::not_finite);
  EXPECT_EQ(steps_.size(), 3U);
  for (const DisplacementCommand& command : take_commands()) EXPECT_TRUE(command.newest().displacement_m.allFinite());
}

TEST_F(CoordinatorTest, ArmsWhenTheProgramThatLeadsIsThere) {
  make();
  source_->awaits = "b";
  source_->tells = LeadEvent{EventCode::opensees_refused, "a", {1.0, 0.0}};
  advance();
  advance(milliseconds{300});
  say_both(LifecycleState::ready);
  advance();
  EXPECT_TRUE(take_control().empty());
  EXPECT_EQ(subjects(EventCode::opensees_refused), (std::multiset<std::string>{"a"}));
  source_->awaits = {};
  advance();
  ASSERT_EQ(take_control().size(), 1U);
}

TEST_F(CoordinatorTest, MissingProgramThatLeadsIsNamed) {
  make();
  source_->awaits = "b";
  advance();
  advance(milliseconds{300});
  for (int s = 0; s < 31; ++s) {
    say_both(LifecycleState::ready);
    advance(seconds{1});
  }
  EXPECT_EQ(reason(), StopReason::not_assembled);
  EXPECT_EQ(subjects(EventCode::opensees_missing), (std::multiset<std::string>{"b"}));
  EXPECT_TRUE(subjects(EventCode::participant_missing).empty());
}

TEST_F(CoordinatorTest, WaitsForTheNextQuestionAndRecordsMeanwhile) {
  make();
  start();
  take_commands();
  source_->asks = NextMotion::none;
  answer(0, 0, 10.0);
  answer(1, 0, 20.0);
  advance();
  EXPECT_TRUE(take_commands().empty());
  EXPECT_EQ(steps_.size(), 1U) << "a step that is complete is not kept back";
  EXPECT_EQ(source_->forces_n, (std::array{10.0, 20.0}));
  source_->asks = NextMotion::command;
  advance();
  EXPECT_EQ(take_commands().size(), 2U);
}

TEST_F(CoordinatorTest, EndsWithTheProgramThatLeads) {
  make();
  start();
  source_->asks = NextMotion::end;
  source_->ends = {StopReason::opensees_iterates, {EventCode::opensees_iterates, "a", {}}};
  answer(0, 0);
  answer(1, 0);
  advance();
  EXPECT_EQ(reason(), StopReason::opensees_iterates);
  EXPECT_EQ(subjects(EventCode::opensees_iterates), (std::multiset<std::string>{"a"}));
  EXPECT_EQ(subjects(EventCode::test_stopped), (std::multiset<std::string>{"opensees"}));
}

TEST_F(CoordinatorTest, ProgramThatLeavesBeforeTheStartEndsTest) {
  make();
  advance();
  advance(milliseconds{300});
  coordinator_->lead_has_left();
  advance();
  EXPECT_EQ(reason(), StopReason::participant_failed);
}

TEST_F(CoordinatorTest, OverdueCommandIsBlamedOnTheProgramThatLeads) {
  make();
  start();
  source_->asks = NextMotion::none;
  answer(0, 0);
  answer(1, 0);
  advance();
  say(0, LifecycleState::running, FaultFlags::command_age);
  advance();
  EXPECT_EQ(reason(), StopReason::opensees_lost);
  EXPECT_EQ(subjects(EventCode::opensees_silent).size(), 1U);
}

TEST_F(CoordinatorTest, LosesSubstructureWhenLeaseExpires) {
  make();
  start();
  for (int i = 0; i < 5; ++i) {
    say(0, LifecycleState::running);
    advance(milliseconds{500});
  }
  EXPECT_EQ(reason(), StopReason::participant_lost);
  EXPECT_EQ(subjects(EventCode::participant_lost), (std::multiset<std::string>{"b"}));
  EXPECT_EQ(exchanges_.size(), 2U) << "the unanswered exchange is on record";
}

TEST_F(CoordinatorTest, WaitsForALinkAndSaysSo) {
  presence_.wait_for_links(seconds{30});
  make();
  start();
  for (int i = 0; i < 6; ++i) {
    say(0, LifecycleState::running);
    advance(milliseconds{500});
  }
  EXPECT_EQ(reason(), StopReason::none);
  EXPECT_EQ(subjects(EventCode::link_silent), (std::multiset<std::string>{"b"}));
  EXPECT_TRUE(subjects(EventCode::link_back).empty());
  say_both(LifecycleState::running);
  advance(milliseconds{500});
  EXPECT_EQ(subjects(EventCode::link_back), (std::multiset<std::string>{"b"}));
  const auto back = std::ranges::find(told_, EventCode::link_back, &Event::code);
  EXPECT_NEAR(back->values[0], 3.5, 0.51);
  answer(0, 0);
  answer(1, 0);
  advance();
  EXPECT_EQ(completed(), 1);
}

TEST_F(CoordinatorTest, NamesAllLostSubstructures) {
  make();
  start();
  advance(seconds{2});
  EXPECT_EQ(reason(), StopReason::participant_lost);
  EXPECT_EQ(subjects(EventCode::participant_lost), (std::multiset<std::string>{"a", "b"}));
}

TEST_F(CoordinatorTest, ManuallyStoppedSubstructureInterruptsTest) {
  make();
  start();
  say(0, LifecycleState::stopping);
  advance();
  EXPECT_EQ(reason(), StopReason::interrupted);
}

TEST_F(CoordinatorTest, DepartedSubstructureIsNotLost) {
  make();
  start();
  say(1, LifecycleState::finished);
  advance();
  EXPECT_EQ(reason(), StopReason::interrupted);
  EXPECT_TRUE(subjects(EventCode::participant_lost).empty());
}

TEST_F(CoordinatorTest, SiteFaultEndsTestAsInterlock) {
  make();
  start();
  say(0, LifecycleState::running, FaultFlags::force_limit);
  advance();
  EXPECT_EQ(reason(), StopReason::interlock);
}

TEST_F(CoordinatorTest, FailedRecordingEndsTestOnlyIfConfigured) {
  make(CouplingMode::lockstep, 5, false);
  start();
  say(0, LifecycleState::running, FaultFlags::records_dropped);
  advance();
  EXPECT_EQ(reason(), StopReason::none);

  const Instant before = now_;
  make(CouplingMode::lockstep, 5, true);
  now_ = before;
  start();
  say(0, LifecycleState::running, FaultFlags::records_dropped);
  advance();
  EXPECT_EQ(reason(), StopReason::recording_failed);
}

TEST_F(CoordinatorTest, RepeatsStopUntilAllAreAtRest) {
  make();
  start();
  take_control();
  coordinator_->request_stop(StopReason::interrupted);
  advance();
  EXPECT_EQ(reason(), StopReason::interrupted);
  auto control = take_control();
  ASSERT_EQ(control.size(), 1U);
  EXPECT_EQ(control[0].verb, ControlVerb::stop);
  EXPECT_EQ(control[0].reason, StopReason::interrupted);
  say(0, LifecycleState::finished);
  advance(milliseconds{250});
  EXPECT_EQ(take_control().size(), 1U);
  EXPECT_FALSE(coordinator_->is_done());
  say(1, LifecycleState::finished);
  EXPECT_EQ(advance(), kNever);
  EXPECT_TRUE(coordinator_->is_done());
  const auto statuses = take_all(own_statuses_);
  EXPECT_EQ(statuses.back().state, LifecycleState::finished) << "the last word goes out";
}

TEST_F(CoordinatorTest, WaitsLimitedTimeForOthersToRest) {
  make();
  start();
  coordinator_->request_stop(StopReason::interrupted);
  advance();
  for (int i = 0; i < 100; ++i) {
    keep_alive();
    advance(milliseconds{99});
  }
  EXPECT_FALSE(coordinator_->is_done());
  keep_alive();
  advance(milliseconds{100});
  EXPECT_TRUE(coordinator_->is_done());
}

TEST_F(CoordinatorTest, EmergencyStopEndsTest) {
  make();
  start();
  operator_says(ControlVerb::emergency_stop);
  EXPECT_EQ(reason(), StopReason::emergency_stop);
  operator_says(ControlVerb::emergency_stop);
  EXPECT_EQ(subjects(EventCode::emergency_stop).size(), 1U) << "the operator's tool repeats itself";
  EXPECT_EQ(subjects(EventCode::test_stopped), (std::multiset<std::string>{"operator"}));
}

TEST_F(CoordinatorTest, EmergencyStopAtASiteIsNoInterlock) {
  make();
  start();
  say(0, LifecycleState::stopping, FaultFlags::emergency_stop);
  advance();
  EXPECT_EQ(reason(), StopReason::emergency_stop);
}

TEST_F(CoordinatorTest, SilentSubstructureIsTheCauseOfAnOverdueCommand) {
  make();
  start();
  answer(0, 0);
  advance();
  say(0, LifecycleState::running, FaultFlags::command_age);
  advance(milliseconds{800});
  EXPECT_EQ(reason(), StopReason::participant_lost);
  EXPECT_EQ(subjects(EventCode::answer_overdue), (std::multiset<std::string>{"b"}));
  EXPECT_EQ(subjects(EventCode::test_stopped), (std::multiset<std::string>{"b"}));
}

TEST_F(CoordinatorTest, OverdueCommandIsAnInterlockWhenNobodyOwesAnAnswer) {
  make();
  start();
  answer(1, 0);
  advance();
  say(0, LifecycleState::running, FaultFlags::command_age);
  advance(milliseconds{800});
  EXPECT_EQ(reason(), StopReason::interlock);
  EXPECT_EQ(subjects(EventCode::test_stopped), (std::multiset<std::string>{"a"}));
}

TEST_F(CoordinatorTest, LeavesUnarmedTestWithinHalfASecond) {
  make();
  advance();
  advance(milliseconds{300});
  say(0, LifecycleState::ready);
  advance();
  coordinator_->request_stop(StopReason::interrupted);
  advance();
  EXPECT_FALSE(coordinator_->is_done());
  advance(milliseconds{500});
  EXPECT_TRUE(coordinator_->is_done());
}

TEST_F(CoordinatorTest, FailedParticipantIsTheReasonGivenByTheMonitor) {
  make();
  advance();
  TestControl message;
  message.verb = ControlVerb::stop;
  message.reason = StopReason::participant_failed;
  message.sender = 1234;
  control_in_.send(message);
  advance();
  EXPECT_EQ(reason(), StopReason::participant_failed);
}

TEST_F(CoordinatorTest, ReportsAStallOfAPacedTest) {
  make(CouplingMode::paced, 20);
  start();
  const auto take_step = [&](Step step, Duration after) {
    advance(after);
    answer(0, step);
    answer(1, step);
    keep_alive();
    advance();
  };
  for (Step step = 0; step < 5; ++step) take_step(step, milliseconds{10});
  EXPECT_TRUE(subjects(EventCode::test_stalled).empty());
  take_step(5, milliseconds{500});
  take_step(6, milliseconds{10});
  EXPECT_EQ(subjects(EventCode::test_stalled), (std::multiset<std::string>{"b"}));
  const auto stalled = std::ranges::find(told_, EventCode::test_stalled, &Event::code);
  EXPECT_NEAR(stalled->values[0], 0.5, 1e-9);
  EXPECT_EQ(stalled->values[1], kStep_s);
}

TEST_F(CoordinatorTest, PauseIsNoStall) {
  make(CouplingMode::paced, 20);
  start();
  for (Step step = 0; step < 3; ++step) {
    advance(milliseconds{10});
    answer(0, step);
    answer(1, step);
    advance();
  }
  operator_says(ControlVerb::pause);
  advance(milliseconds{500});
  keep_alive();
  operator_says(ControlVerb::resume);
  advance(milliseconds{10});
  answer(0, 3);
  answer(1, 3);
  advance();
  EXPECT_EQ(completed(), 4);
  EXPECT_TRUE(subjects(EventCode::test_stalled).empty());
}

TEST_F(CoordinatorTest, YoungerCoordinatorLeavesWithoutEffect) {
  make();
  ParticipantStatus other;
  other.id = "coordinator";
  other.role = Role::coordinator;
  other.incarnation = 5;
  other.state = LifecycleState::running;
  other.clock = seconds{100};
  statuses_.send(other);
  advance();
  EXPECT_TRUE(coordinator_->is_done());
  EXPECT_EQ(reason(), StopReason::refused);
  EXPECT_EQ(subjects(EventCode::second_coordinator).size(), 1U);
  EXPECT_TRUE(take_control().empty()) << "a stop would end the older one's test";
  TestAnnouncement announcement;
  EXPECT_FALSE(announcements_.take(announcement));
}

TEST_F(CoordinatorTest, StaysWhenSecondCoordinatorAppears) {
  make();
  start();
  ParticipantStatus other;
  other.id = "coordinator";
  other.incarnation = 5;
  other.clock = seconds{100};
  statuses_.send(other);
  advance();
  EXPECT_EQ(reason(), StopReason::none);
  answer(0, 0);
  answer(1, 0);
  advance();
  EXPECT_EQ(completed(), 1);
}

TEST_F(CoordinatorTest, IgnoresControlFromOtherSenders) {
  make();
  start();
  TestControl message;
  message.verb = ControlVerb::stop;
  message.sender = 5;
  message.sender_role = Role::coordinator;
  control_in_.send(message);
  advance();
  EXPECT_EQ(reason(), StopReason::none);
}

}  // namespace
}  // namespace hybridtest
