#include "experimental_site/site_link.hpp"

#include <gtest/gtest.h>

#include "core/ring_port.hpp"
#include "tests/support/kept_rows.hpp"
#include "tests/support/successor.hpp"

namespace hybridtest {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Incarnation kCoordinator = 77;
constexpr Incarnation kOwn = 5;
constexpr SubstructureIndex kIndex = 3;

/// The link of a site with one degree of freedom; the test plays the coordinator and the loop.
class SiteLinkTest : public testing::Test {
 protected:
  Instant advance(Duration passed = {}) {
    now_ += passed;
    return link_.advance(now_);
  }
  void coordinator_is(LifecycleState state) {
    ParticipantStatus status;
    status.id = "coordinator";
    status.role = Role::coordinator;
    status.incarnation = kCoordinator;
    status.state = state;
    statuses_.send(status);
  }
  void control(ControlVerb verb, StopReason reason = StopReason::none, Role role = Role::coordinator) {
    TestControl message;
    message.verb = verb;
    message.sender = role == Role::coordinator ? kCoordinator : 1234;
    message.sender_role = role;
    message.reason = reason;
    control_.send(message);
  }
  void join() {
    TestAnnouncement announcement;
    announcement.coordinator = kCoordinator;
    announcements_.send(announcement);
    coordinator_is(LifecycleState::running);
    advance();
  }
  void loop_says(const LoopReport& report) { reports_.send(report); }
  void loop_measured(Step step, double force_n, MeasurementFlags flags = MeasurementFlags::none) {
    StepMeasurement measurement;
    measurement.step = step;
    measurement.model_time_s = 0.01 * static_cast<double>(step);
    measurement.target_displacement_m = SiteVector::Constant(1, 1.0 * static_cast<double>(step));
    measurement.imposed_displacement_m = SiteVector::Constant(1, 1.1 * static_cast<double>(step));
    measurement.measured_displacement_m = SiteVector::Constant(1, 1.2 * static_cast<double>(step));
    measurement.force_n = SiteVector::Constant(1, force_n);
    measurement.flags = flags;
    reports_.send(measurement);
  }
  void start() {
    join();
    control(ControlVerb::arm);
    advance();
    loop_says(loop_report::Armed{});
    advance();
    control(ControlVerb::start);
    advance();
    take_requests();
  }
  /// A command for `step` with as many points before it as fit.
  static DisplacementCommand command(Step step, Incarnation coordinator = kCoordinator, int dofs = 1) {
    DisplacementCommand command;
    command.substructure = kIndex;
    command.coordinator = coordinator;
    command.point_count = static_cast<std::uint8_t>(std::min<Step>(step + 1, kCommandPoints));
    for (int i = 0; i < command.point_count; ++i) {
      CommandPoint& point = command.points[static_cast<std::size_t>(i)];
      point.step = step - i;
      point.displacement_m = point.velocity_m_per_s = point.acceleration_m_per_s2 =
          InterfaceVector::Constant(dofs, static_cast<double>(step - i));
    }
    command.send_time = milliseconds{1000 + step};
    return command;
  }
  std::vector<LoopRequest> take_requests() { return take_all(requests_); }
  std::vector<Step> take_targets() {
    std::vector<Step> steps;
    for (const LoopRequest& request : take_requests()) {
      const TargetPoint& point = std::get<loop_request::Target>(request).point;
      EXPECT_EQ(point.displacement_m[0], static_cast<double>(point.step));
      steps.push_back(point.step);
    }
    return steps;
  }
  std::vector<ForceMeasurement> take_measurements() { return take_all(measurements_); }
  std::vector<Event> take_events() { return take_all(events_); }
  template <class Message>
  static std::vector<Message> take_all(RingPort<Message>& port) {
    std::vector<Message> taken;
    Message message;
    while (port.take(message)) taken.push_back(message);
    return taken;
  }

