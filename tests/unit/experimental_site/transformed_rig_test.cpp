#include "experimental_site/geometry/transformed_rig.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <utility>

#include "experimental_site/geometry/linear_geometry.hpp"
#include "experimental_site/geometry/rigid_beam.hpp"
#include "tests/support/kept_rows.hpp"
#include "tests/support/scripted_rig.hpp"

namespace hybridtest {
namespace {

constexpr double kStiffness_n_per_m = 1.0e6;

std::unique_ptr<SetupGeometry> two_beside_each_other() {
  return std::make_unique<LinearGeometry>(Eigen::MatrixXd{{1.0, 0.5}, {1.0, -0.5}});
}

/// A transformed rig with the one inside it.
struct Bench {
  explicit Bench(std::unique_ptr<SetupGeometry> geometry,
                 double stroke_limit_m = std::numeric_limits<double>::infinity(),
                 ScriptedRig::Answer answer = ideal_spring_rig(kStiffness_n_per_m)) {
    auto own_rig = std::make_unique<ScriptedRig>(std::move(answer));
    inside = own_rig.get();
    rig = std::make_unique<TransformedRig>(std::move(own_rig), std::move(geometry), stroke_limit_m);
    rig->connect();
    rig->arm();
  }
  [[nodiscard]] RigStatus exchange(double displacement_m, double rotation) {
    command.displacement_m = SiteVector{{displacement_m, rotation}};
    const RigStatus status = rig->exchange(command, feedback);
    ++command.sample;
    return status;
  }

  ScriptedRig* inside = nullptr;
  std::unique_ptr<TransformedRig> rig;
  ActuatorCommand command;
  RigFeedback feedback{SiteVector::Zero(2), SiteVector::Zero(2)};
};

TEST(TransformedRig, CommandsInActuatorsAndMeasuresInDofs) {
  Bench bench{two_beside_each_other()};
  ASSERT_EQ(bench.exchange(0.25, 0.75), RigStatus::healthy);
  EXPECT_EQ(bench.inside->commands.back().displacement_m, (SiteVector{{0.625, -0.125}}));
  EXPECT_NEAR(bench.feedback.displacement_m[0], 0.25, 1e-16);
  EXPECT_NEAR(bench.feedback.displacement_m[1], 0.75, 2e-16);
  // T^T k T = k diag(2, 0.5)
  EXPECT_NEAR(bench.feedback.force_n[0], 2.0 * kStiffness_n_per_m * 0.25, 1e-9);
  EXPECT_NEAR(bench.feedback.force_n[1], 0.5 * kStiffness_n_per_m * 0.75, 1e-9);
}

TEST(TransformedRig, MeasuresActualPoseOfTheBeam) {
  // Actuators that go half of the way: neither half the displacement nor half the rotation.
  Bench bench{std::make_unique<RigidBeam>(std::array<RigidBeam::Actuator, 2>{
                  RigidBeam::Actuator{{0.0, 0.6}, {-2.0, 0.6}}, RigidBeam::Actuator{{0.0, -0.6}, {-2.0, -0.6}}}),
              1.0, [](const ActuatorCommand& command, RigFeedback& feedback) {
                feedback.displacement_m = 0.5 * command.displacement_m;
                feedback.force_n = SiteVector{{100.0, 300.0}};
                return RigStatus::healthy;
              }};
  ASSERT_EQ(bench.exchange(0.2, 0.3), RigStatus::healthy);
  const RigidBeam beam{{RigidBeam::Actuator{{0.0, 0.6}, {-2.0, 0.6}}, RigidBeam::Actuator{{0.0, -0.6}, {-2.0, -0.6}}}};
  SiteVector stroke_m{2};
  beam.strokes(bench.feedback.displacement_m, stroke_m);
  EXPECT_NEAR((stroke_m - 0.5 * bench.inside->commands.back().displacement_m).norm(), 0.0, 1e-15);
  SiteVector expected{2};
  transfer_forces(beam, bench.feedback.displacement_m, SiteVector{{100.0, 300.0}}, expected);
  EXPECT_EQ(bench.feedback.force_n, expected) << "forces act at the measured pose";
}

TEST(TransformedRig, StrokeBeyondLimitIsClippedAndAFault) {
  Bench bench{two_beside_each_other(), 0.3};
  EXPECT_EQ(bench.exchange(0.3, 0.0), RigStatus::healthy);
  EXPECT_EQ(bench.exchange(0.2, 0.5), RigStatus::fault);
  EXPECT_EQ(bench.inside->commands.back().displacement_m, (SiteVector{{0.3, 0.2 - 0.5 * 0.5}}));
  EXPECT_EQ(bench.exchange(-0.2, 0.5), RigStatus::fault);
  EXPECT_EQ(bench.inside->commands.back().displacement_m[1], -0.3);
  EXPECT_EQ(bench.exchange(0.1, 0.0), RigStatus::healthy);
}

TEST(TransformedRig, MeasurementWithoutPoseIsAFaultAndKeepsLastGood) {
  bool is_broken = false;
  Bench bench{two_beside_each_other(), 1.0, [&](const ActuatorCommand& command, RigFeedback& feedback) {
                feedback.displacement_m = command.displacement_m;
                if (is_broken) feedback.displacement_m[1] = std::numeric_limits<double>::quiet_NaN();
                feedback.force_n = command.displacement_m;
                return RigStatus::healthy;
              }};
  ASSERT_EQ(bench.exchange(0.1, 0.0), RigStatus::healthy);
  const SiteVector good_m = bench.feedback.displacement_m;
  is_broken = true;
  EXPECT_EQ(bench.exchange(0.2, 0.0), RigStatus::fault);
  EXPECT_EQ(bench.feedback.displacement_m, good_m);
  is_broken = false;
  EXPECT_EQ(bench.exchange(0.3, 0.0), RigStatus::healthy);
}

TEST(TransformedRig, ForwardsStopsAndFaults) {
  Bench bench{two_beside_each_other(), 1.0, [](const ActuatorCommand&, RigFeedback&) { return RigStatus::fault; }};
  EXPECT_EQ(bench.exchange(0.1, 0.0), RigStatus::fault);
  bench.rig->stop_motion();
  EXPECT_EQ(bench.inside->stops, 1);
  bench.command.displacement_m = SiteVector{{0.1}};
  EXPECT_EQ(bench.rig->exchange(bench.command, bench.feedback), RigStatus::fault) << "a command of another size";
}

TEST(TransformedRig, RecordsItsActuators) {
  Bench bench{two_beside_each_other()};
  KeptRows rows{TransformedRig::actuators_layout(2)};
  bench.rig->record_to([&](std::string_view) -> RowSink& { return rows; });
  ASSERT_EQ(bench.exchange(0.25, 0.75), RigStatus::healthy);
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows.at(0, rows.column("command_stroke_m_1")), 0.625);
  EXPECT_EQ(rows.at(0, rows.column("measured_stroke_m_2")), -0.125);
  EXPECT_EQ(rows.at(0, rows.column("measured_actuator_force_n_1")), 0.625 * kStiffness_n_per_m);
}

}  // namespace
}  // namespace hybridtest
