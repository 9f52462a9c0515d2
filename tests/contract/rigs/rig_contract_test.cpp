// The contract of every Rig (experimental_site/rigs/rig.hpp), tested on each of them. For your own rig: write a bench
// like those below and add it to AllRigs.

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <limits>
#include <memory>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "experimental_site/geometry/rigid_beam.hpp"
#include "experimental_site/geometry/transformed_rig.hpp"
#include "experimental_site/rigs/replay_rig.hpp"
#include "experimental_site/rigs/simulated_rig.hpp"
#include "experimental_site/rigs/udp_rig.hpp"
#include "mechanics/laws/elastic.hpp"
#include "plant/specimens/law_specimen.hpp"
#include "plant/transfer_systems/second_order.hpp"
#include "tests/contract/rigs/example_rig.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/echo_port.hpp"

namespace hybridtest {
namespace {

using namespace std::chrono_literals;

constexpr double kStiffness_n_per_m = 1.0e6;
constexpr Duration kControlPeriod = 1ms;

// A bench makes a rig as new and says how many actuators it has (or degrees of freedom, which is the same from
// above). After some exchanges with one command other than zero the rig is elsewhere than at rest.

struct SimulatedBench {
  static constexpr int kActuators = 2;
  std::unique_ptr<Rig> make() {
    std::vector<std::unique_ptr<TransferSystem>> transfer_systems;
    std::vector<std::unique_ptr<Law>> laws;
    for (int i = 0; i < kActuators; ++i) {
      transfer_systems.push_back(std::make_unique<SecondOrder>(
          SecondOrder::Parameters{.natural_frequency_hz = 50.0, .damping_ratio = 0.7, .delay = 2ms}, kControlPeriod));
      laws.push_back(std::make_unique<Elastic>(kStiffness_n_per_m));
    }
    return std::make_unique<SimulatedRig>(std::move(transfer_systems), std::make_unique<LawSpecimen>(std::move(laws)),
                                          SimulatedRig::SensorNoise{}, kControlPeriod);
  }
};

struct UdpBench {
  static constexpr int kActuators = 3;
  std::unique_ptr<Rig> make() {
    UdpRig::Settings settings;
    settings.name = "echo";
    settings.actuators = kActuators;
    settings.control_period = kControlPeriod;
    settings.watchdog = 10 * kControlPeriod;
    settings.connect_timeout = 1s;
    return std::make_unique<UdpRig>(settings, std::make_unique<EchoPort>(kStiffness_n_per_m));
  }
};

struct ReplayBench {
  static constexpr int kActuators = 1;
  std::unique_ptr<Rig> make() {
    RecordedMeasurement record;
    for (int row = 0; row < 1000; ++row) {
      record.time_s.push_back(5.0 + 0.0007 * row);
      record.displacement_m.push_back(SiteVector{{1e-4 * row}});
      record.force_n.push_back(SiteVector{{1e2 * row}});
    }
    return std::make_unique<ReplayRig>(std::move(record), ReplayRig::AtEnd::hold);
  }
};

struct TransformedBench {
  static constexpr int kActuators = 2;
  std::unique_ptr<Rig> make() {
    return std::make_unique<TransformedRig>(
        SimulatedBench{}.make(),
        std::make_unique<RigidBeam>(std::array<RigidBeam::Actuator, 2>{RigidBeam::Actuator{{0.0, 0.6}, {-2.0, 0.6}},
                                                                       RigidBeam::Actuator{{0.0, -0.6}, {-2.0, -0.6}}}),
        0.5);
  }
};

/// The example of docs/writing_a_rig.md, with a drive in software.
struct ExampleBench {
  static constexpr int kActuators = 1;

  class SpringDrive final : public Drive {
   public:
    bool open(const std::string&) override { return true; }
    void enable(bool on) noexcept override { is_enabled_ = on; }
    bool write_target_mm(double target_mm) noexcept override {
      if (is_enabled_) position_mm_ = target_mm;
      return true;
    }
    bool read(double& position_mm, double& force_kn) noexcept override {
      position_mm = position_mm_;
      force_kn = 1e-6 * kStiffness_n_per_m * position_mm_;
      return true;
    }

   private:
    std::atomic<bool> is_enabled_{false};
    double position_mm_ = 0.0;
  };

  std::unique_ptr<Rig> make() { return std::make_unique<DriveRig>("axis_1", drive_); }
  SpringDrive drive_;
};

template <class Bench>
class RigContract : public testing::Test {
 protected:
  static constexpr int kActuators = Bench::kActuators;

  RigContract() {
    command_.displacement_m = SiteVector::Zero(kActuators);
    feedback_ = {SiteVector::Zero(kActuators), SiteVector::Zero(kActuators)};
  }

  void arm() {
    rig_->connect();
    rig_->arm();
  }
  /// One control period with the same command for every actuator.
  [[nodiscard]] RigStatus exchange(double command_m) {
    command_.displacement_m.setConstant(command_m);
    const RigStatus status = rig_->exchange(command_, feedback_);
    ++command_.sample;
    command_.time_s = static_cast<double>(command_.sample) * to_seconds(kControlPeriod);
    return status;
  }
  void exchange_all(double command_m) {
    for (int i = 0; i < 50; ++i) ASSERT_EQ(exchange(command_m), RigStatus::healthy) << i;
  }