  RingPort<ParticipantStatus> statuses_{64};
  RingPort<ParticipantStatus> own_statuses_{256};
  RingPort<Event> events_{256};
  RingPort<TestAnnouncement> announcements_{4};
  RingPort<TestControl> control_{16};
  RingPort<DisplacementCommand> commands_{64};
  RingPort<ForceMeasurement> measurements_{64};
  RingPort<LoopRequest> requests_{64};
  RingPort<LoopReport> reports_{64};
  KeptRows steps_{SiteLink::steps_layout(1)};
  Presence presence_{Identity{"site", Role::experimental_site, kOwn, {}}, seconds{2}, statuses_, own_statuses_,
                     events_};
  SiteLink link_{kIndex,
                 1,
                 CouplingMode::paced,
                 presence_,
                 MembershipPorts{announcements_, control_, seconds{30}},
                 SiteLinkPorts{commands_, measurements_, requests_, reports_},
                 steps_};
  Instant now_{};
};

TEST_F(SiteLinkTest, IsArmedWhenItsLoopIsArmed) {
  join();
  EXPECT_EQ(presence_.state(), LifecycleState::ready);
  control(ControlVerb::arm);
  advance();
  const auto requests = take_requests();
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_TRUE(std::holds_alternative<loop_request::Arm>(requests[0]));
  EXPECT_EQ(presence_.state(), LifecycleState::ready);
  loop_says(loop_report::Armed{});
  advance();
  EXPECT_EQ(presence_.state(), LifecycleState::armed);
}

/// Nothing else may wake it before its next heartbeat.
TEST_F(SiteLinkTest, TellsANewStateBeforeItSleeps) {
  join();
  EXPECT_EQ(take_all(own_statuses_).back().state, LifecycleState::ready);
  loop_says(loop_report::Armed{});
  advance();
  EXPECT_EQ(take_all(own_statuses_).back().state, LifecycleState::armed);
}

TEST_F(SiteLinkTest, LoopThatCannotArmIsAFault) {
  join();
  control(ControlVerb::arm);
  advance();
  take_events();
  loop_says(loop_report::ArmFailed{});
  advance();
  EXPECT_EQ(presence_.state(), LifecycleState::ready);
  EXPECT_EQ(presence_.faults(), FaultFlags::rig_fault);
  const auto events = take_events();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].code, EventCode::interlock_tripped);
}

TEST_F(SiteLinkTest, PassesEachTargetOnceInOrder) {
  start();
  for (const Step step : {0, 1, 1, 0, 2, 1, 2}) commands_.send(command(step));
  advance();
  EXPECT_EQ(take_targets(), (std::vector<Step>{0, 1, 2}));
}

TEST_F(SiteLinkTest, RecoversLostTargetsFromNextCommand) {
  start();
  commands_.send(command(0));
  commands_.send(command(4));  // 1, 2 and 3 were lost
  advance();
  EXPECT_EQ(take_targets(), (std::vector<Step>{0, 1, 2, 3, 4}));
  commands_.send(command(9));  // 5 is in no command any more: a gap would be a jump
  advance();
  EXPECT_TRUE(take_targets().empty());
}

TEST_F(SiteLinkTest, CommandBeforeStartStartsTheLoop) {
  join();
  control(ControlVerb::arm);
  advance();
  loop_says(loop_report::Armed{});
  advance();
  take_requests();
  commands_.send(command(0));
  advance();
  const auto requests = take_requests();
  ASSERT_EQ(requests.size(), 2U);
  EXPECT_TRUE(std::holds_alternative<loop_request::Start>(requests[0]));
  EXPECT_TRUE(std::holds_alternative<loop_request::Target>(requests[1]));
  EXPECT_EQ(presence_.state(), LifecycleState::running);
}

