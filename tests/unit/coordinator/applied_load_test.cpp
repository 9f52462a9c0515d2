#include "coordinator/excitation/applied_load.hpp"

#include <gtest/gtest.h>

namespace hybridtest {
namespace {

TEST(AppliedLoad, AddsGroundMotionsAndForces) {
  const AppliedLoad load{
      {{Eigen::Vector3d{-1.0, -2.0, 0.0}, {0.0, 3.0}}, {Eigen::Vector3d{0.0, 0.0, -4.0}, {1.0, 2.0}}},
      {{{2, 0}, {1.0, -0.5}, {0.0, 10.0}}, {{2}, {1.0}, {7.0, 1.0}}}};
  EXPECT_TRUE(load.covers(1, 3));
  EXPECT_FALSE(load.covers(2, 3)) << "a step more than the histories have";
  EXPECT_FALSE(load.covers(1, 2)) << "a degree of freedom less";
  Eigen::VectorXd force_n = Eigen::VectorXd::Constant(3, 99.0);
  load.ground_at(1, force_n);
  EXPECT_EQ(force_n, Eigen::Vector3d(-3.0, -6.0, -8.0));
  load.forces_at(1, force_n);
  EXPECT_EQ(force_n, Eigen::Vector3d(-5.0, 0.0, 11.0));
  EXPECT_EQ(load.ground_acceleration(1, 0), 1.0);
  EXPECT_EQ(load.ground_count(), 2U);
  EXPECT_TRUE(load.has_forces());
}

TEST(AppliedLoad, IsZeroWithoutLoads) {
  Eigen::VectorXd force_n = Eigen::VectorXd::Constant(2, 99.0);
  AppliedLoad{}.ground_at(5, force_n);
  EXPECT_TRUE(force_n.isZero(0.0));
  EXPECT_TRUE(AppliedLoad{}.covers(5, 2));
  EXPECT_FALSE(AppliedLoad{}.has_forces());
}

}  // namespace
}  // namespace hybridtest
