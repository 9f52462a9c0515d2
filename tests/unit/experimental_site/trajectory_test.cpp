#include "experimental_site/trajectory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/random.hpp"

namespace hybridtest {
namespace {

constexpr double kStep = 0.01;
constexpr double kAmplitude = 0.05;
constexpr double kOmega = 2.0 * std::numbers::pi;

TargetPoint sine_target(Step step) {
  const double time = static_cast<double>(step) * kStep;
  TargetPoint point;
  point.step = step;
  point.model_time_s = time;
  point.displacement_m = SiteVector::Constant(1, kAmplitude * std::sin(kOmega * time));
  point.velocity_m_per_s = SiteVector::Constant(1, kAmplitude * kOmega * std::cos(kOmega * time));
  point.acceleration_m_per_s2 = SiteVector::Constant(1, -kAmplitude * kOmega * kOmega * std::sin(kOmega * time));
  return point;
}

TEST(TrajectoryTest, ReachesEachTargetExactlyAtItsTime) {
  Trajectory trajectory{1, kStep, 1.0};
  trajectory.reset(SiteVector::Zero(1));
  ReachedTarget reached;
  trajectory.set_target(sine_target(0));
  ASSERT_TRUE(trajectory.advance(kStep / 4, reached));
  EXPECT_EQ(trajectory.point().path_time_s, 0.0);
  for (Step step = 1; step <= 200; ++step) {
    trajectory.set_target(sine_target(step));
    for (int period = 0; period < 3; ++period) ASSERT_FALSE(trajectory.advance(kStep / 4, reached));
    ASSERT_TRUE(trajectory.advance(kStep / 4, reached));
    EXPECT_EQ(reached.step, step);
    EXPECT_EQ(reached.fraction, 1.0);
    EXPECT_FALSE(any(reached.flags));
    EXPECT_EQ(trajectory.point().displacement_m[0], sine_target(step).displacement_m[0]) << "to the last bit";
  }
}

TEST(TrajectoryTest, IsCubicBetweenKnownTargets) {
  // The error of cubic Hermite interpolation is at most h^4/384 max|x''''|.
  Trajectory trajectory{1, kStep, 1.0};
  ReachedTarget reached;
  trajectory.set_target(sine_target(0));
  static_cast<void>(trajectory.advance(kStep / 8, reached));
  const double bound = std::pow(kStep, 4) / 384.0 * kAmplitude * std::pow(kOmega, 4);
  double worst = 0.0;
  for (Step step = 1; step <= 100; ++step) {
    trajectory.set_target(sine_target(step));
    for (int period = 0; period < 8; ++period) {
      static_cast<void>(trajectory.advance(kStep / 8, reached));
      const double exact = kAmplitude * std::sin(kOmega * trajectory.point().path_time_s);
      // The first piece starts at rest where the sine moves: it is the soft start, not the cubic.
      if (step > 1) worst = std::max(worst, std::abs(trajectory.point().displacement_m[0] - exact));
    }
  }
  EXPECT_LE(worst, bound * (1.0 + 1e-6));
  EXPECT_GE(worst, 0.5 * bound) << "the bound is sharp; a smaller error means that nothing was measured";
}

TEST(TrajectoryTest, SlowsDownAndWaitsForLateTarget) {
  Trajectory trajectory{1, kStep, 1.0};
  ReachedTarget reached;
  trajectory.set_target(sine_target(0));
  static_cast<void>(trajectory.advance(kStep / 10, reached));
  for (int period = 0; period < 1000; ++period) ASSERT_FALSE(trajectory.advance(kStep / 10, reached));
  EXPECT_LT(trajectory.point().path_time_s, kStep);
  EXPECT_GT(trajectory.point().path_time_s, 0.99 * kStep);
  EXPECT_TRUE(trajectory.point().is_held);
  EXPECT_NEAR(trajectory.point().velocity_m_per_s[0], 0.0, 1e-9);

  trajectory.set_target(sine_target(1));
  bool is_reached = false;
  for (int period = 0; period < 20 && !is_reached; ++period) is_reached = trajectory.advance(kStep / 10, reached);
  ASSERT_TRUE(is_reached);
  EXPECT_TRUE(any(reached.flags & MeasurementFlags::held));
  EXPECT_TRUE(any(reached.flags & MeasurementFlags::late));
}

struct PathCase {
  const char* name;
  TrajectorySettings settings;
};

const PathCase kPaths[] = {{"order_1", {.order = 1}},
                           {"order_2", {.order = 2}},
                           {"order_3", {.order = 3}},
                           {"ramp_and_hold", {.type = TrajectoryType::ramp_and_hold, .hold_share = 0.2}},
                           {"ramp_without_hold", {.type = TrajectoryType::ramp_and_hold, .hold_share = 0.0}}};

/// How fast and how abruptly a path moves over a run with random arrival times.
struct Roughness {
  double fastest_m_per_s = 0.0;
  /// Second difference of the position over the period squared: a jump of the velocity by dv shows
  /// as dv / period.
  double largest_acceleration = 0.0;
  int reached = 0;
};

Roughness roughness(std::uint64_t seed, double period_s, const TrajectorySettings& settings) {
  Random random{seed};
  Trajectory trajectory{1, kStep, 1.0, settings};
  ReachedTarget reached;
  trajectory.set_target(sine_target(0));
  static_cast<void>(trajectory.advance(period_s, reached));
  Step next = 1;
  double wait_s = 0.0;
  double before = 0.0;
  double here = 0.0;
  Roughness found;
  for (double time_s = 0.0; time_s < 80.0 * kStep; time_s += period_s) {
    wait_s -= period_s;
    if (!trajectory.has_target() && wait_s <= 0.0) {
      trajectory.set_target(sine_target(next++));
      wait_s = random.uniform(0.2, 2.5) * kStep;  // from comfortably early to more than a step late
    }
    if (trajectory.advance(period_s, reached)) ++found.reached;
    const double there = trajectory.point().displacement_m[0];
    if (time_s > 1.5 * period_s) {
      found.fastest_m_per_s = std::max(found.fastest_m_per_s, std::abs(there - here) / period_s);
      found.largest_acceleration =
          std::max(found.largest_acceleration, std::abs(there - 2.0 * here + before) / (period_s * period_s));
    }
    before = here;
    here = there;
  }
  return found;
}

class EveryPath : public testing::TestWithParam<PathCase> {};

TEST_P(EveryPath, PositionAndVelocityStayContinuous) {
  // A continuous position has a velocity that stays bounded as the sampling gets finer, a
  // continuous velocity an acceleration; a jump would make it eight times as large here.
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Roughness coarse = roughness(seed, kStep / 50, GetParam().settings);
    const Roughness fine = roughness(seed, kStep / 400, GetParam().settings);
    EXPECT_GT(fine.reached, 30) << "seed " << seed;
    EXPECT_LT(fine.fastest_m_per_s, 2.0 * coarse.fastest_m_per_s) << "seed " << seed;
    EXPECT_LT(fine.largest_acceleration, 2.0 * coarse.largest_acceleration) << "seed " << seed;
  }
}

TEST_P(EveryPath, ReachesTimelyTargetsExactly) {
  Trajectory trajectory{1, kStep, 1.0, GetParam().settings};
  ReachedTarget reached;
  trajectory.set_target(sine_target(0));
  ASSERT_TRUE(trajectory.advance(kStep / 8, reached));
  for (Step step = 1; step <= 100; ++step) {
    for (int period = 1; period <= 8; ++period) {
      if (period == 4) trajectory.set_target(sine_target(step));
      const bool is_reached = trajectory.advance(kStep / 8, reached);
      if (GetParam().settings.type == TrajectoryType::predictor_corrector) {
        ASSERT_EQ(is_reached, period == 8) << step;
      }
    }
    // Ramp and hold takes its whole step from when it knows the target.
    while (trajectory.has_target()) static_cast<void>(trajectory.advance(kStep / 8, reached));
    EXPECT_EQ(trajectory.point().displacement_m[0], sine_target(step).displacement_m[0]) << step;
  }
}

INSTANTIATE_TEST_SUITE_P(Paths, EveryPath, testing::ValuesIn(kPaths), [](const auto& path) { return path.param.name; });

TEST(TrajectoryTest, PredictsPolynomialsOfItsOrderOnlyExactly) {
  for (int order = 1; order <= 3; ++order) {
    for (int degree = 1; degree <= 4; ++degree) {
      // x = t^degree; the velocity and acceleration that go with it are sent.
      const auto target = [&](Step step) {
        const double time = static_cast<double>(step) * kStep;
        TargetPoint point;
        point.step = step;
        point.model_time_s = time;
        point.displacement_m = SiteVector::Constant(1, std::pow(time, degree));
        point.velocity_m_per_s = SiteVector::Constant(1, degree * std::pow(time, degree - 1));
        point.acceleration_m_per_s2 =
            SiteVector::Constant(1, degree < 2 ? 0.0 : degree * (degree - 1) * std::pow(time, degree - 2));
        return point;
      };
      Trajectory trajectory{1, kStep, 1.0, {.order = order}};
      ReachedTarget reached;
      trajectory.set_target(target(10));
      static_cast<void>(trajectory.advance(kStep / 4, reached));
      for (Step step = 11; step <= 12; ++step) {
        trajectory.set_target(target(step));
        for (int period = 0; period < 4; ++period) static_cast<void>(trajectory.advance(kStep / 4, reached));
      }
      static_cast<void>(trajectory.advance(kStep / 4, reached));  // predicted
      const double time = 12.25 * kStep;
      const double error = std::abs(trajectory.point().displacement_m[0] - std::pow(time, degree));
      if (degree <= order) {
        EXPECT_LT(error, 1e-15) << "order " << order << ", t^" << degree;
      } else {
        // The first term left out: binomial(degree, order + 1) t^(degree - order - 1) (h/4)^(order + 1).
        EXPECT_GT(error, 0.5 * std::pow(0.12, degree - order - 1) * std::pow(kStep / 4, order + 1))
            << "order " << order << ", t^" << degree;
      }
    }
  }
}

TEST(TrajectoryTest, RampAndHoldRestsUntilNextTarget) {
  Trajectory trajectory{1, kStep, 1.0, {.type = TrajectoryType::ramp_and_hold, .hold_share = 0.25}};
  ReachedTarget reached;
  trajectory.set_target(sine_target(0));
  static_cast<void>(trajectory.advance(kStep / 20, reached));
  trajectory.set_target(sine_target(1));
  const double target_m = sine_target(1).displacement_m[0];
  for (int period = 1; period <= 100; ++period) {
    const bool is_reached = trajectory.advance(kStep / 20, reached);
    EXPECT_EQ(is_reached, period == 20);
    const double x = std::min(1.0, period / 15.0);
    EXPECT_NEAR(trajectory.point().displacement_m[0], 0.5 * (1.0 - std::cos(std::numbers::pi * x)) * target_m, 1e-16);
    if (period >= 15) {
      EXPECT_EQ(trajectory.point().velocity_m_per_s[0], 0.0);
    }
  }
  EXPECT_EQ(reached.flags, MeasurementFlags::none) << "to wait is what it is for";
}

TEST(TrajectoryTest, ContinuesFromRestAfterHalt) {
  constexpr double kPeriod = kStep / 100;
  for (const PathCase& path : kPaths) {
    Trajectory trajectory{1, kStep, 1.0, path.settings};
    ReachedTarget reached;
    trajectory.set_target(sine_target(0));
    static_cast<void>(trajectory.advance(kPeriod, reached));
    trajectory.set_target(sine_target(1));
    for (int period = 0; period < 30; ++period) static_cast<void>(trajectory.advance(kPeriod, reached));
    const double stood_m = trajectory.point().displacement_m[0];
    const double moved_m_per_s = trajectory.point().velocity_m_per_s[0];
    trajectory.halt();
    EXPECT_EQ(trajectory.point().velocity_m_per_s[0], 0.0);
    static_cast<void>(trajectory.advance(kPeriod, reached));
    // The rate picks up by kRateRecovery a step: in the first hundredth, that much of the velocity.
    EXPECT_NEAR(trajectory.point().displacement_m[0], stood_m, 0.025 * moved_m_per_s * kPeriod) << path.name;
    bool is_reached = false;
    for (int period = 0; period < 200 && !is_reached; ++period) is_reached = trajectory.advance(kPeriod, reached);
    EXPECT_TRUE(is_reached) << path.name;
  }
}

}  // namespace
}  // namespace hybridtest

