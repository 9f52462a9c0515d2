#include "numerical_substructure/opensees/opensees_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <deque>

#include "core/config_error.hpp"
#include "core/ring_port.hpp"
#include "numerical_substructure/numerical_node.hpp"
#include "tests/support/kept_rows.hpp"

namespace hybridtest {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// What the stand-in for OpenSees was asked, and what it answers.
struct DriverScript {
  std::vector<std::pair<DriverRequest, std::vector<double>>> asked;
  std::deque<DriverReply> replies;
  bool has_ended = false;
  int starts = 0;
};

DriverReply reply_of(DriverReply::Kind kind) {
  DriverReply reply;
  reply.kind = kind;
  reply.forces = {0.0};
  return reply;
}

DriverReply forces(std::vector<double> values) {
  DriverReply reply = reply_of(DriverReply::Kind::forces);
  reply.forces = std::move(values);
  return reply;
}

class ScriptedDriver final : public DriverChannel {
 public:
  explicit ScriptedDriver(DriverScript& script) : script_{script} { ++script_.starts; }
  bool send(DriverRequest request, std::span<const double> displacements) noexcept override {
    script_.asked.emplace_back(request, std::vector<double>{displacements.begin(), displacements.end()});
    return !script_.has_ended;
  }
  DriverArrival take(DriverReply& reply, Duration) noexcept override {
    if (!is_ready_) {
      is_ready_ = true;
      reply = reply_of(DriverReply::Kind::ready);
      return DriverArrival::reply;
    }
    if (script_.has_ended) return DriverArrival::ended;
    if (script_.replies.empty()) return DriverArrival::none;
    reply = script_.replies.front();
    script_.replies.pop_front();
    return DriverArrival::reply;
  }
  int exit_code() noexcept override { return 137; }
  [[nodiscard]] std::string last_words() const override { return "; last words"; }

 private:
  DriverScript& script_;
  bool is_ready_ = false;
};

OpenSeesSettings pending_settings() {
  OpenSeesSettings settings;
  settings.script = "frame.tcl";
  settings.interface = {{3, 1}};
  settings.length_unit_m = 0.001;
  settings.force_unit_n = 1000.0;
  settings.answer_timeout = seconds{5};
  return settings;
}

/// A node whose model answers when the test says so; the test plays the coordinator.
class PendingModel : public testing::Test {
 protected:
  static constexpr Incarnation kLeader = 77;

  PendingModel() {
    auto model = std::make_unique<OpenSeesModel>(
        pending_settings(), [this](const ModelSurroundings&) { return std::make_unique<ScriptedDriver>(driver_); });
    model->start({.log = {}, .wake = [] {}});
    node_.emplace(0, CouplingMode::lockstep, std::move(model), presence_,
                  MembershipPorts{announcements_, control_, seconds{30}}, commands_, measurements_, steps_,
                  std::vector<Eigen::Index>{0});
    TestAnnouncement announcement;
    announcement.coordinator = kLeader;
    announcements_.send(announcement);
    see_coordinator();
    advance();
    for (const ControlVerb verb : {ControlVerb::arm, ControlVerb::start}) control(verb);
  }
  void see_coordinator() {
    ParticipantStatus status;
    status.id = "coordinator";
    status.incarnation = kLeader;
    statuses_.send(status);
  }
  void control(ControlVerb verb) {
    TestControl message;
    message.verb = verb;
    message.sender = kLeader;
    message.sender_role = Role::coordinator;
    control_.send(message);
    advance();
  }
  Instant advance(Duration passed = {}) {
    now_ += passed;
    return node_->advance(now_);
  }
  void command(Step step, double displacement_m, bool is_trial = false, std::uint16_t iteration = 0) {
    DisplacementCommand message;
    message.coordinator = kLeader;
    message.is_trial = is_trial;
    message.iteration = iteration;
    message.point_count = 1;
    message.points[0] = {.step = step,
                         .model_time_s = 0.01 * static_cast<double>(step),
                         .displacement_m = InterfaceVector::Constant(1, displacement_m),
                         .velocity_m_per_s = InterfaceVector::Zero(1),
                         .acceleration_m_per_s2 = InterfaceVector::Zero(1)};
    commands_.send(message);
    advance();
  }
  std::vector<double> answered() {
    std::vector<double> found;
    for (ForceMeasurement message; measurements_.take(message);) found.push_back(message.force_n[0]);
    return found;
  }