TEST_F(SiteLinkTest, IgnoresCommandsUnarmedForeignOrOfWrongSize) {
  join();
  commands_.send(command(0));
  advance();
  EXPECT_TRUE(take_requests().empty());
  start();
  commands_.send(command(0, kCoordinator + 1));
  commands_.send(command(0, kCoordinator, 2));
  advance();
  EXPECT_TRUE(take_requests().empty());
}

TEST_F(SiteLinkTest, AnswersWithMeasurementOfTheLoop) {
  start();
  commands_.send(command(0));
  advance(milliseconds{10});
  EXPECT_TRUE(take_measurements().empty());
  loop_measured(0, 42.0, MeasurementFlags::saturated);
  advance(milliseconds{5});
  const auto measurements = take_measurements();
  ASSERT_EQ(measurements.size(), 1U);
  EXPECT_EQ(measurements[0].substructure, kIndex);
  EXPECT_EQ(measurements[0].sender, kOwn);
  EXPECT_EQ(measurements[0].step, 0);
  EXPECT_EQ(measurements[0].force_n[0], 42.0);
  EXPECT_EQ(measurements[0].flags, MeasurementFlags::saturated);
  EXPECT_EQ(measurements[0].command_send_time, milliseconds{1000});
  EXPECT_EQ(measurements[0].receive_time, milliseconds{10});
  EXPECT_EQ(measurements[0].send_time, milliseconds{15});
  ASSERT_EQ(steps_.size(), 1U);
  EXPECT_EQ(steps_.at(0, steps_.column("measured_force_n")), 42.0);
  EXPECT_EQ(steps_.at(0, steps_.column("flags")), static_cast<double>(MeasurementFlags::saturated));
}

TEST_F(SiteLinkTest, AnswersRepeatedCommandFromMemory) {
  start();
  commands_.send(command(0));
  advance();
  commands_.send(command(0));
  advance();
  EXPECT_EQ(take_targets(), (std::vector<Step>{0}));
  EXPECT_TRUE(take_measurements().empty()) << "not measured yet";
  loop_measured(0, 42.0);
  advance();
  ASSERT_EQ(take_measurements().size(), 1U);
  DisplacementCommand repeated = command(0);
  repeated.attempt = 1;
  repeated.send_time = milliseconds{1200};
  commands_.send(repeated);
  advance();
  EXPECT_TRUE(take_targets().empty());
  const auto measurements = take_measurements();
  ASSERT_EQ(measurements.size(), 1U);
  EXPECT_EQ(measurements[0].force_n[0], 42.0);
  EXPECT_EQ(measurements[0].flags, MeasurementFlags::repeated);
  EXPECT_EQ(measurements[0].command_send_time, milliseconds{1200});
  EXPECT_EQ(steps_.size(), 1U);
}

TEST_F(SiteLinkTest, CopiesMoveOnceAndAnswerTellsFirstTimes) {
  start();
  constexpr int kCopies = 6;
  const auto copy_of = [](Step step, int number) {
    DisplacementCommand copy = command(step);
    copy.attempt = static_cast<std::uint16_t>(number);
    copy.send_time += milliseconds{2 * number};
    return copy;
  };
  for (Step step = 0; step < 3; ++step) {
    // The first copy is lost; the others are out of order, and one comes twice, after a copy of the step before.
    if (step > 0) commands_.send(copy_of(step - 1, 5));
    for (const int number : {2, 1, 1, 3, 5, 4}) {
      commands_.send(copy_of(step, number));
      advance(milliseconds{1});
    }
    EXPECT_EQ(take_targets(), std::vector<Step>{step});
    take_measurements();  // to the copy of the step before
    loop_measured(step, 42.0 + static_cast<double>(step));
    const Duration first_came = (now_ - milliseconds{kCopies - 1}).time_since_epoch();
    advance(milliseconds{5});
    const auto measurements = take_measurements();
    ASSERT_EQ(measurements.size(), 1U);
    EXPECT_EQ(measurements[0].step, step);
    EXPECT_EQ(measurements[0].command_send_time, copy_of(step, 2).send_time);
    EXPECT_EQ(measurements[0].receive_time, first_came);
  }
  EXPECT_EQ(steps_.size(), 3U);
}