namespace hybridtest {
namespace {

/// A trajectory that keeps time, four sampling intervals in a step, at step 0.
class TrajectoryInTime : public testing::Test {
 protected:
  static constexpr int kSamples = 4;

  void SetUp() override {
    trajectory_.set_target(sine_target(0));
    ASSERT_TRUE(advance());
  }
  bool advance() { return trajectory_.advance(kStep / kSamples, reached_); }
  /// To the end of the step. @return whether it ended exactly then.
  bool end_step() {
    bool early = false;
    for (int i = 1; i < kSamples; ++i) early = advance() || early;
    return advance() && !early;
  }
  [[nodiscard]] double position() const { return trajectory_.point().displacement_m[0]; }
  [[nodiscard]] bool is_missed() const { return any(reached_.flags & MeasurementFlags::missed); }

  Trajectory trajectory_{1, kStep, 1.0, {.keeps_time = true, .missed_most = 3}};
  ReachedTarget reached_;
};

TEST_F(TrajectoryInTime, StandsUntilTheFirstTargetComes) {
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(advance());
  EXPECT_EQ(position(), 0.0);
  trajectory_.set_target(sine_target(1));
  EXPECT_TRUE(end_step());
  EXPECT_EQ(reached_.step, 1);
  EXPECT_FALSE(is_missed());
  EXPECT_EQ(position(), sine_target(1).displacement_m[0]);
}

TEST_F(TrajectoryInTime, ReachesTargetsInTimeAsOtherModesDo) {
  for (Step step = 1; step <= 100; ++step) {
    trajectory_.set_target(sine_target(step));
    ASSERT_TRUE(end_step());
    EXPECT_EQ(reached_.step, step);
    EXPECT_FALSE(any(reached_.flags));
    EXPECT_EQ(position(), sine_target(step).displacement_m[0]) << "to the last bit";
  }
}

TEST_F(TrajectoryInTime, StepWithoutTargetEndsWhereTheMotionLeads) {
  for (Step step = 1; step <= 20; ++step) {
    trajectory_.set_target(sine_target(step));
    ASSERT_TRUE(end_step());
  }
  ASSERT_TRUE(end_step());
  EXPECT_EQ(reached_.step, 21);
  EXPECT_TRUE(is_missed());
  // Taylor's series of second order leaves h^3/6 max|x'''|.
  const double bound = std::pow(kStep, 3) / 6.0 * kAmplitude * std::pow(kOmega, 3);
  EXPECT_NEAR(position(), sine_target(21).displacement_m[0], bound);
  EXPECT_GT(std::abs(position() - sine_target(20).displacement_m[0]), 100.0 * bound) << "it moved";
  // The target of the step after it is reached again.
  trajectory_.set_target(sine_target(22));
  ASSERT_TRUE(end_step());
  EXPECT_FALSE(is_missed());
  EXPECT_EQ(position(), sine_target(22).displacement_m[0]);
}

TEST_F(TrajectoryInTime, LateTargetCorrectsTheNextStep) {
  for (Step step = 1; step <= 20; ++step) {
    trajectory_.set_target(sine_target(step));
    ASSERT_TRUE(end_step());
  }
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(end_step());  // 21 to 23 are missed
  const double before = std::abs(position() - sine_target(23).displacement_m[0]);
  trajectory_.set_target(sine_target(23));  // too late for its own step
  ASSERT_TRUE(end_step());
  EXPECT_TRUE(is_missed());
  const double after = std::abs(position() - sine_target(24).displacement_m[0]);
  EXPECT_LT(after, 0.1 * before) << "from one step behind it instead of four";
}

TEST_F(TrajectoryInTime, EarlyTargetsWaitForTheirStep) {
  trajectory_.set_target(sine_target(1));
  trajectory_.set_target(sine_target(2));
  trajectory_.set_target(sine_target(3));
  for (Step step = 1; step <= 3; ++step) {
    ASSERT_TRUE(end_step());
    EXPECT_EQ(reached_.step, step);
    EXPECT_FALSE(is_missed());
    EXPECT_EQ(position(), sine_target(step).displacement_m[0]);
  }
}

TEST_F(TrajectoryInTime, ComesToRestWithoutTargets) {
  for (Step step = 1; step <= 20; ++step) {
    trajectory_.set_target(sine_target(step));
    ASSERT_TRUE(end_step());
  }
  for (int i = 0; i < 13; ++i) ASSERT_TRUE(end_step());
  EXPECT_TRUE(any(reached_.flags & MeasurementFlags::held));
  const double then = position();
  ASSERT_TRUE(end_step());
  // The velocity of at most 0.31 m/s was halved ten times.
  EXPECT_LT(std::abs(position() - then), kAmplitude * kOmega / 1024.0 * kStep);
}

TEST_F(TrajectoryInTime, PathIsContinuousWhateverComes) {
  Random random{3, 1};
  double before = position();
  double velocity_before = 0.0;
  Step sent = 0;
  for (int sample = 0; sample < 4000; ++sample) {
    const Step due = sample / kSamples + 1;
    if (due > sent && random.uniform() < 0.3) {
      sent = std::max(sent, due - static_cast<Step>(random.below(3)));
      trajectory_.set_target(sine_target(++sent));
    }
    static_cast<void>(advance());
    const double velocity = (position() - before) / (kStep / kSamples);
    // Twice the largest velocity; and no jump of it beyond what reaching a target in a fifth of a step asks.
    ASSERT_LT(std::abs(velocity), 4.0 * kAmplitude * kOmega) << sample;
    ASSERT_LT(std::abs(velocity - velocity_before), 4.0 * kAmplitude * kOmega) << sample;
    velocity_before = velocity;
    before = position();
  }
}

}  // namespace
}  // namespace hybridtest
