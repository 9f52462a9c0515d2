#include "coordinator/opensees/opensees_lead.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <string>
#include <vector>

#include "tests/support/kept_rows.hpp"

namespace hybridtest {
namespace {

using Kind = ElementRequest::Kind;

Instant at_ms(int ms) { return Instant{std::chrono::milliseconds{ms}}; }

/// The elements of a model, asked and answered by the test.
class ScriptedElements final : public ElementPort {
 public:
  bool take(ElementRequest& request) noexcept override {
    if (requests.empty()) return false;
    request = requests.front();
    requests.pop_front();
    return true;
  }
  void answer_force(int element, const Eigen::Ref<const Eigen::VectorXd>& force_n) noexcept override {
    answers.push_back({element, force_n});
  }

  void says(int element, Kind kind, ClientFault fault = ClientFault::unknown) {
    ElementRequest request;
    request.element = element;
    request.kind = kind;
    request.fault = fault;
    requests.push_back(request);
  }
  void tries(int element, const Eigen::VectorXd& displacement_m, double velocity_m_per_s = 0.0, double time_s = 0.0) {
    ElementRequest request;
    request.element = element;
    request.kind = Kind::trial;
    request.displacement_m = displacement_m;
    request.velocity_m_per_s = Eigen::VectorXd::Constant(displacement_m.size(), velocity_m_per_s);
    request.acceleration_m_per_s2 = Eigen::VectorXd::Zero(displacement_m.size());
    request.time_s = time_s;
    requests.push_back(request);
  }

  struct Answer {
    int element;
    Eigen::VectorXd force_n;
  };
  std::deque<ElementRequest> requests;
  std::vector<Answer> answers;
};

Eigen::VectorXd of(std::initializer_list<double> values) {
  Eigen::VectorXd vector(std::ssize(values));
  std::ranges::copy(values, vector.begin());
  return vector;
}

constexpr double kStiffness = 1000.0;

/// Element 0 has floor 1 against the ground, element 1 the drift between floors 1 and 2, as two degrees of freedom.
class OpenSeesLeadTest : public testing::Test {
 protected:
  void leads(bool can_revert, bool allow_iterations = false) {
    OpenSeesLeadSettings settings;
    settings.structure_size = 2;
    settings.elements = {{0, "storey_1", {0}, InterfaceMap{2, {{.dof = 0}}}},
                         {1, "storey_2", {0, 1}, InterfaceMap{2, {{.dof = 1, .relative_to = 0}}}}};
    settings.can_revert = can_revert;
    settings.allow_iterations = allow_iterations;
    settings.silence = std::chrono::seconds{10};
    lead_.emplace(settings, port_, rows_);
    EXPECT_EQ(lead_->next(now_), NextMotion::command) << "step 0, at rest";
    complete();
  }
  /// Forces of two springs of kStiffness at the command.
  void complete() {
    const Eigen::VectorXd& u = lead_->current().displacement_m;
    lead_->take_force(0, InterfaceVector::Constant(1, kStiffness * u[0]));
    lead_->take_force(1, InterfaceVector::Constant(1, kStiffness * (u[1] - u[0])));
    lead_->advance(Eigen::VectorXd::Zero(2), Eigen::VectorXd::Zero(2));
  }
  /// The two elements try the floors at these displacements.
  void tries(double floor_1, double floor_2, double velocity = 0.0) {
    port_.tries(0, of({floor_1}), velocity);
    port_.tries(1, of({floor_1, floor_2}), velocity);
  }
  void asks() {
    port_.says(0, Kind::force);
    port_.says(1, Kind::force);
  }
  void commits() {
    port_.says(0, Kind::commit);
    port_.says(1, Kind::commit);
  }