  DriverScript driver_;
  RingPort<ParticipantStatus> statuses_{64};
  RingPort<ParticipantStatus> own_statuses_{4096};
  RingPort<Event> events_{256};
  RingPort<TestAnnouncement> announcements_{4};
  RingPort<TestControl> control_{16};
  RingPort<DisplacementCommand> commands_{64};
  RingPort<ForceMeasurement> measurements_{64};
  KeptRows steps_{NumericalNode::steps_layout({"floor"})};
  Presence presence_{Identity{"model", Role::numerical_substructure, 5, {}}, seconds{2}, statuses_, own_statuses_,
                     events_};
  std::optional<NumericalNode> node_;
  Instant now_{};
};

TEST_F(PendingModel, ForceIsAnsweredWhenItArrives) {
  command(0, 0.002);
  EXPECT_THAT(answered(), ElementsAre());
  EXPECT_EQ(steps_.size(), 0U);
  driver_.replies.push_back(forces({3.0}));
  advance();
  EXPECT_THAT(answered(), ElementsAre(3000.0)) << "in units of 1 kN";
  ASSERT_EQ(driver_.asked.size(), 1U) << "a step is one request";
  EXPECT_EQ(driver_.asked[0].first, DriverRequest::step);
  EXPECT_THAT(driver_.asked[0].second, ElementsAre(testing::DoubleEq(2.0))) << "in units of 1 mm";
  EXPECT_EQ(steps_.size(), 1U);
  EXPECT_EQ(presence_.own_status().last_step, 0);
}

TEST_F(PendingModel, RepeatedCommandAsksTheModelOnce) {
  command(0, 0.002);
  command(0, 0.002);
  driver_.replies.push_back(forces({3.0}));
  advance();
  EXPECT_THAT(answered(), ElementsAre(3000.0, 3000.0)) << "the stored answer for the second one";
  EXPECT_EQ(driver_.asked.size(), 1U);
}

TEST_F(PendingModel, TrialsKeepTheStepOpen) {
  command(0, 0.001, true, 0);
  driver_.replies.push_back(forces({1.0}));
  advance();
  command(0, 0.002, false, 1);
  driver_.replies.push_back(forces({2.0}));
  advance();
  EXPECT_THAT(answered(), ElementsAre(1000.0, 2000.0));
  ASSERT_EQ(driver_.asked.size(), 2U);
  EXPECT_EQ(driver_.asked[0].first, DriverRequest::trial);
  EXPECT_EQ(driver_.asked[1].first, DriverRequest::step);
  EXPECT_EQ(steps_.size(), 1U) << "a trial is not recorded";
}

TEST_F(PendingModel, PresenceGoesOnWhileTheModelComputes) {
  command(0, 0.002);
  ParticipantStatus status;
  while (own_statuses_.take(status)) {
  }
  advance(seconds{1});
  EXPECT_TRUE(own_statuses_.take(status)) << "heartbeat";
  EXPECT_FALSE(any(presence_.faults()));
}

TEST_F(PendingModel, SilentModelRaisesAFault) {
  command(0, 0.002);
  for (int i = 0; i < 4; ++i) {
    see_coordinator();
    advance(seconds{1});
  }
  see_coordinator();
  advance(milliseconds{900});
  EXPECT_FALSE(any(presence_.faults() & FaultFlags::model_failed));
  advance(milliseconds{200});
  EXPECT_TRUE(any(presence_.faults() & FaultFlags::model_failed));
}

TEST_F(PendingModel, FailureSaysStepAndResidual) {
  command(0, 0.002);
  DriverReply failed = reply_of(DriverReply::Kind::not_converged);
  failed.residual = 0.25;
  driver_.replies.push_back(failed);
  advance();
  EXPECT_THAT(answered(), ElementsAre());
  bool is_told = false;
  for (Event event; events_.take(event);) {
    if (event.code != EventCode::model_failed) continue;
    is_told = true;
    EXPECT_EQ(event.step, 0);
    EXPECT_EQ(event.values[0], static_cast<double>(ModelFault::not_converged));
    EXPECT_EQ(event.values[1], 0.25);
  }
  EXPECT_TRUE(is_told);
  EXPECT_THAT(node_->failure_text(), HasSubstr("residual 0.25"));
  command(0, 0.002);
  EXPECT_EQ(driver_.asked.size(), 1U) << "a model that failed is asked no more";
}

TEST_F(PendingModel, DeadProcessIsToldWithItsSignal) {
  driver_.has_ended = true;
  command(0, 0.002);
  EXPECT_TRUE(any(presence_.faults() & FaultFlags::model_failed));
  EXPECT_THAT(node_->failure_text(), testing::AllOf(HasSubstr("signal 9"), HasSubstr("last words")));
}

TEST_F(PendingModel, StopDoesNotWaitForTheModel) {
  command(0, 0.002);
  control(ControlVerb::stop);
  EXPECT_TRUE(node_->is_done());
}

TEST(OpenSeesModel, BlocksWhereNobodyIsWoken) {
  DriverScript driver;
  OpenSeesModel model{pending_settings(),
                      [&](const ModelSurroundings&) { return std::make_unique<ScriptedDriver>(driver); }};
  model.start({});
  driver.replies = {forces({1.0}), forces({1.0})};
  InterfaceVector force_n = InterfaceVector::Zero(1);
  model.trial(InterfaceVector::Constant(1, 0.001), InterfaceVector::Zero(1), force_n);
  EXPECT_EQ(force_n[0], 1000.0);
  model.commit();
  ASSERT_EQ(driver.asked.size(), 2U);
  EXPECT_EQ(driver.asked[1].first, DriverRequest::step);
  EXPECT_EQ(driver.asked[1].second, driver.asked[0].second) << "the step is where the trial was";
}

TEST(OpenSeesModel, ResetStartsAgainOnlyAfterAStep) {
  DriverScript driver;
  OpenSeesModel model{pending_settings(),
                      [&](const ModelSurroundings&) { return std::make_unique<ScriptedDriver>(driver); }};
  model.start({});
  driver.replies = {forces({1.0}), forces({1.0})};
  InterfaceVector force_n = InterfaceVector::Zero(1);
  model.trial(InterfaceVector::Constant(1, 0.001), InterfaceVector::Zero(1), force_n);
  model.reset();
  EXPECT_EQ(driver.starts, 1);
  model.commit();
  model.reset();
  EXPECT_EQ(driver.starts, 2);
}

}  // namespace
}  // namespace hybridtest
