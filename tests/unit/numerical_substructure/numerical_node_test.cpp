#include "numerical_substructure/numerical_node.hpp"

#include <gtest/gtest.h>

#include "core/random.hpp"
#include "core/ring_port.hpp"
#include "tests/support/kept_rows.hpp"
#include "tests/support/scripted_substructure.hpp"
#include "tests/support/successor.hpp"

namespace hybridtest {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Incarnation kCoordinator = 77;
constexpr Incarnation kOwn = 5;
constexpr SubstructureIndex kIndex = 2;

/// A numerical node around a scripted spring of 100 N/m; the test plays the coordinator.
class NumericalNodeTest : public testing::Test {
 protected:
  Instant advance(Duration passed = {}) {
    now_ += passed;
    return node_.advance(now_);
  }
  void control(ControlVerb verb, StopReason reason = StopReason::none, Role role = Role::coordinator) {
    TestControl message;
    message.verb = verb;
    message.sender = role == Role::coordinator ? kCoordinator : 1234;
    message.sender_role = role;
    message.reason = reason;
    control_.send(message);
    advance();
  }
  void start() {
    TestAnnouncement announcement;
    announcement.coordinator = kCoordinator;
    announcements_.send(announcement);
    ParticipantStatus status;
    status.id = "coordinator";
    status.incarnation = kCoordinator;
    statuses_.send(status);
    advance();
    control(ControlVerb::arm);
    control(ControlVerb::start);
  }
  static DisplacementCommand command(Step step, Incarnation coordinator = kCoordinator, int dofs = 1) {
    DisplacementCommand command;
    command.substructure = kIndex;
    command.coordinator = coordinator;
    command.point_count = static_cast<std::uint8_t>(std::min<Step>(step + 1, kCommandPoints));
    for (int i = 0; i < command.point_count; ++i) {
      CommandPoint& point = command.points[static_cast<std::size_t>(i)];
      point.step = step - i;
      point.model_time_s = 0.01 * static_cast<double>(point.step);
      point.displacement_m = point.velocity_m_per_s = point.acceleration_m_per_s2 =
          InterfaceVector::Constant(dofs, static_cast<double>(step - i));
    }
    command.send_time = milliseconds{1000 + step};
    return command;
  }
  static DisplacementCommand at_iteration(DisplacementCommand command, std::uint16_t iteration) {
    command.iteration = iteration;
    return command;
  }
  static DisplacementCommand trial(Step step, std::uint16_t iteration, double displacement_m) {
    DisplacementCommand tried = at_iteration(command(step), iteration);
    tried.is_trial = true;
    tried.points[0].displacement_m = InterfaceVector::Constant(1, displacement_m);
    return tried;
  }
  void give(const DisplacementCommand& command) {
    commands_.send(command);
    advance();
  }
  LifecycleState told_state() {
    ParticipantStatus status;
    while (own_statuses_.take(status)) {
    }
    return status.state;
  }
  std::vector<ForceMeasurement> take_measurements() {
    std::vector<ForceMeasurement> taken;
    ForceMeasurement message;
    while (measurements_.take(message)) taken.push_back(message);
    return taken;
  }

