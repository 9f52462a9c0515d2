#include "plant/transfer_systems/ideal.hpp"

#include <gtest/gtest.h>

namespace hybridtest {
namespace {

TEST(Ideal, EqualsTheCommand) {
  Ideal actuator;
  for (const double command_m : {0.1, -0.3, 0.0}) EXPECT_EQ(actuator.step(command_m), command_m);
}

}  // namespace
}  // namespace hybridtest
