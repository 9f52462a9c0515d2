#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "diagnosis/diagnose.hpp"
#include "tests/unit/diagnosis/answers.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

namespace hybridtest {
namespace {

using testing::ElementsAre;
using testing::UnorderedElementsAre;

/// What a load cell reads of a spring's force behind T^2 q r'' + T r' + r = F, integrated in steps of a twentieth of a
/// sample (semi-implicit Euler).
class FilteredSpring {
 public:
  FilteredSpring(double time_constant_s, double ratio) : time_constant_s_{time_constant_s}, ratio_{ratio} {}

  double at(double time_s) {
    for (; time_s_ + 0.5 * kStep_s < time_s; time_s_ += kStep_s) {
      const double force_n = kMadeStiffness_n_per_m * made_motion_m(time_s_);
      rate_ +=
          kStep_s * (force_n - read_n_ - time_constant_s_ * rate_) / (ratio_ * time_constant_s_ * time_constant_s_);
      read_n_ += kStep_s * rate_;
    }
    return read_n_;
  }

 private:
  static constexpr double kStep_s = kSitePeriod_s / 20.0;
  double time_constant_s_;
  double ratio_;
  double time_s_ = 0.0;
  double read_n_ = 0.0;
  double rate_ = 0.0;
};

constexpr double kTime_s = 0.03;

Diagnosis diagnosis_behind(double ratio, double time_constant_s = kTime_s) {
  FilteredSpring filter{time_constant_s, ratio};
  return diagnosis_of(made_model(), made_recording(made_motion_m, [&](double t) { return filter.at(t); }));
}

class LoadCellFilter : public testing::TestWithParam<double> {};

TEST_P(LoadCellFilter, IsALagWithItsShape) {
  const Diagnosis diagnosis = diagnosis_behind(GetParam());
  EXPECT_EQ(diagnosis.report.verdict, report::Verdict::named);
  ASSERT_THAT(causes_of(diagnosis), ElementsAre("lag"));
  const report::RankedCause& lag = diagnosis.report.ranking.front();
  EXPECT_EQ(lag.interface, "force_sensor");
  // The integration is late by a step, 0.1 ms, at most; the motion, up to 2.3 Hz, turns by 0.4 rad within T.
  EXPECT_NEAR(find_parameter(lag, "time_constant_s")->value, kTime_s, 1e-4);
  EXPECT_NEAR(find_parameter(lag, "second_order_ratio")->value, GetParam(), 0.02);
}

/// Two equal poles, Butterworth.
INSTANTIATE_TEST_SUITE_P(OfTwoPoles, LoadCellFilter, testing::Values(0.25, 0.5));

TEST(SlowLoadCellFilter, IsALagToo) {
  constexpr double kSlow_s = 0.12;  // set to two and a half hertz by mistake
  const Diagnosis diagnosis = diagnosis_behind(0.25, kSlow_s);
  EXPECT_EQ(diagnosis.report.verdict, report::Verdict::named);
  ASSERT_THAT(causes_of(diagnosis), ElementsAre("lag"));
  const report::RankedCause& lag = diagnosis.report.ranking.front();
  // 20 N of noise on readings of 30 kN, 6000 times; the integration is late by a step, 0.1 ms, at most.
  EXPECT_NEAR(find_parameter(lag, "time_constant_s")->value, kSlow_s, 1e-3);
  EXPECT_NEAR(find_parameter(lag, "second_order_ratio")->value, 0.25, 0.002);
}

TEST(LateForce, IsASkewHoweverLate) {
  constexpr double kSkew_s = 0.11;  // a quarter of the period of the faster part of the motion
  const auto read_n = [](double t) { return t < kSkew_s ? 0.0 : kMadeStiffness_n_per_m * made_motion_m(t - kSkew_s); };
  const Diagnosis diagnosis = diagnosis_of(made_model(), made_recording(made_motion_m, read_n));
  EXPECT_EQ(diagnosis.report.verdict, report::Verdict::named);
  ASSERT_THAT(causes_of(diagnosis), ElementsAre("time_skew"));
  // 20 N of noise beside a force that changes by 400 kN/s: 1 us of 6000 readings.
  EXPECT_NEAR(find_parameter(diagnosis.report.ranking.front(), "skew_s")->value, kSkew_s, 1e-5);
}

/// A fifth of a sample, as between the channels of a converter that reads one after the other. So short a lag is the
/// same.
TEST(LateForce, HasAnIntervalHoweverShort) {
  constexpr double kSkew_s = 0.0004;
  const auto read_n = [](double t) { return kMadeStiffness_n_per_m * made_motion_m(t - kSkew_s); };
  const Diagnosis diagnosis = diagnosis_of(made_model(), made_recording(made_motion_m, read_n));
  EXPECT_EQ(diagnosis.report.verdict, report::Verdict::set);
  ASSERT_THAT(causes_of(diagnosis), UnorderedElementsAre("lag", "time_skew"));
  for (const report::RankedCause& cause : diagnosis.report.ranking) {
    if (!cause.is_cause) continue;
    const report::ReportedParameter& late =
        *find_parameter(cause, cause.effect == "lag" ? "time_constant_s" : "skew_s");
    EXPECT_FALSE(late.is_at_bound);
    ASSERT_TRUE(late.ci95);
    EXPECT_LT(late.ci95->low, kSkew_s);
    EXPECT_GT(late.ci95->high, kSkew_s);
    EXPECT_NEAR(late.value, kSkew_s, 1e-5);  // as above
  }
}

TEST(BesselFilter, IsASetWithATimeSkew) {
  // Its delay is the same at all frequencies up to its bandwidth: that is what it is made for.
  const Diagnosis diagnosis = diagnosis_behind(1.0 / 3.0);
  EXPECT_EQ(diagnosis.report.verdict, report::Verdict::set);
  EXPECT_THAT(causes_of(diagnosis), ElementsAre("lag", "time_skew"));
}

}  // namespace
}  // namespace hybridtest