  RingPort<ParticipantStatus> statuses_{64};
  RingPort<ParticipantStatus> own_statuses_{4096};
  RingPort<Event> events_{256};
  RingPort<TestAnnouncement> announcements_{4};
  RingPort<TestControl> control_{16};
  RingPort<DisplacementCommand> commands_{64};
  RingPort<ForceMeasurement> measurements_{64};
  KeptRows steps_{NumericalNode::steps_layout({"floor"})};
  Presence presence_{Identity{"model", Role::numerical_substructure, kOwn, {}}, seconds{2}, statuses_, own_statuses_,
                     events_};
  SubstructureCalls calls_;
  NumericalNode node_{kIndex,
                      CouplingMode::lockstep,
                      std::make_unique<ScriptedSubstructure>(1, linear_spring(100.0), calls_),
                      presence_,
                      MembershipPorts{announcements_, control_, seconds{30}},
                      commands_,
                      measurements_,
                      steps_,
                      {0}};
  Instant now_{};
};

/// Nothing else may wake it before its next heartbeat.
TEST_F(NumericalNodeTest, TellsANewStateBeforeItSleeps) {
  TestAnnouncement announcement;
  announcement.coordinator = kCoordinator;
  announcements_.send(announcement);
  advance();
  EXPECT_EQ(told_state(), LifecycleState::ready);
  control(ControlVerb::arm);
  EXPECT_EQ(told_state(), LifecycleState::armed);
}

TEST_F(NumericalNodeTest, AnswersACommandWithTheForceOfItsModel) {
  start();
  EXPECT_EQ(presence_.state(), LifecycleState::running);
  EXPECT_EQ(calls_.resets, 1);
  advance(milliseconds{10});
  give(command(0));
  give(command(1));
  const auto measurements = take_measurements();
  ASSERT_EQ(measurements.size(), 2U);
  EXPECT_EQ(measurements[1].substructure, kIndex);
  EXPECT_EQ(measurements[1].sender, kOwn);
  EXPECT_EQ(measurements[1].step, 1);
  EXPECT_EQ(measurements[1].force_n[0], 100.0);
  EXPECT_EQ(measurements[1].imposed_displacement_m[0], 1.0);
  EXPECT_EQ(measurements[1].flags, MeasurementFlags::none);
  EXPECT_EQ(measurements[1].command_send_time, milliseconds{1001});
  EXPECT_EQ(measurements[1].receive_time, milliseconds{10});
  ASSERT_EQ(steps_.size(), 2U);
  EXPECT_EQ(steps_.at(1, steps_.column("step")), 1.0);
  EXPECT_EQ(steps_.at(1, steps_.column("model_time_s")), 0.01);
  EXPECT_EQ(steps_.at(1, steps_.column("displacement_floor_m")), 1.0);
  EXPECT_EQ(steps_.at(1, steps_.column("force_floor_n")), 100.0);
}

TEST_F(NumericalNodeTest, RepeatedCommandDoesNotChangeTheModel) {
  start();
  give(command(0));
  give(command(1));
  take_measurements();
  DisplacementCommand repeated = command(1);
  repeated.send_time = milliseconds{1200};
  give(repeated);
  give(command(0));  // a late copy
  EXPECT_EQ(calls_.trials, 2);
  EXPECT_EQ(calls_.commits, 2);
  const auto measurements = take_measurements();
  ASSERT_EQ(measurements.size(), 1U);
  EXPECT_EQ(measurements[0].step, 1);
  EXPECT_EQ(measurements[0].force_n[0], 100.0);
  EXPECT_EQ(measurements[0].flags, MeasurementFlags::repeated);
  EXPECT_EQ(measurements[0].command_send_time, milliseconds{1200});
  EXPECT_EQ(steps_.size(), 2U);
}

TEST_F(NumericalNodeTest, RecoversLostStepsFromNextCommand) {
  start();
  give(command(0));
  give(command(4));
  ASSERT_EQ(calls_.committed_m.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(calls_.committed_m[i][0], static_cast<double>(i));
  give(command(9));
  EXPECT_EQ(calls_.commits, 5) << "5 is in no command any more; its history cannot be skipped";
  EXPECT_EQ(take_measurements().size(), 2U);
}

TEST_F(NumericalNodeTest, TakesEachStepOnceUnderNetworkFaults) {
  start();
  Random random{3};
  Step newest = 0;
  for (int i = 0; i < 5000; ++i) {
    // Mostly near the newest, copies and old ones among them, up to three lost.
    const Step step = std::max<Step>(0, newest - 3 + static_cast<Step>(random.below(8)));
    if (step > newest + kCommandPoints) continue;
    give(command(step));
    newest = std::max(newest, std::min(step, newest + kCommandPoints));
    take_measurements();
  }
  ASSERT_EQ(calls_.commits, newest + 1);
  EXPECT_EQ(calls_.trials, calls_.commits);
  EXPECT_EQ(calls_.reverts, 0);
  for (std::size_t i = 0; i < calls_.committed_m.size(); ++i) {
    ASSERT_EQ(calls_.committed_m[i][0], static_cast<double>(i));
  }
}

TEST_F(NumericalNodeTest, TrialIsAnsweredAndNotKept) {
  start();
  give(command(0));
  give(trial(1, 0, 5.0));
  EXPECT_EQ(calls_.trials, 2);
  EXPECT_EQ(calls_.commits, 1);
  EXPECT_EQ(presence_.own_status().last_step, 0);
  auto measurements = take_measurements();
  ASSERT_EQ(measurements.size(), 2U);
  EXPECT_EQ(measurements[1].step, 1);
  EXPECT_EQ(measurements[1].iteration, 0);
  EXPECT_EQ(measurements[1].force_n[0], 500.0);
  give(trial(1, 1, 6.0));
  EXPECT_EQ(calls_.reverts, 1) << "from the state at the end of the step before";
  give(at_iteration(command(1), 2));
  EXPECT_EQ(calls_.reverts, 2);
  EXPECT_EQ(calls_.commits, 2);
  EXPECT_EQ(calls_.committed_m.back()[0], 1.0);
  measurements = take_measurements();
  ASSERT_EQ(measurements.size(), 2U);
  EXPECT_EQ(measurements[0].iteration, 1);
  EXPECT_EQ(measurements[1].iteration, 2);
  EXPECT_EQ(measurements[1].force_n[0], 100.0);
  EXPECT_EQ(steps_.size(), 2U) << "a trial is no step";
}

TEST_F(NumericalNodeTest, RepeatedTrialIsAnsweredWithoutAnother) {
  start();
  give(command(0));
  give(trial(1, 0, 5.0));
  give(trial(1, 1, 6.0));
  take_measurements();
  give(trial(1, 1, 6.0));
  give(trial(1, 0, 5.0));  // a late copy
  EXPECT_EQ(calls_.trials, 3);
  const auto measurements = take_measurements();
  ASSERT_EQ(measurements.size(), 1U);
  EXPECT_EQ(measurements[0].iteration, 1);
  EXPECT_EQ(measurements[0].force_n[0], 600.0);
  EXPECT_EQ(measurements[0].flags, MeasurementFlags::repeated);
}

TEST_F(NumericalNodeTest, IgnoresTrialsOfAStepThatIsTaken) {
  start();
  give(command(0));
  give(at_iteration(command(1), 2));
  take_measurements();
  give(trial(1, 1, 5.0));  // late
  give(trial(1, 3, 5.0));  // was never asked for
  give(trial(3, 0, 5.0));  // step 2 is in its history and is taken; that of step 3 is tried
  EXPECT_EQ(calls_.commits, 3);
  EXPECT_EQ(calls_.committed_m.back()[0], 2.0);
  const auto measurements = take_measurements();
  ASSERT_EQ(measurements.size(), 1U);
  EXPECT_EQ(measurements[0].step, 3);
}

TEST_F(NumericalNodeTest, TriesAndTakesInOrderUnderNetworkFaults) {
  start();
  Random random{5};
  give(command(0));
  constexpr Step kSteps = 300;
  for (Step step = 1; step <= kSteps; ++step) {
    const auto trials = static_cast<std::uint16_t>(random.below(4));
    for (std::uint16_t iteration = 0; iteration <= trials; ++iteration) {
      const bool is_final = iteration == trials;
      const DisplacementCommand asked =
          is_final ? at_iteration(command(step), iteration) : trial(step, iteration, 1000.0 + iteration);
      // The coordinator waits for the answer; copies of this one and of earlier ones come in any order and number.
      bool is_answered = false;
      while (!is_answered) {
        if (random.below(2) == 0) give(asked);
        if (iteration > 0 && random.below(3) == 0) {
          give(trial(step, static_cast<std::uint16_t>(random.below(iteration)), 7.0));
        }
        if (random.below(3) == 0) give(command(step - 1));
        for (const ForceMeasurement& measurement : take_measurements()) {
          const bool is_this = measurement.step == step && measurement.iteration == iteration;
          is_answered = is_answered || is_this;
        }
      }
    }
  }
  ASSERT_EQ(calls_.commits, kSteps + 1);
  for (std::size_t i = 0; i < calls_.committed_m.size(); ++i) {
    ASSERT_EQ(calls_.committed_m[i][0], static_cast<double>(i));
  }
}

TEST_F(NumericalNodeTest, IgnoresForeignCommandsAndWrongSizes) {
  start();
  give(command(0, kCoordinator + 1));
  give(command(0, kCoordinator, 2));
  EXPECT_EQ(calls_.trials, 0);
  EXPECT_TRUE(take_measurements().empty());
}

TEST_F(NumericalNodeTest, IgnoresCommandsBeforeArming) {
  give(command(0, 0));
  EXPECT_EQ(calls_.trials, 0);
}

TEST_F(NumericalNodeTest, AnswersCommandThatArrivesBeforeStart) {
  TestAnnouncement announcement;
  announcement.coordinator = kCoordinator;
  announcements_.send(announcement);
  advance();
  control(ControlVerb::arm);
  EXPECT_EQ(presence_.state(), LifecycleState::armed);
  give(command(0));
  EXPECT_EQ(presence_.state(), LifecycleState::running);
  EXPECT_EQ(take_measurements().size(), 1U);
}

TEST_F(NumericalNodeTest, LeavesWhenItIsStopped) {
  start();
  control(ControlVerb::stop, StopReason::completed);
  EXPECT_TRUE(node_.is_done());
  EXPECT_EQ(node_.stop_reason(), StopReason::completed);
  ParticipantStatus status;
  while (own_statuses_.take(status)) {
  }
  EXPECT_EQ(status.state, LifecycleState::finished) << "the last word goes out";
  give(command(0));
  EXPECT_EQ(calls_.trials, 0);
}

TEST_F(NumericalNodeTest, LeavesWhenTheCoordinatorIsLost) {
  start();
  advance(seconds{2});
  EXPECT_TRUE(node_.is_done());
  EXPECT_EQ(node_.stop_reason(), StopReason::coordinator_lost);
}

TEST_F(NumericalNodeTest, LeavesOnRequestWithReason) {
  start();
  node_.request_stop(StopReason::interrupted);
  EXPECT_EQ(advance(), kNever);
  EXPECT_TRUE(node_.is_done());
  EXPECT_EQ(node_.stop_reason(), StopReason::interrupted);
}

/// A node of its own state, whose model of 100 N/m counts its calls.
class RestoredNodeTest : public NumericalNodeTest {
 protected:
  static CommandPoint point(Step step) { return command(step).points[0]; }
  static InterfaceVector force(Step step) { return InterfaceVector::Constant(1, 100.0 * static_cast<double>(step)); }
  void join_resumed() {
    announce_successor(announcements_, statuses_, kCoordinator);
    run();
    for (const ControlVerb verb : {ControlVerb::arm, ControlVerb::start}) {
      TestControl message;
      message.verb = verb;
      message.sender = kSuccessor;
      message.sender_role = Role::coordinator;
      control_.send(message);
      run();
    }
  }
  void run() { static_cast<void>(restored_.advance(now_)); }

  SubstructureCalls restored_calls_;
  NumericalNode restored_{kIndex,
                          CouplingMode::lockstep,
                          std::make_unique<ScriptedSubstructure>(1, linear_spring(100.0), restored_calls_),
                          presence_,
                          MembershipPorts{announcements_, control_, seconds{30}, seconds{10}, true},
                          commands_,
                          measurements_,
                          steps_,
                          {0},
                          8};
};

TEST_F(RestoredNodeTest, ProvesItsStateByTheRecordedForces) {
  for (Step step = 0; step < 5; ++step) {
    EXPECT_EQ(restored_.restore(point(step), 0, force(step)), NumericalNode::Restored::same);
  }
  EXPECT_EQ(restored_.restore(point(5), 0, InterfaceVector::Constant(1, 500.0000000001)),
            NumericalNode::Restored::different);
  EXPECT_EQ(restored_calls_.commits, 6);
  EXPECT_EQ(steps_.size(), 6U) << "its recording has them too";
}

TEST_F(RestoredNodeTest, GoesOnFromItsRestoredState) {
  for (Step step = 0; step < 5; ++step) static_cast<void>(restored_.restore(point(step), 0, force(step)));
  join_resumed();
  EXPECT_EQ(presence_.state(), LifecycleState::running);
  EXPECT_EQ(restored_calls_.resets, 1) << "arming must not take the state away";
  commands_.send(command(3, kSuccessor));  // the coordinator has lost it
  commands_.send(command(5, kSuccessor));
  run();
  EXPECT_EQ(restored_calls_.commits, 6);
  const auto measurements = take_measurements();
  ASSERT_EQ(measurements.size(), 2U);
  EXPECT_EQ(measurements[0].step, 3);
  EXPECT_EQ(measurements[0].force_n[0], 300.0);
  EXPECT_EQ(measurements[0].flags, MeasurementFlags::repeated);
  EXPECT_EQ(measurements[1].step, 5);
  EXPECT_EQ(measurements[1].force_n[0], 500.0);
}

TEST_F(RestoredNodeTest, RefusesAnotherDisplacementOfAStepItTook) {
  for (Step step = 0; step < 5; ++step) static_cast<void>(restored_.restore(point(step), 0, force(step)));
  join_resumed();
  DisplacementCommand other = command(4, kSuccessor);
  other.points[0].displacement_m[0] = 4.5;
  commands_.send(other);
  run();
  EXPECT_TRUE(take_measurements().empty());
  EXPECT_TRUE(any(presence_.faults() & FaultFlags::resume_refused));
  EXPECT_EQ(restored_.stop_reason(), StopReason::resume_refused);
}

}  // namespace
}  // namespace hybridtest