TEST_F(SiteLinkTest, ReportsFaultOfTheLoop) {
  start();
  take_events();
  loop_says(loop_report::Fault{FaultFlags::force_limit, 2.0, 1.0});
  loop_says(loop_report::Fault{FaultFlags::command_age, 2.0, 1.0});
  advance();
  EXPECT_EQ(presence_.faults(), FaultFlags::force_limit | FaultFlags::command_age);
  const auto events = take_events();
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].code, EventCode::interlock_tripped);
  EXPECT_EQ(events[0].severity, Severity::fault);
  EXPECT_EQ(events[0].subject, "force_limit");
  EXPECT_EQ(events[0].values, (std::array<double, 2>{2.0, 1.0}));
  EXPECT_EQ(events[1].code, EventCode::command_overdue);
}

TEST_F(SiteLinkTest, IsFinishedWhenTheRigIsAtRest) {
  start();
  control(ControlVerb::stop, StopReason::completed);
  advance();
  const auto requests = take_requests();
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_TRUE(std::holds_alternative<loop_request::Stop>(requests[0]));
  EXPECT_EQ(presence_.state(), LifecycleState::stopping);
  control(ControlVerb::stop, StopReason::completed);
  advance();
  EXPECT_TRUE(take_requests().empty()) << "a repeated stop is the same stop";
  loop_says(loop_report::AtRest{});
  EXPECT_EQ(advance(), kNever);
  EXPECT_TRUE(link_.is_done());
  EXPECT_EQ(link_.stop_reason(), StopReason::completed);
  EXPECT_EQ(take_all(own_statuses_).back().state, LifecycleState::finished);
}

TEST_F(SiteLinkTest, RecordsMeasurementsWhileStoppingWithoutSending) {
  start();
  commands_.send(command(0));
  advance();
  control(ControlVerb::stop, StopReason::interrupted);
  advance();
  loop_measured(0, 42.0);
  advance();
  EXPECT_TRUE(take_measurements().empty());
  EXPECT_EQ(steps_.size(), 1U);
}

TEST_F(SiteLinkTest, StopsWhenTheCoordinatorIsLost) {
  start();
  advance(milliseconds{1999});
  EXPECT_TRUE(take_requests().empty());
  advance(milliseconds{1});
  const auto requests = take_requests();
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_TRUE(std::holds_alternative<loop_request::Stop>(requests[0]));
  EXPECT_EQ(link_.stop_reason(), StopReason::coordinator_lost);
}

TEST_F(SiteLinkTest, StopsOnRequest) {
  start();
  link_.request_stop(StopReason::interrupted);
  advance();
  const auto requests = take_requests();
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_TRUE(std::holds_alternative<loop_request::Stop>(requests[0]));
  EXPECT_EQ(link_.stop_reason(), StopReason::interrupted);
}

TEST_F(SiteLinkTest, PassesEmergencyStopToLoopFirst) {
  start();
  control(ControlVerb::emergency_stop, StopReason::none, Role::operator_tool);
  advance();
  const auto requests = take_requests();
  ASSERT_GE(requests.size(), 1U);
  EXPECT_TRUE(std::holds_alternative<loop_request::EmergencyStop>(requests[0]));
  EXPECT_EQ(link_.stop_reason(), StopReason::emergency_stop);
  EXPECT_EQ(presence_.faults(), FaultFlags::emergency_stop);
}

TEST_F(SiteLinkTest, PassesPauseAndResume) {
  start();
  control(ControlVerb::pause, StopReason::none, Role::operator_tool);
  control(ControlVerb::resume, StopReason::none, Role::operator_tool);
  advance();
  const auto requests = take_requests();
  ASSERT_EQ(requests.size(), 2U);
  EXPECT_TRUE(std::holds_alternative<loop_request::Pause>(requests[0]));
  EXPECT_TRUE(std::holds_alternative<loop_request::Resume>(requests[1]));
}

