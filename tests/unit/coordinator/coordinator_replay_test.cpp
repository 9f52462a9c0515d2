#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <vector>

#include "coordinator/coordinator.hpp"
#include "core/ring_port.hpp"
#include "tests/support/integration_methods.hpp"
#include "tests/support/kept_rows.hpp"
#include "tests/support/structures.hpp"

/// A coordinator that takes the recorded answers of another one goes on as that one would have.
namespace hybridtest {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Step kLast = 60;
constexpr double kStep_s = 0.01;

/// A coordinator of two storeys, each a substructure that hardens; the test plays both.
class PlayedTest {
 public:
  PlayedTest(const test::IntegrationMethod& method, Incarnation own)
      : presence_{Identity{"coordinator", Role::coordinator, own, {}}, seconds{2}, statuses_, own_statuses_, events_} {
    CoordinatorSettings settings;
    settings.step_s = kStep_s;
    settings.last_step = kLast;
    settings.substructures = {{"a", Role::numerical_substructure, InterfaceMap{2, {{0}}}},
                              {"b", Role::numerical_substructure, InterfaceMap{2, {{1, 0}}}}};
    settings.recorded_dofs = {0, 1};
    std::vector<double> ground;
    for (Step step = 0; step <= kLast; ++step) ground.push_back(std::sin(0.3 * static_cast<double>(step)));
    const LinearStructure structure = test::shear_building(2, 20.0e3, 1.0e6);
    settings.load = AppliedLoad{{{-structure.mass_kg.toDense() * structure.influence, ground}}, {}};
    coordinator_ = std::make_unique<Coordinator>(
        settings, method.make(structure, kStep_s, {}), presence_,
        CoordinatorPorts{announcements_, control_in_, control_out_, measurements_, commands_},
        CoordinatorRecord{steps_, exchanges_, nullptr, nullptr, &answers_});
  }

  [[nodiscard]] Coordinator& coordinator() { return *coordinator_; }
  [[nodiscard]] KeptRows& steps() { return steps_; }
  [[nodiscard]] KeptRows& answers() { return answers_; }

  /// Joins both, and plays them until the coordinator has completed so many steps.
  void play(Step steps) {
    for (const LifecycleState state : {LifecycleState::joining, LifecycleState::ready, LifecycleState::armed}) {
      say_both(state);
      now_ += milliseconds{300};
      static_cast<void>(coordinator_->advance(now_));
    }
    while (coordinator_->report().completed_steps < steps && !coordinator_->is_done()) {
      say_both(LifecycleState::running);
      answer_commands();
      now_ += milliseconds{1};
      static_cast<void>(coordinator_->advance(now_));
    }
  }
  std::optional<TestAnnouncement> announcement() {
    TestAnnouncement taken;
    return announcements_.take(taken) ? std::optional{taken} : std::nullopt;
  }

 private:
  void say_both(LifecycleState state) {
    for (const char* id : {"a", "b"}) {
      ParticipantStatus status;
      status.id = id;
      status.incarnation = id[0] == 'a' ? 10U : 11U;
      status.state = state;
      status.clock = now_.time_since_epoch();
      statuses_.send(status);
    }
  }
  void answer_commands() {
    DisplacementCommand command;
    while (commands_.take(command)) {
      const double u_m = command.newest().displacement_m[0];
      ForceMeasurement answer;
      answer.substructure = command.substructure;
      answer.sender = 10U + command.substructure;
      answer.step = command.newest().step;
      answer.iteration = command.iteration;
      answer.force_n = InterfaceVector::Constant(1, 0.9e6 * u_m + 1.0e9 * u_m * u_m * u_m);
      measurements_.send(answer);
    }
  }

