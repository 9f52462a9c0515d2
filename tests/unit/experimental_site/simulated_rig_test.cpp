#include "experimental_site/rigs/simulated_rig.hpp"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "core/config_error.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "mechanics/laws/bouc_wen.hpp"
#include "mechanics/laws/elastic.hpp"
#include "mechanics/laws/giuffre_menegotto_pinto.hpp"
#include "plant/sensors/noisy_sensor.hpp"
#include "plant/specimens/elastic_specimen.hpp"
#include "plant/specimens/law_specimen.hpp"
#include "plant/transfer_systems/delay.hpp"
#include "plant/transfer_systems/first_order.hpp"
#include "plant/transfer_systems/ideal.hpp"
#include "plant/transfer_systems/second_order.hpp"
#include "tests/support/allocation_count.hpp"

namespace hybridtest {
namespace {

using namespace std::chrono_literals;

constexpr double kStiffness_n_per_m = 4.0e6;

template <class... Parts>
std::vector<std::unique_ptr<TransferSystem>> transfer_systems(std::unique_ptr<Parts>... parts) {
  std::vector<std::unique_ptr<TransferSystem>> all;
  (all.push_back(std::move(parts)), ...);
  return all;
}

template <class... Laws>
std::unique_ptr<Specimen> specimen_of(std::unique_ptr<Laws>... laws) {
  std::vector<std::unique_ptr<Law>> all;
  (all.push_back(std::move(laws)), ...);
  return std::make_unique<LawSpecimen>(std::move(all));
}

std::unique_ptr<SimulatedRig> one_actuator_rig(const SimulatedRig::SensorNoise& noise = {}) {
  return std::make_unique<SimulatedRig>(transfer_systems(std::make_unique<Delay>(1ms, 1ms)),
                                        specimen_of(std::make_unique<Elastic>(kStiffness_n_per_m)), noise, 1ms);
}

ActuatorCommand command_of(const SiteVector& displacement_m) {
  ActuatorCommand command;
  command.displacement_m = displacement_m;
  return command;
}

ActuatorCommand command_of(double displacement_m) { return command_of(SiteVector{{displacement_m}}); }

RigFeedback feedback_for(int actuators) {
  return {.displacement_m = SiteVector::Zero(actuators), .force_n = SiteVector::Zero(actuators)};
}

/// Force = velocity, to see what the specimen is told.
class Dashpot final : public Law {
 public:
  [[nodiscard]] double trial(double, double velocity_m_per_s) noexcept override { return velocity_m_per_s; }
  void commit() noexcept override { ++commits; }
  void revert() noexcept override {}
  void reset() noexcept override {}
  [[nodiscard]] double initial_stiffness_n_per_m() const noexcept override { return 0.0; }
  int commits = 0;
};

TEST(SimulatedRig, MovesTheSpecimenByItsTransferSystem) {
  const auto rig = one_actuator_rig();
  rig->connect();
  rig->arm();
  RigFeedback feedback = feedback_for(1);
  ASSERT_EQ(rig->exchange(command_of(0.01), feedback), RigStatus::healthy);
  EXPECT_EQ(feedback.displacement_m[0], 0.0);
  EXPECT_EQ(feedback.force_n[0], 0.0);
  ASSERT_EQ(rig->exchange(command_of(0.02), feedback), RigStatus::healthy);
  EXPECT_EQ(feedback.displacement_m[0], 0.01);
  EXPECT_EQ(feedback.force_n[0], 0.01 * kStiffness_n_per_m);
}

TEST(SimulatedRig, ActuatorsAreIndependentAndShareTheSpecimen) {
  SimulatedRig rig{transfer_systems(std::make_unique<Ideal>(), std::make_unique<Delay>(1ms, 1ms)),
                   std::make_unique<ElasticSpecimen>(Eigen::MatrixXd{{2.0, -1.0}, {-1.0, 3.0}}),
                   {},
                   1ms};
  rig.connect();
  rig.arm();
  RigFeedback feedback = feedback_for(2);
  ASSERT_EQ(rig.exchange(command_of(SiteVector{{0.5, -2.0}}), feedback), RigStatus::healthy);
  EXPECT_EQ(feedback.displacement_m, (SiteVector{{0.5, 0.0}}));
  EXPECT_EQ(feedback.force_n, (SiteVector{{1.0, -0.5}}));
  ASSERT_EQ(rig.exchange(command_of(SiteVector{{0.5, -2.0}}), feedback), RigStatus::healthy);
  EXPECT_EQ(feedback.force_n, (SiteVector{{3.0, -6.5}}));
}

TEST(SimulatedRig, PassesVelocityToSpecimenOncePerExchange) {
  auto dashpot = std::make_unique<Dashpot>();
  const Dashpot& seen = *dashpot;
  SimulatedRig rig{transfer_systems(std::make_unique<Ideal>()), specimen_of(std::move(dashpot)), {}, 1ms};
  rig.connect();
  rig.arm();
  RigFeedback feedback = feedback_for(1);
  // At one metre per second and per second squared: the displacement of the past is known to be a parabola.
  for (int i = 1; i <= 20; ++i) {
    const double time_s = 1e-3 * i;
    ASSERT_EQ(rig.exchange(command_of(0.5 * time_s * time_s), feedback), RigStatus::healthy);
    EXPECT_NEAR(feedback.force_n[0], time_s, i > 2 ? 1e-12 : 1e-3);  // it began at rest before the first sample
  }
  rig.stop_motion();
  for (int i = 0; i < 3; ++i) ASSERT_EQ(rig.exchange(command_of(0.5), feedback), RigStatus::healthy);
  EXPECT_EQ(feedback.force_n[0], 0.0);  // it stands still
  EXPECT_EQ(seen.commits, 23);
}

TEST(SimulatedRig, DoesNotMoveBeforeArming) {
  const auto rig = one_actuator_rig();
  RigFeedback feedback = feedback_for(1);
  EXPECT_EQ(rig->exchange(command_of(0.01), feedback), RigStatus::fault);
  EXPECT_THROW(rig->arm(), std::runtime_error);
  rig->connect();
  for (int i = 0; i < 5; ++i) {
    ASSERT_EQ(rig->exchange(command_of(0.01), feedback), RigStatus::healthy);
    EXPECT_EQ(feedback.displacement_m[0], 0.0);
  }
  rig->arm();
  ASSERT_EQ(rig->exchange(command_of(0.02), feedback), RigStatus::healthy);
  EXPECT_EQ(feedback.displacement_m[0], 0.0);  // the delay begins with the motion
}

TEST(SimulatedRig, HoldsAndMeasuresAfterStop) {
  const auto rig = one_actuator_rig({.displacement_noise_m = 1e-6, .force_noise_n = 5.0, .seed = 3});
  rig->connect();
  rig->arm();
  RigFeedback feedback = feedback_for(1);
  for (const double command_m : {0.01, 0.02, 0.03})
    ASSERT_EQ(rig->exchange(command_of(command_m), feedback), RigStatus::healthy);
  rig->stop_motion();
  rig->stop_motion();
  double before_m = feedback.displacement_m[0];
  for (int i = 0; i < 5; ++i) {
    ASSERT_EQ(rig->exchange(command_of(0.05), feedback), RigStatus::healthy);
    EXPECT_NEAR(feedback.displacement_m[0], 0.02, 1e-5);  // where the transfer system was, ten sigma of noise
    EXPECT_NEAR(feedback.force_n[0], 0.02 * kStiffness_n_per_m, 50.0);
    EXPECT_NE(feedback.displacement_m[0], before_m);
    before_m = feedback.displacement_m[0];
  }
  EXPECT_THROW(rig->arm(), std::runtime_error);
}

TEST(SimulatedRig, CannotArmAfterStop) {
  const auto rig = one_actuator_rig();
  rig->connect();
  rig->stop_motion();
  EXPECT_THROW(rig->arm(), std::runtime_error);
  rig->connect();
  EXPECT_NO_THROW(rig->arm());
  EXPECT_NO_THROW(rig->arm());  // already is
}

TEST(SimulatedRig, ReconnectingRepeatsTheRun) {
  SimulatedRig rig{transfer_systems(std::make_unique<SecondOrder>(
                       SecondOrder::Parameters{.natural_frequency_hz = 15.0, .damping_ratio = 0.9, .delay = 4ms}, 1ms)),
                   specimen_of(std::make_unique<Bilinear>(Bilinear::Parameters{
                       .stiffness_n_per_m = kStiffness_n_per_m, .yield_force_n = 4.0e4, .hardening_ratio = 0.05})),
                   {.displacement_noise_m = 1e-5,
                    .force_noise_n = 50.0,
                    .seed = 7,
                    .force_coloured_noise_n = 20.0,
                    .force_correlation_time_s = 0.01},
                   1ms};
  const auto run = [&rig] {
    rig.connect();
    rig.arm();
    std::vector<double> measured;
    RigFeedback feedback = feedback_for(1);
    for (int i = 0; i < 200; ++i) {
      EXPECT_EQ(rig.exchange(command_of(0.05 * std::sin(0.05 * i)), feedback), RigStatus::healthy);
      measured.push_back(feedback.displacement_m[0]);
      measured.push_back(feedback.force_n[0]);
    }
    rig.stop_motion();
    return measured;
  };
  const std::vector<double> first = run();
  EXPECT_EQ(run(), first);
}

TEST(SimulatedRig, ChannelsHaveIndependentNoise) {
  const SimulatedRig::SensorNoise noise{.displacement_noise_m = 1.0, .force_noise_n = 1.0, .seed = 7};
  SimulatedRig rig{transfer_systems(std::make_unique<Ideal>(), std::make_unique<Ideal>()),
                   std::make_unique<ElasticSpecimen>(Eigen::MatrixXd::Identity(2, 2)), noise, 1ms};
  rig.connect();
  RigFeedback feedback = feedback_for(2);
  ASSERT_EQ(rig.exchange(command_of(SiteVector::Zero(2)), feedback), RigStatus::healthy);
  // Each reading is the first draw of its stream, as documented.
  EXPECT_EQ(feedback.displacement_m[0], (Random{7, 0}.normal()));
  EXPECT_EQ(feedback.force_n[0], (Random{7, 1}.normal()));
  EXPECT_EQ(feedback.displacement_m[1], (Random{7, 2}.normal()));
  EXPECT_EQ(feedback.force_n[1], (Random{7, 3}.normal()));
}

TEST(SimulatedRig, ColouredNoiseHasItsTimeAndItsOwnStreams) {
  const SimulatedRig::SensorNoise noise{.displacement_noise_m = 1.0,
                                        .force_noise_n = 1.0,
                                        .seed = 7,
                                        .displacement_coloured_noise_m = 2.0,
                                        .displacement_correlation_time_s = 0.01,
                                        .force_coloured_noise_n = 3.0,
                                        .force_correlation_time_s = 0.02};
  SimulatedRig rig{transfer_systems(std::make_unique<Ideal>(), std::make_unique<Ideal>()),
                   std::make_unique<ElasticSpecimen>(Eigen::MatrixXd::Identity(2, 2)), noise, 1ms};
  const auto sensor = [](std::uint64_t stream, double coloured, double correlation_time_s) {
    return NoisySensor{1.0,
                       Random{7, stream},
                       {.noise = coloured,
                        .correlation = std::exp(-0.001 / correlation_time_s),
                        .random = Random{7, stream + SensorNoise::kToColouredStreams}}};
  };
  std::array displacement{sensor(0, 2.0, 0.01), sensor(2, 2.0, 0.01)};
  std::array force{sensor(1, 3.0, 0.02), sensor(3, 3.0, 0.02)};
  rig.connect();
  RigFeedback feedback = feedback_for(2);
  for (int i = 0; i < 20; ++i) {
    ASSERT_EQ(rig.exchange(command_of(SiteVector::Zero(2)), feedback), RigStatus::healthy);
    for (const Eigen::Index dof : {0, 1}) {
      EXPECT_EQ(feedback.displacement_m[dof], displacement[static_cast<std::size_t>(dof)].read(0.0));
      EXPECT_EQ(feedback.force_n[dof], force[static_cast<std::size_t>(dof)].read(0.0));
    }
  }
}

TEST(SimulatedRig, NonFiniteCommandIsAFaultWithoutMotion) {
  const auto rig = one_actuator_rig();
  rig->connect();
  rig->arm();
  RigFeedback feedback = feedback_for(1);
  ASSERT_EQ(rig->exchange(command_of(0.01), feedback), RigStatus::healthy);
  ASSERT_EQ(rig->exchange(command_of(0.02), feedback), RigStatus::healthy);
  for (const double command_m : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(rig->exchange(command_of(command_m), feedback), RigStatus::fault);
    EXPECT_EQ(feedback.displacement_m[0], 0.01);
    EXPECT_EQ(feedback.force_n[0], 0.01 * kStiffness_n_per_m);
  }
  ASSERT_EQ(rig->exchange(command_of(0.03), feedback), RigStatus::healthy);
  EXPECT_EQ(feedback.displacement_m[0], 0.02);
}

TEST(SimulatedRig, WrongCommandOrFeedbackSizeIsAFault) {
  const auto rig = one_actuator_rig();
  rig->connect();
  rig->arm();
  RigFeedback feedback = feedback_for(1);
  EXPECT_EQ(rig->exchange(command_of(SiteVector::Zero(2)), feedback), RigStatus::fault);
  EXPECT_EQ(rig->exchange(command_of(SiteVector{}), feedback), RigStatus::fault);
  RigFeedback too_small;
  EXPECT_EQ(rig->exchange(command_of(0.0), too_small), RigStatus::fault);
}

TEST(SimulatedRig, NonFiniteForceIsAFault) {
  const auto rig = one_actuator_rig();
  rig->connect();
  rig->arm();
  RigFeedback feedback = feedback_for(1);
  ASSERT_EQ(rig->exchange(command_of(1e305), feedback), RigStatus::healthy);
  EXPECT_EQ(rig->exchange(command_of(1e305), feedback), RigStatus::fault);
  EXPECT_TRUE(feedback.force_n.allFinite());
}

TEST(SimulatedRig, RequiresOneTransferSystemPerDof) {
  EXPECT_THROW((SimulatedRig{transfer_systems(std::make_unique<Ideal>()),
                             std::make_unique<ElasticSpecimen>(Eigen::MatrixXd::Identity(2, 2)),
                             {},
                             1ms}),
               ConfigError);
}

TEST(SimulatedRig, RejectsParametersOutOfRange) {
  const auto make = [](const SimulatedRig::SensorNoise& noise, Duration period) {
    SimulatedRig{transfer_systems(std::make_unique<Ideal>()), specimen_of(std::make_unique<Elastic>(1.0)), noise,
                 period};
  };
  EXPECT_NO_THROW(make({}, 1ms));
  EXPECT_THROW(make({.displacement_noise_m = -1.0}, 1ms), ConfigError);
  EXPECT_THROW(make({.force_noise_n = std::nan("")}, 1ms), ConfigError);
  EXPECT_THROW(make({.displacement_coloured_noise_m = -1.0}, 1ms), ConfigError);
  EXPECT_THROW(make({.force_coloured_noise_n = 1.0}, 1ms), ConfigError) << "no correlation time";
  EXPECT_NO_THROW(make({.force_coloured_noise_n = 1.0, .force_correlation_time_s = 0.01}, 1ms));
  EXPECT_THROW(make({}, 0ms), ConfigError);
}

TEST(SimulatedRig, ExchangeAllocatesNothing) {
  const auto second_order =
      SecondOrder::Parameters{.natural_frequency_hz = 15.0, .damping_ratio = 0.9, .delay = 4500us};
  const BoucWen::Parameters isolator{
      .stiffness_n_per_m = 1.0e6, .alpha = 0.1, .n = 1.4, .gamma_per_m = 50.0, .beta_per_m = 50.0};
  const GiuffreMenegottoPinto::Parameters column{
      .stiffness_n_per_m = 4.0e6, .yield_force_n = 4.0e4, .hardening_ratio = 0.03};
  const Bilinear::Parameters beam{.stiffness_n_per_m = 4.0e6, .yield_force_n = 4.0e4, .hardening_ratio = 0.05};
  SimulatedRig uncoupled{
      transfer_systems(std::make_unique<SecondOrder>(second_order, 1ms), std::make_unique<FirstOrder>(0.01, 1ms),
                       std::make_unique<Delay>(20ms, 1ms), std::make_unique<Ideal>()),
      specimen_of(std::make_unique<BoucWen>(isolator), std::make_unique<GiuffreMenegottoPinto>(column),
                  std::make_unique<Bilinear>(beam), std::make_unique<Elastic>(1.0e6)),
      {.displacement_noise_m = 1e-5,
       .force_noise_n = 50.0,
       .displacement_coloured_noise_m = 1e-5,
       .displacement_correlation_time_s = 0.01,
       .force_coloured_noise_n = 50.0,
       .force_correlation_time_s = 0.01},
      1ms};
  SimulatedRig coupled{transfer_systems(std::make_unique<Ideal>(), std::make_unique<Ideal>()),
                       std::make_unique<ElasticSpecimen>(Eigen::MatrixXd{{2.0, -1.0}, {-1.0, 3.0}}),
                       {},
                       1ms};
  for (SimulatedRig* rig : {&uncoupled, &coupled}) {
    rig->connect();
    rig->arm();
    const int actuators = rig == &uncoupled ? 4 : 2;
    RigFeedback feedback = feedback_for(actuators);
    ActuatorCommand command = command_of(SiteVector::Zero(actuators));
    const std::size_t before = allocation_count();
    bool is_healthy = true;
    for (int i = 0; i < 2000; ++i) {
      command.displacement_m.setConstant(0.05 * std::sin(0.01 * i));
      is_healthy = rig->exchange(command, feedback) == RigStatus::healthy && is_healthy;
    }
    rig->stop_motion();
    is_healthy = rig->exchange(command, feedback) == RigStatus::healthy && is_healthy;
    EXPECT_EQ(allocation_count(), before);
    EXPECT_TRUE(is_healthy);
  }
}

TEST(SimulatedRig, AllocationCounterCounts) {
  const std::size_t before = allocation_count();
  const std::vector<double> allocated(100);
  EXPECT_EQ(allocation_count(), before + 1);
  const auto rig = one_actuator_rig();
  EXPECT_GT(allocation_count(), before + 2);
}

}  // namespace
}  // namespace hybridtest
