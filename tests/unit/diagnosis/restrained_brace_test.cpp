#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "diagnosis/diagnose.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "tests/unit/diagnosis/answers.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

/// A buckling-restrained brace: of two strengths, and of one stiffness before and after yielding.
namespace hybridtest {
namespace {

using testing::ElementsAre;

constexpr double kTension_n = 16.0e3;
constexpr double kHardening = 0.05;

/// In increments, between two limits that move with the hardening.
class Brace {
 public:
  explicit Brace(double compression_n) : compression_n_{compression_n} {}
  double at(double time_s) {
    const double displacement_m = made_motion_m(time_s);
    slip_n_ += (1.0 - kHardening) * kMadeStiffness_n_per_m * (displacement_m - displacement_m_);
    slip_n_ = std::clamp(slip_n_, -(1.0 - kHardening) * compression_n_, (1.0 - kHardening) * kTension_n);
    displacement_m_ = displacement_m;
    return kHardening * kMadeStiffness_n_per_m * displacement_m + slip_n_;
  }

 private:
  double compression_n_;
  double displacement_m_ = 0.0;
  double slip_n_ = 0.0;
};

Diagnosis diagnosis_of_brace(const SiteModel& model, double beta) {
  Brace brace{beta * kTension_n};
  return diagnosis_of(model, made_recording(made_motion_m, [&](double t) { return brace.at(t); }));
}

SiteModel bilinear_model() {
  SiteModel model = made_model();
  model.make_law = [] {
    return std::make_unique<Bilinear>(Bilinear::Parameters{
        .stiffness_n_per_m = kMadeStiffness_n_per_m, .yield_force_n = kTension_n, .hardening_ratio = kHardening});
  };
  return model;
}

const report::ReportedParameter* shift_of(const Diagnosis& diagnosis) {
  for (const report::RankedCause& cause : diagnosis.report.ranking) {
    if (cause.is_cause && cause.effect == "strength_asymmetry") return find_parameter(cause, "shift_m");
  }
  return nullptr;
}

/// The strengths differ by 2 k d.
double shift_m(double beta) { return 0.5 * (1.0 - beta) * kTension_n / kMadeStiffness_n_per_m; }

class RestrainedBrace : public testing::TestWithParam<double> {};

/// The mean strength is off, and the strengths differ: neither explains the force without the other.
TEST_P(RestrainedBrace, IsStrongerInCompressionThanABilinearModel) {
  const Diagnosis diagnosis = diagnosis_of_brace(bilinear_model(), GetParam());
  EXPECT_TRUE(report::names_a_cause(diagnosis.report.verdict));
  const report::ReportedParameter* const shift = shift_of(diagnosis);
  ASSERT_NE(shift, nullptr);
  // 20 N of noise over k, in 6000 readings: 0.1 um; the motion is smoothed where it turns.
  EXPECT_NEAR(shift->value, shift_m(GetParam()), 0.01 * std::abs(shift_m(GetParam())));
}

TEST_P(RestrainedBrace, YieldsAtTwoStrengthsUnderAnElasticModel) {
  const Diagnosis diagnosis = diagnosis_of_brace(made_model(), GetParam());
  EXPECT_THAT(causes_of(diagnosis), ElementsAre("strength_asymmetry", "yielding"));
  const report::ReportedParameter* const shift = shift_of(diagnosis);
  ASSERT_NE(shift, nullptr);
  EXPECT_NEAR(shift->value, shift_m(GetParam()), 0.01 * std::abs(shift_m(GetParam())));
}

INSTANTIATE_TEST_SUITE_P(OfBeta, RestrainedBrace, testing::Values(1.1, 1.3));

/// As strong to both sides, and stronger than the model: the control.
TEST(SymmetricBrace, IsOnlyStronger) {
  SiteModel weaker = made_model();
  weaker.make_law = [] {
    return std::make_unique<Bilinear>(Bilinear::Parameters{.stiffness_n_per_m = kMadeStiffness_n_per_m,
                                                           .yield_force_n = 0.87 * kTension_n,
                                                           .hardening_ratio = kHardening});
  };
  EXPECT_THAT(causes_of(diagnosis_of_brace(weaker, 1.0)), ElementsAre("strength_error"));
}

}  // namespace
}  // namespace hybridtest