  RingPort<ParticipantStatus> statuses_{64};
  RingPort<ParticipantStatus> own_statuses_{4096};
  RingPort<Event> events_{256};
  RingPort<TestAnnouncement> announcements_{4};
  RingPort<TestControl> control_in_{16};
  RingPort<TestControl> control_out_{64};
  RingPort<ForceMeasurement> measurements_{64};
  RingPort<DisplacementCommand> commands_{64};
  KeptRows steps_{Coordinator::steps_layout({"floor_1", "floor_2"}, 1, false)};
  KeptRows exchanges_{Coordinator::exchanges_layout()};
  KeptRows answers_{Coordinator::answers_layout()};
  Presence presence_;
  std::unique_ptr<Coordinator> coordinator_;
  Instant now_{};
};

/// The commands of two substructures with one degree of freedom each.
std::vector<AnsweredCommand> commands_of(KeptRows& answers) {
  std::vector<AnsweredCommand> commands;
  const auto one = [&](std::size_t row, std::size_t column) -> InterfaceVector {
    return InterfaceVector::Constant(1, answers.at(row, column));
  };
  for (std::size_t row = 0; row + 1 < answers.size(); row += 2) {
    commands.push_back({.step = static_cast<Step>(answers.at(row, 0)),
                        .iteration = static_cast<std::uint16_t>(answers.at(row, 1)),
                        .is_trial = answers.at(row, 2) != 0.0,
                        .displacement_m = {one(row, 5), one(row + 1, 5)},
                        .velocity_m_per_s = {one(row, 6), one(row + 1, 6)},
                        .force_n = {one(row, 7), one(row + 1, 7)}});
  }
  return commands;
}

/// Every column but the wall time, bit for bit, in the rows that both have.
void expect_same_steps(const KeptRows& a, const KeptRows& b, std::size_t first_of_b) {
  const std::size_t width = a.layout().columns.size();
  ASSERT_GT(b.size(), 0U);
  ASSERT_EQ(a.size(), first_of_b + b.size());
  for (std::size_t row = 0; row < b.size(); ++row) {
    for (std::size_t column = 0; column < width; ++column) {
      if (column == 2) continue;
      const double* left = &a.values()[(first_of_b + row) * width + column];
      ASSERT_EQ(std::memcmp(left, &b.values()[row * width + column], sizeof(double)), 0)
          << a.layout().columns[column].name << " of step " << first_of_b + row;
    }
  }
}

class CoordinatorReplay : public testing::TestWithParam<test::IntegrationMethod> {};
INSTANTIATE_TEST_SUITE_P(All, CoordinatorReplay, testing::ValuesIn(test::all_methods()),
                         [](const auto& method) { return method.param.name; });

TEST_P(CoordinatorReplay, GoesOnBitForBitAsOneThatWasNotKilled) {
  PlayedTest whole{GetParam(), 99};
  whole.play(kLast + 1);
  ASSERT_EQ(whole.steps().size(), static_cast<std::size_t>(kLast) + 1);
  PlayedTest killed{GetParam(), 100};
  killed.play(25);

  PlayedTest resumed{GetParam(), 101};
  for (const AnsweredCommand& command : commands_of(killed.answers())) {
    ASSERT_TRUE(resumed.coordinator().replay(command)) << command.step << ", " << command.iteration;
  }
  EXPECT_EQ(resumed.coordinator().report().completed_steps, 25);
  resumed.coordinator().resume({.first_coordinator = 100});
  resumed.play(kLast + 1);
  expect_same_steps(whole.steps(), resumed.steps(), 25);
  const auto announced = resumed.announcement();
  ASSERT_TRUE(announced.has_value());
  EXPECT_EQ(announced->coordinator, 101U);
  EXPECT_EQ(announced->succeeds, 100U);
  EXPECT_EQ(resumed.answers().size(), whole.answers().size()) << "its recording can be resumed again";
}

TEST_P(CoordinatorReplay, RefusesARecordingWithAnotherBit) {
  PlayedTest killed{GetParam(), 100};
  killed.play(25);
  const std::vector<AnsweredCommand> commands = commands_of(killed.answers());
  PlayedTest resumed{GetParam(), 101};
  std::size_t accepted = 0;
  for (AnsweredCommand command : commands) {
    if (accepted == 20) command.force_n[0][0] *= 1.0 + 1e-9;
    if (!resumed.coordinator().replay(command)) break;
    ++accepted;
  }
  EXPECT_GE(accepted, 21U) << "its own displacement is right";
  EXPECT_LT(accepted, commands.size());
}

}  // namespace
}  // namespace hybridtest
