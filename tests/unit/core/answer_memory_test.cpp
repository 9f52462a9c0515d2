#include "core/answer_memory.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace hybridtest {
namespace {

CommandPoint point(Step step, double displacement_m) {
  CommandPoint result;
  result.step = step;
  result.displacement_m = InterfaceVector::Constant(2, displacement_m);
  return result;
}

/// A memory of `answers` with the steps 0 to `last`: the displacement of step n is n, its force 10 n.
AnswerMemory with_steps(std::size_t answers, Step last) {
  AnswerMemory memory{answers, 2};
  for (Step step = 0; step <= last; ++step) {
    const double value = static_cast<double>(step);
    const InterfaceVector displacement_m = InterfaceVector::Constant(2, value);
    memory.keep_command(step, 0, displacement_m);
    memory.keep_answer(step, 0, 0.01 * value, 1.1 * displacement_m, 1.2 * displacement_m, 10.0 * displacement_m,
                       MeasurementFlags::late);
  }
  return memory;
}

TEST(AnswerMemory, AnswersWhatItWasGiven) {
  const AnswerMemory memory = with_steps(8, 5);
  ForceMeasurement answer;
  ASSERT_EQ(memory.recall(point(3, 3.0), 0, answer), Recall::answered);
  EXPECT_EQ(answer.step, 3);
  EXPECT_EQ(answer.model_time_s, 0.03);
  EXPECT_EQ(answer.imposed_displacement_m, InterfaceVector::Constant(2, 1.1 * 3.0));
  EXPECT_EQ(answer.measured_displacement_m, InterfaceVector::Constant(2, 1.2 * 3.0));
  EXPECT_EQ(answer.force_n, InterfaceVector::Constant(2, 30.0));
  EXPECT_EQ(answer.flags, MeasurementFlags::late);
}

TEST(AnswerMemory, NoticesOneBitOfDifference) {
  const AnswerMemory memory = with_steps(8, 5);
  ForceMeasurement answer;
  CommandPoint other = point(3, 3.0);
  other.displacement_m[1] = std::nextafter(3.0, 4.0);
  EXPECT_EQ(memory.recall(other, 0, answer), Recall::different);
  EXPECT_FALSE(memory.agrees_with(other));
  EXPECT_EQ(memory.difference(other), (std::array{3.0, std::nextafter(3.0, 4.0)}));
  EXPECT_FALSE(memory.agrees_with(point(0, -0.0))) << "equal as numbers, not as bits";
  EXPECT_TRUE(memory.agrees_with(point(0, 0.0)));
}

TEST(AnswerMemory, KeepsTheLastOfManySteps) {
  const AnswerMemory memory = with_steps(8, 1000);
  ForceMeasurement answer;
  EXPECT_EQ(memory.oldest_step(), 993);
  EXPECT_EQ(memory.recall(point(992, 992.0), 0, answer), Recall::forgotten);
  for (Step step = 993; step <= 1000; ++step) {
    EXPECT_EQ(memory.recall(point(step, static_cast<double>(step)), 0, answer), Recall::answered) << step;
  }
  EXPECT_EQ(memory.recall(point(1001, 1001.0), 0, answer), Recall::forgotten);
  EXPECT_TRUE(memory.agrees_with(point(1001, 7.0))) << "nothing is known of it";
}

TEST(AnswerMemory, CommandWithoutItsAnswerIsPending) {
  AnswerMemory memory = with_steps(8, 5);
  memory.keep_command(6, 0, InterfaceVector::Constant(2, 6.0));
  ForceMeasurement answer;
  EXPECT_EQ(memory.recall(point(6, 6.0), 0, answer), Recall::pending);
  EXPECT_EQ(memory.recall(point(6, 7.0), 0, answer), Recall::different);
}

TEST(AnswerMemory, TellsTrialsOfAStepApart) {
  AnswerMemory memory{8, 2};
  for (std::uint16_t iteration = 0; iteration < 3; ++iteration) {
    const InterfaceVector displacement_m = InterfaceVector::Constant(2, 1.0 + iteration);
    memory.keep_command(4, iteration, displacement_m);
    memory.keep_answer(4, iteration, 0.0, displacement_m, displacement_m, 100.0 * displacement_m,
                       MeasurementFlags::none);
  }
  ForceMeasurement answer;
  ASSERT_EQ(memory.recall(point(4, 2.0), 1, answer), Recall::answered);
  EXPECT_EQ(answer.force_n[0], 200.0);
  EXPECT_EQ(memory.recall(point(4, 2.0), 2, answer), Recall::different);
  EXPECT_TRUE(memory.agrees_with(point(4, 3.0))) << "the command that ended the step";
}

TEST(AnswerMemory, FindsTheFirstPointOfAnotherHistory) {
  const AnswerMemory memory = with_steps(8, 5);
  DisplacementCommand command;
  command.point_count = 3;
  for (int i = 0; i < 3; ++i) command.points[static_cast<std::size_t>(i)] = point(6 - i, 6.0 - i);
  EXPECT_EQ(memory.first_other(command, 5), nullptr);
  command.points[0].displacement_m[0] = 7.0;
  EXPECT_EQ(memory.first_other(command, 5), nullptr) << "the newest point is compared with its own answer";
  command.points[2].displacement_m[0] = 4.5;
  EXPECT_EQ(memory.first_other(command, 5), &command.points[2]);
  EXPECT_EQ(memory.first_other(command, 3), nullptr) << "that step has not ended";
}

TEST(AnswerMemory, WithoutRoomRemembersNothing) {
  const AnswerMemory memory = with_steps(0, 5);
  ForceMeasurement answer;
  EXPECT_EQ(memory.recall(point(3, 3.0), 0, answer), Recall::forgotten);
  EXPECT_EQ(memory.oldest_step(), kNoStep);
}

TEST(AnswerMemory, TakesAtMostItsStatedMemory) {
  EXPECT_EQ(AnswerMemory::answers_for(1), 8192U);
  EXPECT_EQ(AnswerMemory::answers_for(kMaxSiteDofs), 8192U);
  EXPECT_LE(AnswerMemory::answers_for(kMaxInterfaceDofs) * kMaxInterfaceDofs * 4 * sizeof(double), 32U << 20U);
}

}  // namespace
}  // namespace hybridtest
