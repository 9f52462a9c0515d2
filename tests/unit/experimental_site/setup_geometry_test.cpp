#include "experimental_site/geometry/setup_geometry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/config_error.hpp"
#include "core/random.hpp"
#include "experimental_site/geometry/linear_geometry.hpp"
#include "experimental_site/geometry/rigid_beam.hpp"
#include "tests/support/allocation_count.hpp"

namespace hybridtest {
namespace {

/// Actuators one above the other, 2 m long and 1.2 m apart, on a beam that stands upright.
RigidBeam upright_beam() {
  return RigidBeam{{{{.attachment_m = {0.0, 0.6}, .anchor_m = {-2.0, 0.6}},
                     {.attachment_m = {0.0, -0.6}, .anchor_m = {-2.0, -0.6}}}}};
}

/// Anywhere in the plane, with arms of moment of 0.4 m and more between their lines of action.
RigidBeam drawn_beam(Random& random) {
  const double upper_m = random.uniform(0.3, 1.5);
  const double lower_m = random.uniform(-1.5, -0.3);
  return RigidBeam{{{{.attachment_m = {random.uniform(-0.3, 0.3), upper_m},
                      .anchor_m = {random.uniform(-4.0, -1.5), upper_m + random.uniform(-0.1, 0.1)}},
                     {.attachment_m = {random.uniform(-0.3, 0.3), lower_m},
                      .anchor_m = {random.uniform(-4.0, -1.5), lower_m + random.uniform(-0.1, 0.1)}}}}};
}

SiteVector drawn_pose(Random& random) { return SiteVector{{random.uniform(-0.5, 0.5), random.uniform(-0.3, 0.3)}}; }

SiteVector strokes_of(const SetupGeometry& geometry, const SiteVector& pose) {
  SiteVector stroke_m{geometry.actuators()};
  geometry.strokes(pose, stroke_m);
  return stroke_m;
}

TEST(RigidBeam, TranslationMovesBothActuatorsEqually) {
  const SiteVector stroke_m = strokes_of(upright_beam(), SiteVector{{0.25, 0.0}});
  EXPECT_DOUBLE_EQ(stroke_m[0], 0.25);
  EXPECT_DOUBLE_EQ(stroke_m[1], 0.25);
}

TEST(RigidBeam, RotationMatchesClosedForm) {
  // The upper attachment goes to 0.6 (-sin, cos): law of cosines by hand.
  const double theta = 0.4;
  const SiteVector stroke_m = strokes_of(upright_beam(), SiteVector{{0.0, theta}});
  const double across_m = 0.6 * (1.0 - std::cos(theta));
  EXPECT_DOUBLE_EQ(stroke_m[0], std::hypot(2.0 - 0.6 * std::sin(theta), across_m) - 2.0);
  EXPECT_DOUBLE_EQ(stroke_m[1], std::hypot(2.0 + 0.6 * std::sin(theta), across_m) - 2.0);
  EXPECT_LT(stroke_m[0], 0.0) << "positive from x to y: the upper end goes back";
}

TEST(RigidBeam, PoseRoundTripsThroughStrokes) {
  Random random{11};
  for (int i = 0; i < 10'000; ++i) {
    const RigidBeam beam = drawn_beam(random);
    const SiteVector pose = drawn_pose(random);
    SiteVector found = SiteVector::Zero(2);
    ASSERT_TRUE(find_pose(beam, strokes_of(beam, pose), found)) << i << ": " << pose.transpose();
    ASSERT_LE((found - pose).cwiseAbs().maxCoeff(), 1e-12) << i << ": " << pose.transpose();
  }
}

/// The largest relative difference between F_actuator . dL and F_dof . dq over random poses, forces and motions,
/// dL by central differences over 2 h.
double largest_work_difference(double h, bool is_force_transferred) {
  Random random{12};
  double largest = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const RigidBeam beam = drawn_beam(random);
    const SiteVector pose = drawn_pose(random);
    const SiteVector force_n{{1e5 * random.normal(), 1e5 * random.normal()}};
    const SiteVector motion{{random.normal(), random.normal()}};
    SiteVector dof_force = force_n;
    if (is_force_transferred) transfer_forces(beam, pose, force_n, dof_force);
    const SiteVector extension_m =
        (strokes_of(beam, pose + h * motion) - strokes_of(beam, pose - h * motion)) / (2.0 * h);
    const double scale = force_n.norm() * motion.norm();
    largest = std::max(largest, std::abs(force_n.dot(extension_m) - dof_force.dot(motion)) / scale);
  }
  return largest;
}

TEST(RigidBeam, ForcesDoTheSameVirtualWork) {
  // A central difference with h = 1e-5 is off by h^2 / 6 of the third derivative, which arms of up to 1.5 m, lengths
  // from 1 m on and motions of up to three standard deviations keep below 30: 5e-10. Rounding: 4e-16 / h = 4e-11.
  EXPECT_LE(largest_work_difference(1e-5, true), 6e-10);
  // Of second order, so it is the difference's error that is seen, and no error of the forces.
  const double ratio = largest_work_difference(1e-3, true) / largest_work_difference(5e-4, true);
  EXPECT_NEAR(ratio, 4.0, 0.1);
  // Control: forces that are not transferred are seen.
  EXPECT_GT(largest_work_difference(1e-5, false), 0.1);
}

TEST(RigidBeam, StrokesWithoutPoseAreNotFound) {
  const RigidBeam beam = upright_beam();
  SiteVector pose{{0.1, 0.05}};
  const SiteVector before = pose;
  EXPECT_FALSE(find_pose(beam, SiteVector{{3.0, -1.9}}, pose)) << "further apart than the beam is long";
  EXPECT_FALSE(find_pose(beam, SiteVector{{std::numeric_limits<double>::quiet_NaN(), 0.0}}, pose));
  EXPECT_FALSE(find_pose(beam, SiteVector{{std::numeric_limits<double>::infinity(), 0.0}}, pose));
  EXPECT_EQ(pose, before);
}

TEST(RigidBeam, RejectsActuatorsThatDoNotHoldTheBeam) {
  const Eigen::Vector2d point{0.0, 0.5};
  EXPECT_THROW((RigidBeam{{{{point, point}, {{0.0, -0.5}, {-2.0, -0.5}}}}}), ConfigError) << "no length";
  EXPECT_THROW((RigidBeam{{{{point, {-2.0, 0.5}}, {{0.3, 0.5}, {2.0, 0.5}}}}}), ConfigError) << "one line";
  EXPECT_THROW((RigidBeam{{{{{-1.0, 0.0}, {-1.0, -2.0}}, {{1.0, 0.0}, {1.0, -2.0}}}}}), ConfigError)
      << "both across the displacement";
}

TEST(LinearGeometry, MapsByItsMatrix) {
  const LinearGeometry geometry{Eigen::MatrixXd{{1.0, 0.5}, {1.0, -0.5}}};
  EXPECT_EQ(strokes_of(geometry, SiteVector{{0.25, 0.75}}), (SiteVector{{0.625, -0.125}}));
  SiteVector dof_force{2};
  transfer_forces(geometry, SiteVector::Zero(2), SiteVector{{10.0, 4.0}}, dof_force);
  EXPECT_EQ(dof_force, (SiteVector{{14.0, 3.0}}));
}

TEST(LinearGeometry, RedundantActuatorsGiveLeastSquaresPose) {
  const LinearGeometry geometry{Eigen::MatrixXd{{1.0}, {1.0}, {2.0}}};
  SiteVector pose = SiteVector::Zero(1);
  ASSERT_TRUE(find_pose(geometry, SiteVector{{0.1, 0.2, 0.3}}, pose));
  // (0.1 + 0.2 + 2 * 0.3) / (1 + 1 + 4)
  EXPECT_NEAR(pose[0], 0.15, 1e-16);
}

TEST(LinearGeometry, RejectsUnheldDegreeOfFreedom) {
  EXPECT_THROW(LinearGeometry{(Eigen::MatrixXd{{1.0, 2.0}})}, ConfigError) << "fewer actuators than dofs";
  EXPECT_THROW(LinearGeometry{(Eigen::MatrixXd{{1.0, 2.0}, {2.0, 4.0}, {3.0, 6.0}})}, ConfigError) << "rank";
  EXPECT_THROW(LinearGeometry{Eigen::MatrixXd::Ones(13, 1)}, ConfigError);
  EXPECT_NO_THROW(LinearGeometry{Eigen::MatrixXd::Ones(12, 1)});
}

TEST(SetupGeometry, DoesNotAllocate) {
  const RigidBeam beam = upright_beam();
  const LinearGeometry full{Eigen::MatrixXd::Identity(12, 12)};
  SiteVector pose = SiteVector::Zero(2);
  SiteVector full_pose = SiteVector::Zero(12);
  SiteVector force = SiteVector::Ones(2);
  const SiteVector stroke_m = strokes_of(beam, SiteVector{{0.2, 0.1}});
  const std::size_t before = allocation_count();
  const bool is_found = find_pose(beam, stroke_m, pose) && find_pose(full, SiteVector::Ones(12), full_pose);
  transfer_forces(beam, pose, stroke_m, force);
  EXPECT_EQ(allocation_count(), before);
  EXPECT_TRUE(is_found);
}

}  // namespace
}  // namespace hybridtest