  static constexpr double kCommand_m = 0.02;
  Bench bench_;
  std::unique_ptr<Rig> rig_ = bench_.make();
  ActuatorCommand command_;
  RigFeedback feedback_;
};

using AllRigs = testing::Types<SimulatedBench, UdpBench, ReplayBench, TransformedBench, ExampleBench>;
TYPED_TEST_SUITE(RigContract, AllRigs);

TYPED_TEST(RigContract, ExchangeBeforeConnectIsAFault) { EXPECT_EQ(this->exchange(0.0), RigStatus::fault); }

TYPED_TEST(RigContract, MeasuresWithoutMovingBeforeArming) {
  this->rig_->connect();
  ASSERT_EQ(this->exchange(0.0), RigStatus::healthy);
  const RigFeedback at_rest = this->feedback_;
  this->exchange_all(this->kCommand_m);
  EXPECT_EQ(this->feedback_.displacement_m, at_rest.displacement_m);
}

TYPED_TEST(RigContract, MovesAndMeasuresFiniteNumbersWhenArmed) {
  this->arm();
  ASSERT_EQ(this->exchange(0.0), RigStatus::healthy);
  const RigFeedback at_rest = this->feedback_;
  this->exchange_all(this->kCommand_m);
  EXPECT_NE(this->feedback_.displacement_m, at_rest.displacement_m);
  EXPECT_TRUE(this->feedback_.displacement_m.allFinite() && this->feedback_.force_n.allFinite());
}

TYPED_TEST(RigContract, ArmFailsWithoutConnection) { EXPECT_THROW(this->rig_->arm(), std::runtime_error); }

TYPED_TEST(RigContract, ArmingTwiceHasNoFurtherEffect) {
  this->arm();
  EXPECT_NO_THROW(this->rig_->arm());
  EXPECT_EQ(this->exchange(0.0), RigStatus::healthy);
}

TYPED_TEST(RigContract, StandsStillAndMeasuresAfterStop) {
  this->arm();
  this->exchange_all(this->kCommand_m);
  this->rig_->stop_motion();
  ASSERT_EQ(this->exchange(0.0), RigStatus::healthy);
  const RigFeedback stopped = this->feedback_;
  this->exchange_all(-this->kCommand_m);
  EXPECT_EQ(this->feedback_.displacement_m, stopped.displacement_m);
}

TYPED_TEST(RigContract, StopPersistsUntilReconnected) {
  this->arm();
  this->rig_->stop_motion();
  EXPECT_THROW(this->rig_->arm(), std::runtime_error);
  EXPECT_NO_THROW(this->arm());
  EXPECT_EQ(this->exchange(0.0), RigStatus::healthy);
}

TYPED_TEST(RigContract, StopIsAcceptedInEveryStateRepeatedly) {
  this->rig_->stop_motion();
  this->rig_->connect();
  this->rig_->stop_motion();
  this->rig_->stop_motion();
  EXPECT_THROW(this->rig_->arm(), std::runtime_error);
  this->arm();
  this->rig_->stop_motion();
  this->rig_->stop_motion();
}

TYPED_TEST(RigContract, InvalidCommandIsAFaultWithoutMotion) {
  this->arm();
  this->exchange_all(this->kCommand_m);
  const RigFeedback before = this->feedback_;
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(this->exchange(none), RigStatus::fault);
  EXPECT_EQ(this->exchange(std::numeric_limits<double>::infinity()), RigStatus::fault);
  EXPECT_EQ(this->feedback_.displacement_m, before.displacement_m) << "with a fault the feedback is the last good one";
  EXPECT_EQ(this->feedback_.force_n, before.force_n);
  this->command_.displacement_m = SiteVector::Zero(this->kActuators + 1);
  EXPECT_EQ(this->rig_->exchange(this->command_, this->feedback_), RigStatus::fault);
}

TYPED_TEST(RigContract, WrongFeedbackSizeIsAFault) {
  this->arm();
  this->feedback_.force_n = SiteVector::Zero(this->kActuators + 1);
  EXPECT_EQ(this->exchange(0.0), RigStatus::fault);
}

TYPED_TEST(RigContract, ExchangeDoesNotAllocate) {
  this->arm();
  ASSERT_EQ(this->exchange(0.0), RigStatus::healthy);
  const std::size_t before = allocation_count();
  for (int i = 0; i < 50; ++i) static_cast<void>(this->exchange(this->kCommand_m));
  this->rig_->stop_motion();
  EXPECT_EQ(allocation_count(), before);
}

TYPED_TEST(RigContract, StopFromAnotherThreadDuringExchange) {
  this->arm();
  std::atomic<bool> has_begun{false};
  std::thread other{[&] {
    has_begun.wait(false);
    this->rig_->stop_motion();
  }};
  for (int i = 0; i < 200; ++i) {
    static_cast<void>(this->exchange(this->kCommand_m));
    if (!has_begun.exchange(true)) has_begun.notify_one();
  }
  other.join();
  ASSERT_EQ(this->exchange(0.0), RigStatus::healthy);
  const RigFeedback stopped = this->feedback_;
  this->exchange_all(-this->kCommand_m);
  EXPECT_EQ(this->feedback_.displacement_m, stopped.displacement_m);
}

TYPED_TEST(RigContract, CanBeUsedAgainAfterReconnecting) {
  this->arm();
  this->exchange_all(this->kCommand_m);
  this->rig_->stop_motion();
  this->command_.sample = 0;
  this->command_.time_s = 0.0;
  this->arm();
  this->exchange_all(0.0);
}

}  // namespace
}  // namespace hybridtest
