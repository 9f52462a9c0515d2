// What every compensator, on commands and on forces, promises.

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "compensation/adaptive_inverse.hpp"
#include "compensation/adaptive_model_inverse.hpp"
#include "compensation/adaptive_time_series.hpp"
#include "compensation/conditional_adaptive_time_series.hpp"
#include "compensation/delay_estimators/cross_correlation.hpp"
#include "compensation/estimated_delay_compensation.hpp"
#include "compensation/feedforward_lqg.hpp"
#include "compensation/force_correction.hpp"
#include "compensation/force_correction_quadratic.hpp"
#include "compensation/inverse_compensation.hpp"
#include "compensation/linear_acceleration.hpp"
#include "compensation/newmark_kinematics.hpp"
#include "compensation/no_compensation.hpp"
#include "compensation/no_force_compensation.hpp"
#include "compensation/optimal_pick.hpp"
#include "compensation/polynomial_displacement.hpp"
#include "compensation/polynomial_force.hpp"
#include "compensation/two_stage_adaptive.hpp"
#include "compensation/upper_bound_delay.hpp"
#include "core/random.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/sanitizers.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1.0 / 1024.0;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// One signal for both kinds: a target with its derivatives, and measurements some 20 ms late.
struct Moment {
  CompensatorInput input;
  [[nodiscard]] ForceSample force() const {
    return {input.target_m, input.measured_displacement_m, input.measured_force_n};
  }
};

Moment moment(int i, Random& random) {
  const double t = kPeriod_s * i;
  Moment now;
  for (const double omega : {7.0, 19.0}) {
    now.input.target_m += 3e-3 * std::sin(omega * t);
    now.input.target_velocity_m_per_s += 3e-3 * omega * std::cos(omega * t);
    now.input.target_acceleration_m_per_s2 -= 3e-3 * omega * omega * std::sin(omega * t);
    now.input.measured_displacement_m += 2.9e-3 * std::sin(omega * (t - 0.02));
  }
  now.input.measured_force_n = 1.19e6 * now.input.measured_displacement_m + 2.0 * random.normal();
  now.input.measured_displacement_m += 16e-6 * random.normal();
  return now;
}

/// A compensator of either kind as a function, and its reset.
struct Subject {
  std::function<double(const Moment&)> answer;
  std::function<void()> reset;
};
struct Kind {
  std::string name;
  bool is_for_commands;
  std::function<Subject()> make;
};
void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

template <class Make>
Kind command_kind(std::string name, Make make) {
  return {std::move(name), true, [make] {
            std::shared_ptr<Compensator> compensator = make();
            return Subject{[compensator](const Moment& now) { return compensator->command(now.input); },
                           [compensator] { compensator->reset(); }};
          }};
}

template <class Make>
Kind force_kind(std::string name, Make make) {
  return {std::move(name), false, [make] {
            std::shared_ptr<ForceCompensator> compensator = make();
            return Subject{[compensator](const Moment& now) { return compensator->corrected_force(now.force()); },
                           [compensator] { compensator->reset(); }};
          }};
}

template <class Type>
std::unique_ptr<Type> make_default() {
  return std::make_unique<Type>(typename Type::Parameters{}, kPeriod_s);
}

template <class Type>
Kind command_kind(std::string name) {
  return command_kind(std::move(name), make_default<Type>);
}
template <class Type>
Kind force_kind(std::string name) {
  return force_kind(std::move(name), make_default<Type>);
}

std::vector<Kind> all_kinds() {
  return {command_kind("none", [] { return std::make_unique<NoCompensation>(); }),
          command_kind<PolynomialDisplacement>("polynomial_displacement"),
          command_kind<NewmarkKinematics>("newmark_kinematics"),
          command_kind<LinearAcceleration>("linear_acceleration"),
          command_kind<InverseCompensation>("inverse_compensation"),
          command_kind<AdaptiveInverse>("adaptive_inverse"),
          command_kind<AdaptiveTimeSeries>("adaptive_time_series"),
          command_kind<ConditionalAdaptiveTimeSeries>("conditional_adaptive_time_series"),
          command_kind<FeedforwardLqg>("feedforward_lqg"),
          command_kind<TwoStageAdaptive>("two_stage_adaptive"),
          command_kind<UpperBoundDelay>("upper_bound_delay"),
          command_kind<AdaptiveModelInverse>("adaptive_model_inverse"),
          command_kind("estimated_delay",
                       [] {
                         return std::make_unique<EstimatedDelayCompensation>(make_default<PolynomialDisplacement>(),
                                                                             make_default<CrossCorrelation>());
                       }),
          force_kind("no_force_compensation", [] { return std::make_unique<NoForceCompensation>(); }),
          force_kind<PolynomialForce>("polynomial_force"),
          force_kind<ForceCorrectionQuadratic>("force_correction_quadratic"),
          force_kind<ForceCorrection>("force_correction"),
          force_kind<OptimalPick>("optimal_pick")};
}