  Instant now_ = at_ms(0);
  ScriptedElements port_;
  KeptRows rows_{OpenSeesLead::trials_layout()};
  std::optional<OpenSeesLead> lead_;
};

TEST_F(OpenSeesLeadTest, AwaitsTheFirstElementThatIsNotConnected) {
  lead_.emplace(OpenSeesLeadSettings{.structure_size = 1, .elements = {{0, "a", {0}, {}}, {1, "b", {0}, {}}}}, port_,
                rows_);
  EXPECT_EQ(lead_->awaited(now_).view(), "a");
  port_.says(0, Kind::connected);
  EXPECT_EQ(lead_->awaited(now_).view(), "b");
  port_.says(1, Kind::connected);
  EXPECT_TRUE(lead_->awaited(now_).empty());
  port_.says(1, Kind::lost, ClientFault::closed);
  EXPECT_EQ(lead_->awaited(now_).view(), "b");
}

TEST_F(OpenSeesLeadTest, ModelThatCameAgainBeforeTheTestLeads) {
  port_.says(0, Kind::connected);
  port_.tries(0, of({0.5}));
  port_.says(0, Kind::lost, ClientFault::closed);
  port_.says(0, Kind::connected);
  leads(false);
  EXPECT_EQ(lead_->next(now_), NextMotion::none) << "neither lost nor at 0.5 m";
}

TEST_F(OpenSeesLeadTest, ModelThatComesAgainDuringTheTestDoesNotLead) {
  leads(false);
  port_.says(0, Kind::lost, ClientFault::closed);
  port_.says(0, Kind::connected);
  ASSERT_EQ(lead_->next(now_), NextMotion::end);
  EXPECT_EQ(lead_->end().reason, StopReason::opensees_lost);
}

TEST_F(OpenSeesLeadTest, TrialAloneMovesNothing) {
  leads(false);
  tries(0.001, 0.002);
  EXPECT_EQ(lead_->next(now_), NextMotion::none);
}

TEST_F(OpenSeesLeadTest, QuestionMovesAllElementsAtOnce) {
  leads(false);
  tries(0.001, 0.003);
  port_.says(0, Kind::force);
  ASSERT_EQ(lead_->next(now_), NextMotion::command);
  EXPECT_FALSE(lead_->is_trial());
  EXPECT_EQ(lead_->current().displacement_m, of({0.001, 0.003}));
  complete();
  EXPECT_EQ(lead_->next(now_), NextMotion::none);
  ASSERT_EQ(port_.answers.size(), 1U);
  EXPECT_EQ(port_.answers[0].force_n, of({kStiffness * 0.001}));
  port_.says(1, Kind::force);
  EXPECT_EQ(lead_->next(now_), NextMotion::none) << "is where it was asked for";
  ASSERT_EQ(port_.answers.size(), 2U);
  EXPECT_TRUE(port_.answers[1].force_n.isApprox(of({-kStiffness * 0.002, kStiffness * 0.002})))
      << "in the element's order";
}

TEST_F(OpenSeesLeadTest, RepeatedQuestionIsAnsweredWithoutMotion) {
  leads(false);
  for (int i = 0; i < 3; ++i) {
    tries(0.0, 0.0, 1.0 + i);  // a specimen has a velocity of its own
    asks();
  }
  EXPECT_EQ(lead_->next(now_), NextMotion::none);
  EXPECT_EQ(port_.answers.size(), 6U);
}

TEST_F(OpenSeesLeadTest, WaitsForTheTrialOfTheOtherElement) {
  leads(false);
  port_.tries(0, of({0.001}));
  port_.says(0, Kind::force);
  EXPECT_EQ(lead_->next(now_), NextMotion::none);
  EXPECT_EQ(lead_->wake(), now_ + OpenSeesLead::kTogether);
  port_.tries(1, of({0.001, 0.002}));
  ASSERT_EQ(lead_->next(now_ + Duration{1}), NextMotion::command);
  EXPECT_EQ(lead_->current().displacement_m, of({0.001, 0.002}));
}

TEST_F(OpenSeesLeadTest, OtherElementThatTriesNothingIsNotWaitedFor) {
  leads(false);
  port_.tries(0, of({0.001}));
  port_.says(0, Kind::force);
  EXPECT_EQ(lead_->next(now_), NextMotion::none);
  ASSERT_EQ(lead_->next(now_ + OpenSeesLead::kTogether), NextMotion::command);
  EXPECT_EQ(lead_->current().displacement_m, of({0.001, 0.0}));
}

TEST_F(OpenSeesLeadTest, SecondMotionInAStepEndsATestWithASpecimen) {
  leads(false);
  tries(0.001, 0.002);
  asks();
  ASSERT_EQ(lead_->next(now_), NextMotion::command);
  complete();
  tries(0.001, 0.0021);
  asks();
  ASSERT_EQ(lead_->next(now_), NextMotion::end);
  EXPECT_EQ(lead_->end().reason, StopReason::opensees_iterates);
  EXPECT_EQ(lead_->end().event.subject.view(), "storey_2") << "storey_1 was not to move again";
}

TEST_F(OpenSeesLeadTest, OneMotionPerCommitIsNoIteration) {
  leads(false);
  for (int step = 1; step <= 5; ++step) {
    tries(0.001 * step, 0.002 * step);
    asks();
    ASSERT_EQ(lead_->next(now_), NextMotion::command) << step;
    complete();
    tries(0.001 * step + 1e-5, 0.002 * step);  // corrected, as AlphaOS does, and not asked for
    commits();
    EXPECT_EQ(lead_->next(now_), NextMotion::none) << step;
  }
}

TEST_F(OpenSeesLeadTest, AllowedIterationsAreStepsOfTheTest) {
  leads(false, true);
  for (const double u : {0.001, 0.0011, 0.00111}) {
    tries(u, u);
    asks();
    ASSERT_EQ(lead_->next(now_), NextMotion::command);
    EXPECT_FALSE(lead_->is_trial());
    EXPECT_EQ(lead_->iteration(), 0);
    complete();
    EXPECT_EQ(lead_->completed().displacement_m, of({u, u}));
  }
}

TEST_F(OpenSeesLeadTest, ModelsAreTriedAndStepEndsWithCommit) {
  leads(true);
  tries(0.001, 0.002);
  asks();
  ASSERT_EQ(lead_->next(now_), NextMotion::command);
  EXPECT_TRUE(lead_->is_trial());
  EXPECT_EQ(lead_->iteration(), 0);
  complete();
  tries(0.0015, 0.002);
  asks();
  ASSERT_EQ(lead_->next(now_), NextMotion::command);
  EXPECT_TRUE(lead_->is_trial());
  EXPECT_EQ(lead_->iteration(), 1);
  complete();
  tries(0.0016, 0.002);
  commits();
  ASSERT_EQ(lead_->next(now_), NextMotion::command);
  EXPECT_FALSE(lead_->is_trial());
  EXPECT_EQ(lead_->iteration(), 2);
  EXPECT_EQ(lead_->current().displacement_m, of({0.0016, 0.002})) << "what OpenSees commits";
  complete();
  EXPECT_EQ(lead_->next(now_), NextMotion::none);
  EXPECT_EQ(lead_->completed().displacement_m, of({0.0016, 0.002}));
  EXPECT_EQ(lead_->iteration(), 0);
}

TEST_F(OpenSeesLeadTest, NextTrialDoesNotOvertakeTheCommit) {
  leads(true);
  tries(0.001, 0.002);
  // Element 0 has committed and is in the next step when the commit of element 1 arrives.
  port_.says(0, Kind::commit);
  port_.tries(0, of({0.009}));
  port_.says(0, Kind::force);
  EXPECT_EQ(lead_->next(now_), NextMotion::none);
  port_.says(1, Kind::commit);
  port_.tries(1, of({0.009, 0.010}));
  ASSERT_EQ(lead_->next(now_), NextMotion::command);
  EXPECT_FALSE(lead_->is_trial());
  EXPECT_EQ(lead_->current().displacement_m, of({0.001, 0.002}));
  complete();
  ASSERT_EQ(lead_->next(now_), NextMotion::command);
  EXPECT_TRUE(lead_->is_trial());
  EXPECT_EQ(lead_->current().displacement_m, of({0.009, 0.010}));
}

TEST_F(OpenSeesLeadTest, CommitOfWhatTheModelsHaveCostsNothing) {
  leads(true);
  tries(0.0, 0.0);
  commits();
  EXPECT_EQ(lead_->next(now_), NextMotion::none);
}

TEST_F(OpenSeesLeadTest, ModelIsAskedAgainForAnotherVelocity) {
  leads(true);
  tries(0.0, 0.0, 0.5);
  asks();
  EXPECT_EQ(lead_->next(now_), NextMotion::command) << "a damper answers another force";
}

TEST_F(OpenSeesLeadTest, EndOfTheModelCompletesTheTest) {
  leads(false);
  port_.says(0, Kind::die);
  port_.says(1, Kind::die);
  port_.says(0, Kind::lost, ClientFault::closed);
  ASSERT_EQ(lead_->next(now_), NextMotion::end);
  EXPECT_EQ(lead_->end().reason, StopReason::completed);
}

TEST_F(OpenSeesLeadTest, LostConnectionEndsTheTestAndIsNamed) {
  leads(false);
  port_.says(1, Kind::lost, ClientFault::closed);
  ASSERT_EQ(lead_->next(now_), NextMotion::end);
  const LeadEnd end = lead_->end();
  EXPECT_EQ(end.reason, StopReason::opensees_lost);
  EXPECT_EQ(end.event.code, EventCode::opensees_lost);
  EXPECT_EQ(end.event.subject.view(), "storey_2");
  EXPECT_EQ(end.event.values[0], static_cast<double>(ClientFault::closed));
}

TEST_F(OpenSeesLeadTest, SilenceEndsTheTestAtItsLimit) {
  leads(false);
  EXPECT_EQ(lead_->next(at_ms(1000)), NextMotion::none);
  EXPECT_EQ(lead_->wake(), at_ms(11'000)) << "since the coordinator began to wait";
  EXPECT_EQ(lead_->next(at_ms(10'999)), NextMotion::none);
  ASSERT_EQ(lead_->next(at_ms(11'000)), NextMotion::end);
  EXPECT_EQ(lead_->end().reason, StopReason::opensees_lost);
  EXPECT_EQ(lead_->end().event.code, EventCode::opensees_silent);
  EXPECT_DOUBLE_EQ(lead_->end().event.values[0], 10.0);
}

TEST_F(OpenSeesLeadTest, RefusedClientIsToldAndChangesNothing) {
  leads(false);
  port_.says(1, Kind::refused, ClientFault::address);
  EXPECT_EQ(lead_->next(now_), NextMotion::none);
  const auto told = lead_->take_event();
  ASSERT_TRUE(told.has_value());
  EXPECT_EQ(told->code, EventCode::opensees_refused);
  EXPECT_EQ(told->subject.view(), "storey_2");
  EXPECT_FALSE(lead_->take_event().has_value());
}

TEST_F(OpenSeesLeadTest, RecordsTheTimeOfOpenSeesForEachCommand) {
  leads(false);
  port_.tries(0, of({0.001}), 0.0, 0.25);
  port_.tries(1, of({0.001, 0.002}), 0.0, 0.25);
  asks();
  ASSERT_EQ(lead_->next(now_), NextMotion::command);
  EXPECT_EQ(rows_.column_values("step"), std::vector<double>{1.0});
  EXPECT_EQ(rows_.column_values("opensees_time_s"), std::vector<double>{0.25});
}

}  // namespace
}  // namespace hybridtest
