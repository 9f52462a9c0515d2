#include "core/message_copies.hpp"

#include <gtest/gtest.h>

#include <utility>

namespace hybridtest {
namespace {

InterfaceVector values(Eigen::Index size, double first) {
  return InterfaceVector::LinSpaced(size, first, first + static_cast<double>(size - 1));
}

/// A value in every field that a fresh one does not have. The structured bindings fail to compile when a field is
/// added: then message_copies.hpp needs it as well.
DisplacementCommand command(Eigen::Index dofs, std::uint8_t points) {
  DisplacementCommand command;
  auto& [substructure, coordinator, iteration, is_trial, is_rehearsal, count, all, attempt, send_time] = command;
  substructure = 3;
  coordinator = 4;
  iteration = 5;
  is_trial = true;
  is_rehearsal = true;
  count = points;
  attempt = 6;
  send_time = Duration{7};
  for (std::size_t i = 0; i < points; ++i) {
    auto& [step, model_time_s, displacement_m, velocity_m_per_s, acceleration_m_per_s2] = all[i];
    const auto number = static_cast<double>(i);
    step = 20 - static_cast<Step>(i);
    model_time_s = 0.2 - 0.01 * number;
    displacement_m = values(dofs, 1.0 + number);
    velocity_m_per_s = values(dofs, 2.5 + number);
    acceleration_m_per_s2 = values(dofs, 3.25 + number);
  }
  return command;
}

ForceMeasurement measurement(Eigen::Index dofs) {
  ForceMeasurement measurement;
  auto& [substructure, sender, step, iteration, model_time_s, imposed_m, measured_m, force_n, flags, receive_time,
         send_time, command_send_time] = measurement;
  substructure = 1;
  sender = 2;
  step = 3;
  iteration = 4;
  model_time_s = 0.5;
  imposed_m = values(dofs, 6.0);
  measured_m = values(dofs, 7.5);
  force_n = values(dofs, 8.25);
  flags = MeasurementFlags::late;
  receive_time = Duration{9};
  send_time = Duration{10};
  command_send_time = Duration{11};
  return measurement;
}

class MessageCopiesTest : public testing::TestWithParam<std::pair<int, int>> {
 protected:
  const Eigen::Index dofs_ = GetParam().first;
  const Eigen::Index dofs_before_ = GetParam().second;  // of what the copy replaces; 0 for a fresh message
};

TEST_P(MessageCopiesTest, CopyOfCommandEqualsIt) {
  const DisplacementCommand original = command(dofs_, kCommandPoints);
  DisplacementCommand copy = dofs_before_ == 0 ? DisplacementCommand{} : command(dofs_before_, kCommandPoints);
  copy_message(original, copy);
  EXPECT_EQ(copy, original);
}

TEST_P(MessageCopiesTest, MovedCommandEqualsIt) {
  DisplacementCommand original = command(dofs_, kCommandPoints);
  DisplacementCommand copy = dofs_before_ == 0 ? DisplacementCommand{} : command(dofs_before_, kCommandPoints);
  move_message(original, copy);
  EXPECT_EQ(copy, command(dofs_, kCommandPoints));
}

TEST_P(MessageCopiesTest, CopiedAndMovedMeasurementEqualsIt) {
  ForceMeasurement original = measurement(dofs_);
  ForceMeasurement copy = dofs_before_ == 0 ? ForceMeasurement{} : measurement(dofs_before_);
  copy_message(original, copy);
  EXPECT_EQ(copy, original);
  ForceMeasurement moved = dofs_before_ == 0 ? ForceMeasurement{} : measurement(dofs_before_);
  move_message(original, moved);
  EXPECT_EQ(moved, measurement(dofs_));
}

INSTANTIATE_TEST_SUITE_P(Sizes, MessageCopiesTest,
                         testing::Values(std::pair{1, 0}, std::pair{1, 1}, std::pair{1, 3}, std::pair{3, 0},
                                         std::pair{3, 1}, std::pair{3, 3}));

TEST(CopyMessageTest, LeavesPointsThatAreNotInUse) {
  const DisplacementCommand original = command(2, 1);
  DisplacementCommand copy = command(2, kCommandPoints);
  const CommandPoint second = copy.points[1];
  copy_message(original, copy);
  EXPECT_EQ(copy.point_count, 1);
  EXPECT_EQ(copy.points[0], original.points[0]);
  EXPECT_EQ(copy.points[1], second);
}

}  // namespace
}  // namespace hybridtest