class EveryCompensator : public testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(All, EveryCompensator, testing::ValuesIn(all_kinds()),
                         [](const auto& kind) { return kind.param.name; });

TEST_P(EveryCompensator, GivesSameBitsAfterResetAsWhenNew) {
  const Subject used = GetParam().make();
  Random other{99};
  for (int i = 777; i < 6000; ++i) static_cast<void>(used.answer(moment(i, other)));
  used.reset();
  const Subject fresh = GetParam().make();
  Random random{5};
  for (int i = 0; i < 4000; ++i) {
    const Moment now = moment(i, random);
    ASSERT_EQ(std::bit_cast<std::uint64_t>(used.answer(now)), std::bit_cast<std::uint64_t>(fresh.answer(now))) << i;
  }
}

TEST_P(EveryCompensator, NeverAllocates) {
  const Subject subject = GetParam().make();
  Random random{5};
  std::vector<Moment> moments;
  for (int i = 0; i < 1024; ++i) moments.push_back(moment(i, random));
  const std::size_t before = allocation_count();
  constexpr std::size_t kCalls = 1'000'000 / kShortenedBy;
  for (std::size_t i = 0; i < kCalls; ++i) {
    static_cast<void>(subject.answer(moments[i % moments.size()]));
    if (i == kCalls / 2) subject.reset();
  }
  EXPECT_EQ(allocation_count(), before);
}

/// Answers 200 samples with what `spoil` makes of one of them in between, and 4000 after it.
template <class Spoil>
std::vector<double> answers_around(const Subject& subject, Spoil spoil) {
  Random random{5};
  std::vector<double> answers;
  for (int i = 0; i < 4200; ++i) {
    Moment now = moment(i, random);
    if (i == 200) spoil(now.input);
    answers.push_back(subject.answer(now));
  }
  return answers;
}

TEST_P(EveryCompensator, RecoversFromNonFiniteTarget) {
  const auto answers = answers_around(GetParam().make(), [](CompensatorInput& input) {
    input.target_m = input.target_velocity_m_per_s = input.target_acceleration_m_per_s2 = kNaN;
  });
  // The longest history by default is the polynomials', three spacings of 20 ms, and three of 24 for the upper bound.
  for (std::size_t i = 300; i < answers.size(); ++i) ASSERT_TRUE(std::isfinite(answers[i])) << i;
  for (std::size_t i = 0; i < 200; ++i) ASSERT_TRUE(std::isfinite(answers[i])) << i;
}

TEST_P(EveryCompensator, PassesNonFiniteTargetToInterlocks) {
  if (!GetParam().is_for_commands) return;
  const auto answers = answers_around(GetParam().make(), [](CompensatorInput& input) { input.target_m = kNaN; });
  EXPECT_FALSE(std::isfinite(answers[200]));
}

TEST_P(EveryCompensator, KeepsNonFiniteMeasurementOutOfCommand) {
  for (const double spoilt : {kNaN, std::numeric_limits<double>::infinity()}) {
    const auto answers = answers_around(GetParam().make(), [&](CompensatorInput& input) {
      input.measured_displacement_m = input.measured_force_n = spoilt;
    });
    if (GetParam().is_for_commands) {
      for (const double answer : answers) ASSERT_TRUE(std::isfinite(answer));
    } else {
      // A force that was not measured is not made up, and is forgotten with the method's history.
      EXPECT_FALSE(std::isfinite(answers[200]));
      for (std::size_t i = 300; i < answers.size(); ++i) ASSERT_TRUE(std::isfinite(answers[i])) << i;
    }
  }
}

/// Shows that the guard of NeverAllocates sees an allocation.
TEST(AllocationCount, CountsAllocationsOfACompensator) {
  class Allocating final : public Compensator {
   public:
    double command(const CompensatorInput& input) noexcept override {
      history_.push_back(input.target_m);
      return input.target_m;
    }
    void reset() noexcept override {}

   private:
    std::vector<double> history_;
  };
  Allocating compensator;
  const std::size_t before = allocation_count();
  for (int i = 0; i < 100; ++i) static_cast<void>(compensator.command({}));
  EXPECT_GT(allocation_count(), before);
}

}  // namespace
}  // namespace hybridtest