/// Reaches every target at once.
class PromptLoop final : public Node {
 public:
  PromptLoop(Inbox<LoopRequest>& requests, Outbox<LoopReport>& reports) : requests_{requests}, reports_{reports} {}

  Instant advance(Instant) noexcept override {
    ++runs;
    LoopRequest request;
    while (requests_.take(request)) {
      const auto* target = std::get_if<loop_request::Target>(&request);
      if (target == nullptr) continue;
      const SiteVector& reached_m = target->point.displacement_m;
      reports_.send(StepMeasurement{.step = target->point.step,
                                    .model_time_s = 0.0,
                                    .target_displacement_m = reached_m,
                                    .imposed_displacement_m = reached_m,
                                    .measured_displacement_m = reached_m,
                                    .force_n = reached_m,
                                    .flags = MeasurementFlags::none});
    }
    return kNever;
  }

  int runs = 0;

 private:
  Inbox<LoopRequest>& requests_;
  Outbox<LoopReport>& reports_;
};

TEST_F(SiteLinkTest, SiteNodeAnswersCommandInOneRun) {
  start();
  PromptLoop loop{requests_, reports_};
  SiteNode node{link_, loop};
  commands_.send(command(0));
  static_cast<void>(node.advance(now_));
  EXPECT_EQ(loop.runs, 1);
  EXPECT_EQ(take_measurements().size(), 1U);
}

TEST_F(SiteLinkTest, LinkAloneDoesNotAnswerBeforeLoopRuns) {  // control of the test before
  start();
  PromptLoop loop{requests_, reports_};
  commands_.send(command(0));
  advance();
  static_cast<void>(loop.advance(now_));
  EXPECT_TRUE(take_measurements().empty());
  advance();
  EXPECT_EQ(take_measurements().size(), 1U);
}

TEST_F(SiteLinkTest, SendsChangedStateInSameRun) {
  join();
  control(ControlVerb::arm);
  advance();
  loop_says(loop_report::Armed{});
  advance();
  take_all(own_statuses_);
  control(ControlVerb::start);
  advance();
  const auto statuses = take_all(own_statuses_);
  ASSERT_FALSE(statuses.empty());
  EXPECT_EQ(statuses.back().state, LifecycleState::running);
}

/// A link that waits for a resumed coordinator; its own is lost after the steps 0 to `last`, which is not measured yet.
class ResumedLinkTest : public SiteLinkTest {
 protected:
  Instant run(Duration passed = {}) {
    now_ += passed;
    return patient_.advance(now_);
  }
  void lose_coordinator(Step last = 5) {
    TestAnnouncement announcement;
    announcement.coordinator = kCoordinator;
    announcements_.send(announcement);
    coordinator_is(LifecycleState::running);
    run();
    control(ControlVerb::arm);
    run();
    loop_says(loop_report::Armed{});
    run();
    for (Step step = 0; step <= last; ++step) {
      commands_.send(command(step));
      run();
      if (step < last) loop_measured(step, 10.0 * static_cast<double>(step));
      run();
      take_requests();
      take_measurements();
    }
    run(seconds{2});
    ASSERT_EQ(presence_.state(), LifecycleState::waiting);
  }
  void be_succeeded() {
    announce_successor(announcements_, statuses_, kCoordinator);
    run();
    take_requests();
    ASSERT_EQ(presence_.state(), LifecycleState::armed);
    take_events();
  }

  SiteLink patient_{kIndex,
                    1,
                    CouplingMode::paced,
                    presence_,
                    MembershipPorts{announcements_, control_, seconds{30}, seconds{10}},
                    SiteLinkPorts{commands_, measurements_, requests_, reports_},
                    steps_,
                    8};
};

