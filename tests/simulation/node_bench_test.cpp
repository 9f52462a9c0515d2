#include "tests/simulation/node_bench.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/simulation/drawn_case.hpp"
#include "tests/simulation/kept_simulation.hpp"
#include "tests/support/scripted_substructure.hpp"

/// Conflicting participants, forged messages, operators, failing models.
namespace hybridtest {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr double kStiffness_n_per_m = 3.0e6;

/// The shipped two storeys, the second one's spring scripted.
class NodeBenchTest : public testing::Test {
 protected:
  static Scenario two_storeys(std::vector<std::string> overrides = {}) {
    overrides.insert(overrides.begin(), {kPulse, "time.duration_s=0.5"});
    return shipped_scenario("two_storey_one_site", overrides);
  }
  void script(ScriptedSubstructure::Force force) {
    scenario_.substructures[1].make_model = [this, force] {
      return std::make_unique<ScriptedSubstructure>(1, force, calls_);
    };
  }
  void add_all() {
    coordinator_ = &bench_.add_coordinator(scenario_);
    site_ = &bench_.add_substructure(scenario_, "storey_1", milliseconds{20});
    model_ = &bench_.add_substructure(scenario_, "storey_2", milliseconds{40});
  }
  [[nodiscard]] Step completed() const {
    return static_cast<CoordinatorParticipant&>(*coordinator_->participant).report().completed_steps;
  }
  void expect_completed() {
    ASSERT_TRUE(bench_.run_to_end(seconds{60}));
    EXPECT_EQ(coordinator_->reason(), StopReason::completed);
    EXPECT_EQ(site_->reason(), StopReason::completed);
    EXPECT_EQ(model_->reason(), StopReason::completed);
    EXPECT_EQ(completed(), scenario_.time.last_step + 1);
    EXPECT_EQ(calls_.commits, scenario_.time.last_step + 1);
  }
  static void operator_says(Transport& outsider, ControlVerb verb) {
    TestControl message;
    message.verb = verb;
    message.sender = 4321;
    outsider.control_outbox()->send(message);
  }
  void run_to_step(Step step) {
    while (completed() < step && bench_.now() < seconds{60}) bench_.run_until(bench_.now() + milliseconds{1});
    ASSERT_GE(completed(), step);
  }

  Scenario scenario_ = two_storeys();
  SubstructureCalls calls_;
  NodeBench bench_;
  NodeBench::Seat* coordinator_ = nullptr;
  NodeBench::Seat* site_ = nullptr;
  NodeBench::Seat* model_ = nullptr;

