// What every delay estimator promises.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "compensation/delay_estimators/cross_correlation.hpp"
#include "compensation/delay_estimators/fixed_delay.hpp"
#include "compensation/delay_estimators/frequency_evaluation_index.hpp"
#include "compensation/delay_estimators/recursive_least_squares.hpp"
#include "compensation/delay_estimators/zero_crossing_slope.hpp"
#include "core/config_error.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/sanitizers.hpp"
#include "tests/unit/compensation/delayed_motion.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriod_s = 1.0 / 1024.0;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct Kind {
  std::string name;
  std::function<std::unique_ptr<DelayEstimator>(const DelayLimits&)> make;
};
void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

template <class Estimator>
Kind kind(std::string name) {
  return {std::move(name), [](const DelayLimits& limits) {
            typename Estimator::Parameters parameters;
            parameters.limits = limits;
            return std::make_unique<Estimator>(parameters, kPeriod_s);
          }};
}

std::vector<Kind> adaptive_kinds() {
  return {kind<ZeroCrossingSlope>("zero_crossing_slope"), kind<CrossCorrelation>("cross_correlation"),
          kind<FrequencyEvaluationIndex>("frequency_evaluation_index"),
          kind<RecursiveLeastSquares>("recursive_least_squares")};
}
std::vector<Kind> all_kinds() {
  std::vector<Kind> kinds = adaptive_kinds();
  kinds.push_back(kind<FixedDelay>("fixed"));
  return kinds;
}
std::string name_of(const testing::TestParamInfo<Kind>& info) { return info.param.name; }

class EveryDelayEstimator : public testing::TestWithParam<Kind> {};
class EveryAdaptiveDelayEstimator : public testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(All, EveryDelayEstimator, testing::ValuesIn(all_kinds()), name_of);
INSTANTIATE_TEST_SUITE_P(All, EveryAdaptiveDelayEstimator, testing::ValuesIn(adaptive_kinds()), name_of);

double motion_m(double t) { return sine_m(2.0, t); }

TEST_P(EveryAdaptiveDelayEstimator, StaysWithinItsBounds) {
  const auto estimator = GetParam().make({0.020, 0.015, 0.030, 0.02});
  EXPECT_DOUBLE_EQ(estimate_of(*estimator, motion_m, 0.029, kPeriod_s, 10.0) > 0.028, true);
  for (const double delay_s : {0.031, 0.014}) {
    estimator->reset();
    for (int i = 0; i < 10 * 1024; ++i) {
      const double t = kPeriod_s * i;
      const double estimate_s = estimator->estimate({motion_m(t), motion_m(t - delay_s)});
      ASSERT_GE(estimate_s, 0.015);
      ASSERT_LE(estimate_s, 0.030);
    }
    // A delay just outside is found to be at the bound.
    EXPECT_NEAR(estimator->delay_s(), delay_s > 0.02 ? 0.030 : 0.015, 1e-3);
  }
}

TEST_P(EveryAdaptiveDelayEstimator, StaysWithinItsRateLimit) {
  const double rate = 0.005;
  const auto estimator = GetParam().make({0.020, 0.0, 0.1, rate});
  double before_s = estimator->delay_s();
  double fastest = 0.0;
  for (int i = 0; i < 20 * 1024; ++i) {
    const double t = kPeriod_s * i;
    const double delay_s = i < 10 * 1024 ? 0.040 : 0.005;  // jumps
    const double estimate_s = estimator->estimate({motion_m(t), motion_m(t - delay_s)});
    fastest = std::max(fastest, std::abs(estimate_s - before_s) / kPeriod_s);
    before_s = estimate_s;
  }
  EXPECT_LE(fastest, rate * (1.0 + 1e-9));
  EXPECT_GE(fastest, rate * (1.0 - 1e-9));         // it did hurry
  EXPECT_NEAR(estimator->delay_s(), 0.005, 1e-4);  // and arrived: 35 ms take 7 s
}

TEST_P(EveryAdaptiveDelayEstimator, DoesNotUpdateBelowMinimumMotion) {
  const auto estimator = GetParam().make({0.020, 0.0, 0.1, 0.02});
  const auto learn = [&](auto motion, double delay_s) {
    return estimate_of(*estimator, motion, delay_s, kPeriod_s, 10.0, 1.0, 16e-6);
  };
  const auto small_motion = [](double t) { return 0.004 * motion_m(t); };  // 20 um, beside noise of 16
  EXPECT_EQ(learn(small_motion, 0.035), 0.020);
  // Fades as structures do. What was learnt stays, within what the last millimetre's noise made of it.
  static_cast<void>(learn([](double t) { return std::exp(-0.8 * t) * motion_m(t); }, 0.035));
  const double learnt_s = estimator->delay_s();
  EXPECT_NEAR(learnt_s, 0.035, 1e-3);
  static_cast<void>(learn(small_motion, 0.050));
  const double kept_s = estimator->delay_s();
  EXPECT_NEAR(kept_s, learnt_s, 1e-3);
  EXPECT_EQ(learn(small_motion, 0.050), kept_s);
}