TEST_F(ResumedLinkTest, PausesItsLoopWhileItWaits) {
  lose_coordinator();
  const auto requests = take_requests();
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_TRUE(std::holds_alternative<loop_request::Pause>(requests[0]));
}

TEST_F(ResumedLinkTest, AnswersRepeatedStepsWithoutMotion) {
  lose_coordinator();
  be_succeeded();
  for (Step step = 2; step <= 4; ++step) {
    commands_.send(command(step, kSuccessor));
    run();
    const auto measurements = take_measurements();
    ASSERT_EQ(measurements.size(), 1U) << step;
    EXPECT_EQ(measurements[0].step, step);
    EXPECT_EQ(measurements[0].force_n[0], 10.0 * static_cast<double>(step));
    EXPECT_EQ(measurements[0].imposed_displacement_m[0], 1.1 * static_cast<double>(step));
    EXPECT_EQ(measurements[0].flags, MeasurementFlags::repeated);
    EXPECT_EQ(measurements[0].command_send_time, milliseconds{1000 + step});
  }
  const auto requests = take_requests();
  ASSERT_EQ(requests.size(), 1U) << "no target";
  EXPECT_TRUE(std::holds_alternative<loop_request::Resume>(requests[0]));
  EXPECT_EQ(presence_.state(), LifecycleState::running);
}

TEST_F(ResumedLinkTest, StepInProgressIsAnsweredWhenMeasured) {
  lose_coordinator();
  be_succeeded();
  commands_.send(command(5, kSuccessor));
  run();
  EXPECT_TRUE(take_measurements().empty());
  loop_measured(5, 50.0);
  run();
  ASSERT_EQ(take_measurements().size(), 1U);
  take_requests();
  commands_.send(command(6, kSuccessor));
  run();
  EXPECT_EQ(take_targets(), (std::vector<Step>{6}));
}

TEST_F(ResumedLinkTest, EndsTheTestForAnotherDisplacement) {
  lose_coordinator();
  be_succeeded();
  DisplacementCommand other = command(4, kSuccessor);
  other.points[0].displacement_m[0] = 4.0625;
  other.points[0].model_time_s = 0.04;
  commands_.send(other);
  run();
  EXPECT_TRUE(take_measurements().empty());
  EXPECT_TRUE(any(presence_.faults() & FaultFlags::resume_refused));
  EXPECT_EQ(patient_.stop_reason(), StopReason::resume_refused);
  const auto events = take_events();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].code, EventCode::imposed_differently);
  EXPECT_EQ(events[0].values, (std::array{4.0, 4.0625}));
  EXPECT_EQ(events[0].step, 4) << "the one that was asked for, not the newest";
  EXPECT_EQ(events[0].model_time_s, 0.04);
}

TEST_F(ResumedLinkTest, EndsTheTestForAStepThatItForgot) {
  lose_coordinator(20);
  be_succeeded();
  commands_.send(command(12, kSuccessor));  // of the steps to 20 it keeps 8
  run();
  EXPECT_TRUE(take_measurements().empty());
  EXPECT_EQ(patient_.stop_reason(), StopReason::resume_refused);
  const auto events = take_events();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].code, EventCode::answer_forgotten);
  EXPECT_EQ(events[0].values, (std::array{13.0, 12.0}));
  EXPECT_EQ(events[0].step, 12);
}

TEST_F(ResumedLinkTest, NewStepAfterAnotherHistoryIsRefused) {
  lose_coordinator();
  be_succeeded();
  DisplacementCommand other = command(6, kSuccessor);
  other.points[1].displacement_m[0] = 5.5;  // of step 5, which is imposed as 5
  commands_.send(other);
  run();
  EXPECT_TRUE(std::ranges::none_of(take_requests(), [](const LoopRequest& request) {
    return std::holds_alternative<loop_request::Target>(request);
  }));
  EXPECT_EQ(patient_.stop_reason(), StopReason::resume_refused);
}

}  // namespace
}  // namespace hybridtest