  void SetUp() override { script(linear_spring(kStiffness_n_per_m)); }
};

TEST_F(NodeBenchTest, CompletesATest) {
  add_all();
  expect_completed();
}

TEST_F(NodeBenchTest, RefusesSecondCoordinatorAndContinues) {
  add_all();
  // At the last moment before stepping begins, and in the middle of it.
  for (const Duration start : {milliseconds{250}, milliseconds{330}}) {
    bench_.add_coordinator(scenario_, start);
  }
  run_to_step(50);
  NodeBench::Seat& late = bench_.add_coordinator(scenario_, bench_.now());
  expect_completed();
  EXPECT_EQ(late.reason(), StopReason::refused);
  EXPECT_EQ(late.state(), LifecycleState::refused);
  EXPECT_GE(bench_.count(EventCode::second_coordinator, late.incarnation()), 1U);
}

TEST_F(NodeBenchTest, OneOfTwoSimultaneousCoordinatorsRunsTest) {
  coordinator_ = &bench_.add_coordinator(scenario_);
  NodeBench::Seat& other = bench_.add_coordinator(scenario_);
  site_ = &bench_.add_substructure(scenario_, "storey_1");
  model_ = &bench_.add_substructure(scenario_, "storey_2");
  expect_completed();
  EXPECT_EQ(other.reason(), StopReason::refused);
}

TEST_F(NodeBenchTest, RefusesDuplicateOfRunningParticipant) {
  add_all();
  run_to_step(50);
  NodeBench::Seat& second_site = bench_.add_substructure(scenario_, "storey_1", bench_.now());
  NodeBench::Seat& second_model = bench_.add_substructure(scenario_, "storey_2", bench_.now());
  SubstructureCalls before = calls_;
  expect_completed();
  for (const NodeBench::Seat* seat : {&second_site, &second_model}) {
    EXPECT_EQ(seat->reason(), StopReason::refused);
    EXPECT_EQ(seat->state(), LifecycleState::refused);
    EXPECT_GE(bench_.count(EventCode::duplicate_id, seat->incarnation()), 1U);
    for (const auto& [name, table] : seat->tables) EXPECT_EQ(table.size(), 0U) << name;
  }
}

TEST_F(NodeBenchTest, YoungerDuplicateIsRefusedBeforeTest) {
  add_all();
  NodeBench::Seat& younger = bench_.add_substructure(scenario_, "storey_1", milliseconds{150});
  expect_completed();
  EXPECT_EQ(younger.reason(), StopReason::refused);
}

TEST_F(NodeBenchTest, RefusesOtherScenarioBeforeMotion) {
  const Scenario other = two_storeys({"substructures[storey_1].limits.force_n=160.0e3"});
  ASSERT_NE(other.digest, scenario_.digest);
  coordinator_ = &bench_.add_coordinator(scenario_);
  site_ = &bench_.add_substructure(other, "storey_1");
  model_ = &bench_.add_substructure(scenario_, "storey_2");
  ASSERT_TRUE(bench_.run_to_end(seconds{60}));
  EXPECT_EQ(coordinator_->reason(), StopReason::refused);
  EXPECT_EQ(site_->reason(), StopReason::refused);
  EXPECT_EQ(model_->reason(), StopReason::refused);
  EXPECT_EQ(bench_.count(EventCode::digest_mismatch, site_->incarnation()), 1U);
  EXPECT_EQ(bench_.count(EventCode::digest_mismatch, coordinator_->incarnation()), 1U);
  EXPECT_EQ(site_->tables.find("control")->second.size(), 0U);
  EXPECT_EQ(calls_.trials, 0);
}

TEST_F(NodeBenchTest, MeasurementsOfUnknownSendersAreIgnored) {
  add_all();
  Transport& impostor = bench_.add_outsider();
  const auto outbox = impostor.measurement_outbox(1);
  for (Duration time = milliseconds{300}; time < milliseconds{400}; time += milliseconds{1}) {
    bench_.run_until(time);
    for (SubstructureIndex index = 0; index < 4; ++index) {
      ForceMeasurement forged;
      forged.substructure = index;
      forged.sender = 4321;
      forged.step = completed();
      forged.force_n = InterfaceVector::Constant(1, 1.0e9);
      outbox->send(forged);
    }
  }
  expect_completed();
  for (const double force_n : coordinator_->tables.find("steps")->second.column_values("restoring_force_floor_2_n")) {
    EXPECT_LT(std::abs(force_n), 1.0e6);
  }
}

TEST_F(NodeBenchTest, CommandsOfUnknownSendersCauseNoMotion) {
  add_all();
  Transport& impostor = bench_.add_outsider();
  const auto outbox = impostor.command_outbox(2);
  run_to_step(20);
  for (SubstructureIndex index = 0; index < 2; ++index) {
    DisplacementCommand forged;
    forged.substructure = index;
    forged.coordinator = 4321;
    forged.point_count = 1;
    forged.points[0].step = completed() + 1;
    forged.points[0].displacement_m = forged.points[0].velocity_m_per_s = forged.points[0].acceleration_m_per_s2 =
        InterfaceVector::Constant(1, 0.1);
    outbox->send(forged);
  }
  expect_completed();
  for (const InterfaceVector& displacement_m : calls_.committed_m) EXPECT_LT(std::abs(displacement_m[0]), 0.09);
}

TEST_F(NodeBenchTest, NonFiniteForceEndsTestWithoutIntegration) {
  script([](int trial, const InterfaceVector& displacement_m) -> InterfaceVector {
    if (trial == 100) return InterfaceVector::Constant(1, std::numeric_limits<double>::quiet_NaN());
    return kStiffness_n_per_m * displacement_m;
  });
  add_all();
  ASSERT_TRUE(bench_.run_to_end(seconds{60}));
  EXPECT_EQ(coordinator_->reason(), StopReason::not_finite);
  EXPECT_EQ(bench_.count(EventCode::measurement_not_finite, coordinator_->incarnation()), 1U);
  EXPECT_EQ(completed(), 100);
  const KeptRows& steps = coordinator_->tables.find("steps")->second;
  EXPECT_EQ(steps.size(), 100U);
  for (const double value : steps.values()) EXPECT_TRUE(std::isfinite(value));
  EXPECT_EQ(site_->tables.find("control")->second.column_values("command_displacement_m").back(), 0.0)
      << "the site returns to zero";
}

TEST_F(NodeBenchTest, WrongForceVectorSizeEndsTest) {
  add_all();
  Transport& impostor = bench_.add_outsider();
  run_to_step(20);
  ForceMeasurement forged;
  forged.substructure = 1;
  forged.sender = model_->incarnation();
  forged.force_n = InterfaceVector::Zero(2);
  // This answer has to arrive before the true one.
  const auto outbox = impostor.measurement_outbox(1);
  while (coordinator_->reason() == StopReason::none && bench_.now() < seconds{10}) {
    forged.step = completed();
    outbox->send(forged);
    forged.step = completed() + 1;
    outbox->send(forged);
    bench_.run_until(bench_.now() + std::chrono::microseconds{30});
  }
  ASSERT_TRUE(bench_.run_to_end(seconds{60}));
  EXPECT_EQ(coordinator_->reason(), StopReason::not_finite);
}

TEST_F(NodeBenchTest, WaitsForLateParticipantAndNamesMissingOne) {
  add_all();
  const Scenario patient = two_storeys({"timeouts={discovery_s: 5.0}"});
  {
    NodeBench bench;
    NodeBench::Seat& coordinator = bench.add_coordinator(patient);
    bench.add_substructure(patient, "storey_1");
    bench.add_substructure(patient, "storey_2", seconds{4});
    ASSERT_TRUE(bench.run_to_end(seconds{60}));
    EXPECT_EQ(coordinator.reason(), StopReason::completed);
  }
  {
    NodeBench bench;
    NodeBench::Seat& coordinator = bench.add_coordinator(patient);
    NodeBench::Seat& site = bench.add_substructure(patient, "storey_1");
    ASSERT_TRUE(bench.run_to_end(seconds{60}));
    EXPECT_EQ(coordinator.reason(), StopReason::not_assembled);
    EXPECT_EQ(site.reason(), StopReason::not_assembled);
    ASSERT_EQ(bench.count(EventCode::participant_missing, coordinator.incarnation()), 1U);
    const auto missing = std::ranges::find(bench.events(), EventCode::participant_missing, &Event::code);
    EXPECT_EQ(missing->subject, "storey_2");
  }
}

TEST_F(NodeBenchTest, OperatorPausesAndResumesInBothModes) {
  for (const char* mode : {"lockstep", "paced"}) {
    SCOPED_TRACE(mode);
    scenario_ = two_storeys({std::string{"time.mode="} + mode});
    calls_ = {};
    script(linear_spring(kStiffness_n_per_m));
    NodeBench bench;
    coordinator_ = &bench.add_coordinator(scenario_);
    site_ = &bench.add_substructure(scenario_, "storey_1");
    model_ = &bench.add_substructure(scenario_, "storey_2");
    Transport& desk = bench.add_outsider();
    while (completed() < 200) bench.run_until(bench.now() + milliseconds{1});
    operator_says(desk, ControlVerb::pause);
    bench.run_until(bench.now() + milliseconds{100});
    const Step paused_at = completed();
    bench.run_until(bench.now() + seconds{20});  // far beyond the command-age limit of 2 s
    EXPECT_EQ(completed(), paused_at);
    EXPECT_LT(completed(), scenario_.time.last_step);
    const std::vector<double> commands_m =
        site_->tables.find("control")->second.column_values("command_displacement_m");
    EXPECT_NE(commands_m.back(), 0.0);
    operator_says(desk, ControlVerb::resume);
    ASSERT_TRUE(bench.run_to_end(seconds{60}));
    EXPECT_EQ(coordinator_->reason(), StopReason::completed);
    EXPECT_EQ(completed(), scenario_.time.last_step + 1);
    EXPECT_EQ(bench.count(EventCode::test_paused, coordinator_->incarnation()), 1U);
    EXPECT_EQ(bench.count(EventCode::test_resumed, coordinator_->incarnation()), 1U);
  }
}

TEST_F(NodeBenchTest, EmergencyStopEndsMotionAtOnce) {
  for (const char* mode : {"lockstep", "paced"}) {
    SCOPED_TRACE(mode);
    scenario_ = two_storeys({std::string{"time.mode="} + mode});
    script(linear_spring(kStiffness_n_per_m));
    NodeBench bench;
    coordinator_ = &bench.add_coordinator(scenario_);
    site_ = &bench.add_substructure(scenario_, "storey_1");
    model_ = &bench.add_substructure(scenario_, "storey_2");
    Transport& desk = bench.add_outsider();
    while (completed() < 200) bench.run_until(bench.now() + milliseconds{1});
    operator_says(desk, ControlVerb::emergency_stop);
    const std::size_t before = site_->tables.find("control")->second.size();
    ASSERT_TRUE(bench.run_to_end(seconds{60}));
    EXPECT_EQ(coordinator_->reason(), StopReason::emergency_stop);
    EXPECT_EQ(site_->reason(), StopReason::emergency_stop);
    EXPECT_EQ(model_->reason(), StopReason::emergency_stop);
    EXPECT_EQ(site_->participant->presence().faults(), FaultFlags::emergency_stop);
    // What was under way when it was pressed: the network's 50 us, in lockstep one step of two
    // control periods at most.
    EXPECT_LE(site_->tables.find("control")->second.size() - before, 2U);
  }
}

TEST_F(NodeBenchTest, OperatorStopReturnsSiteToZero) {
  scenario_ = two_storeys({"time.mode=paced"});
  script(linear_spring(kStiffness_n_per_m));
  add_all();
  Transport& desk = bench_.add_outsider();
  run_to_step(200);
  operator_says(desk, ControlVerb::stop);
  ASSERT_TRUE(bench_.run_to_end(seconds{60}));
  EXPECT_EQ(coordinator_->reason(), StopReason::interrupted);
  EXPECT_EQ(site_->reason(), StopReason::interrupted);
  EXPECT_EQ(site_->tables.find("control")->second.column_values("command_displacement_m").back(), 0.0);
}

TEST_F(NodeBenchTest, AnyParticipantCanBeStoppedByHand) {
  for (int stopped = 0; stopped < 3; ++stopped) {
    SCOPED_TRACE(stopped);
    script(linear_spring(kStiffness_n_per_m));
    NodeBench bench;
    coordinator_ = &bench.add_coordinator(scenario_);
    site_ = &bench.add_substructure(scenario_, "storey_1");
    model_ = &bench.add_substructure(scenario_, "storey_2");
    while (completed() < 100) bench.run_until(bench.now() + milliseconds{1});
    for (NodeBench::Seat* seat : {coordinator_, site_, model_}) {
      if (stopped-- == 0) seat->participant->request_stop(StopReason::interrupted);
    }
    stopped += 3;
    ASSERT_TRUE(bench.run_to_end(seconds{60}));
    for (const NodeBench::Seat* seat : {coordinator_, site_, model_}) {
      EXPECT_EQ(seat->reason(), StopReason::interrupted) << seat->name;
    }
  }
}

TEST_F(NodeBenchTest, DroppedRecordsEndTestAsConfigured) {
  for (const char* on_failure : {"stop", "continue"}) {
    SCOPED_TRACE(on_failure);
    scenario_ = two_storeys({std::string{"recording={on_failure: "} + on_failure + "}"});
    script(linear_spring(kStiffness_n_per_m));
    NodeBench bench;
    coordinator_ = &bench.add_coordinator(scenario_);
    site_ = &bench.add_substructure(scenario_, "storey_1");
    model_ = &bench.add_substructure(scenario_, "storey_2");
    while (completed() < 100) bench.run_until(bench.now() + milliseconds{1});
    model_->participant->presence().raise(FaultFlags::records_dropped);
    ASSERT_TRUE(bench.run_to_end(seconds{60}));
    EXPECT_EQ(coordinator_->reason(),
              std::string_view{on_failure} == "stop" ? StopReason::recording_failed : StopReason::completed);
    EXPECT_NE(exit_code_for(StopReason::recording_failed), kExitCompleted);
  }
}

}  // namespace
}  // namespace hybridtest