TEST_P(EveryDelayEstimator, AddsTheMeasuredNetworkLatency) {
  const auto estimator = GetParam().make({0.020, 0.0, 0.1, 0.02});
  EXPECT_NEAR(estimate_of(*estimator, motion_m, 0.020, kPeriod_s, 5.0), 0.020, 5e-5);
  estimator->set_network_latency(0.013);
  EXPECT_NEAR(estimate_of(*estimator, motion_m, 0.020, kPeriod_s, 5.0), 0.033, 5e-5);
  estimator->set_network_latency(-1.0);
  estimator->set_network_latency(kNaN);
  EXPECT_NEAR(estimate_of(*estimator, motion_m, 0.020, kPeriod_s, 1.0), 0.033, 5e-5);
  estimator->set_network_latency(5.0);  // the bound holds for the loop
  EXPECT_EQ(estimate_of(*estimator, motion_m, 0.020, kPeriod_s, 10.0), 0.1);
}

TEST_P(EveryDelayEstimator, FollowsNetworkLatencyAtRest) {
  const auto estimator = GetParam().make({0.020, 0.0, 0.1, 0.02});
  estimator->set_network_latency(0.013);
  for (int i = 0; i < 2048; ++i) static_cast<void>(estimator->estimate({0.0, 0.0}));
  EXPECT_DOUBLE_EQ(estimator->delay_s(), 0.033);
}

TEST_P(EveryDelayEstimator, SkipsNonFiniteSamples) {
  const auto estimator = GetParam().make({0.020, 0.0, 0.1, 0.02});
  static_cast<void>(estimate_of(*estimator, motion_m, 0.020, kPeriod_s, 3.0));
  for (const DelaySample sample : {DelaySample{kNaN, 0.0}, {0.0, kNaN}, {INFINITY, 0.0}, {0.0, -INFINITY}}) {
    EXPECT_TRUE(std::isfinite(estimator->estimate(sample)));
  }
  EXPECT_NEAR(estimate_of(*estimator, motion_m, 0.020, kPeriod_s, 10.0), 0.020, 5e-5);
}

TEST_P(EveryDelayEstimator, ResetRestoresInitialState) {
  const DelayLimits limits{0.020, 0.0, 0.1, 0.02};
  const auto used = GetParam().make(limits);
  static_cast<void>(estimate_of(*used, chirp_m, 0.031, kPeriod_s, 3.3, 0.8, 1e-4));
  used->set_network_latency(0.004);
  used->reset();
  const auto fresh = GetParam().make(limits);
  EXPECT_EQ(used->delay_s(), fresh->delay_s());
  for (int i = 0; i < 5000; ++i) {
    const double t = kPeriod_s * i;
    const DelaySample sample{chirp_m(t), chirp_m(t - 0.027)};
    ASSERT_EQ(used->estimate(sample), fresh->estimate(sample)) << i;
  }
}

TEST_P(EveryDelayEstimator, NeverAllocates) {
  const auto estimator = GetParam().make({});
  const std::size_t before = allocation_count();
  constexpr int kCalls = 1'000'000 / kShortenedBy;
  for (int i = 0; i < kCalls; ++i) {
    const double t = kPeriod_s * i;
    static_cast<void>(estimator->estimate({motion_m(t), motion_m(t - 0.025)}));
    if (i == kCalls / 2) {
      estimator->set_network_latency(0.001);
      estimator->reset();
    }
  }
  EXPECT_EQ(allocation_count(), before);
}

TEST_P(EveryDelayEstimator, StaysFiniteWhileTheReferenceStands) {
  const auto estimator = GetParam().make({});
  for (int i = 0; i < 5000; ++i) {
    const double delay_s = estimator->estimate({0.01, 0.01});
    ASSERT_GE(delay_s, DelayLimits{}.delay_s_min) << i;
    ASSERT_LE(delay_s, DelayLimits{}.delay_s_max) << i;
  }
}

TEST_P(EveryDelayEstimator, RejectsLimitsOutOfRange) {
  const auto refuses = [](const DelayLimits& limits) { EXPECT_THROW(GetParam().make(limits), ConfigError); };
  refuses({0.020, -0.001, 0.1, 0.02});
  refuses({0.020, 0.1, 0.1, 0.02});
  refuses({0.020, 0.0, 2.0, 0.02});
  refuses({0.2, 0.0, 0.1, 0.02});
  refuses({0.020, 0.0, 0.1, 0.0});
  refuses({kNaN, 0.0, 0.1, 0.02});
}

}  // namespace
}  // namespace hybridtest
