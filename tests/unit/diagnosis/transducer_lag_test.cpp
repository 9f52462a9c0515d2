#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>

#include "diagnosis/diagnose.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "tests/unit/diagnosis/answers.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

/// A displacement transducer that lags makes the motion late and the force early: a delay of the actuator and a damping
/// of the specimen, in channels that are judged one after the other.
namespace hybridtest {
namespace {

using testing::ElementsAre;

constexpr double kLag_s = 4.0e-4;

/// What a transducer reads of the motion behind one pole, to the first order of T over the periods of the motion.
double read_m(double time_s) { return made_motion_m(time_s - kLag_s); }

TEST(TransducerLag, IsASetWithTheDampingThatItLooksLike) {
  const Diagnosis diagnosis = diagnosis_of(
      made_model(), made_recording(read_m, [](double t) { return kMadeStiffness_n_per_m * made_motion_m(t); }));
  EXPECT_EQ(diagnosis.report.verdict, report::Verdict::set);
  ASSERT_THAT(causes_of(diagnosis), ElementsAre("lag", "viscous_damping"));
  for (const report::RankedCause& cause : diagnosis.report.ranking) {
    if (cause.effect == "lag") {
      EXPECT_NEAR(find_parameter(cause, "time_constant_s")->value, kLag_s, 0.02 * kLag_s);
    }
  }
}

/// An actuator as late, and half the damping that the lag would look like: no lag explains both.
TEST(TransducerLag, IsNoneWhereMotionAndForceDoNotAgreeOnIt) {
  constexpr double kDamping_n_s_per_m = 0.5 * kMadeStiffness_n_per_m * kLag_s;
  const Diagnosis diagnosis = diagnosis_of(made_model(), made_recording(read_m, [](double t) {
                                             return kMadeStiffness_n_per_m * made_motion_m(t - kLag_s) +
                                                    kDamping_n_s_per_m * made_velocity_m_per_s(t - kLag_s);
                                           }));
  EXPECT_THAT(causes_of(diagnosis), ElementsAre("viscous_damping"));
}

/// Behind one pole of time constant `lag_s`, of times that follow each other.
class OnePole {
 public:
  OnePole(double lag_s, std::function<double(double)> value) : lag_s_{lag_s}, value_{std::move(value)} {}
  double operator()(double time_s) {
    constexpr int kSteps = 20;
    const double step_s = (time_s - time_s_) / kSteps;
    for (int i = 1; i <= kSteps; ++i) {
      read_ += (value_(time_s_ + i * step_s) - read_) * -std::expm1(-step_s / lag_s_);
    }
    time_s_ = time_s;
    return read_;
  }

 private:
  double lag_s_;
  std::function<double(double)> value_;
  double time_s_ = 0.0;
  double read_ = 0.0;
};

/// The motion comes late by more than the force comes early: the actuator is late, too, by a little.
TEST(TransducerLag, IsASetBesideAnActuatorThatIsLateByALittle) {
  constexpr double kTransducer_s = 0.004;
  const auto moved_m = [](double t) { return made_motion_m(std::max(0.0, t - 3e-4)); };
  const Diagnosis diagnosis = diagnosis_of(made_model(), made_recording(OnePole{kTransducer_s, moved_m}, [&](double t) {
                                             return kMadeStiffness_n_per_m * moved_m(t);
                                           }));
  EXPECT_EQ(diagnosis.report.verdict, report::Verdict::set);
  for (const report::RankedCause& cause : diagnosis.report.ranking) {
    if (cause.is_cause && cause.effect == "viscous_damping") {
      EXPECT_TRUE(cause.is_indistinguishable);
      EXPECT_LE(cause.probability, 0.5);
    }
  }
  EXPECT_THAT(causes_of(diagnosis), testing::IsSupersetOf({"lag", "viscous_damping"}));
}

TEST(TransducerLag, FoundByTheForceOfALawThatYieldsIsNoPartOfTheActuatorsDelay) {
  constexpr double kActuator_s = 0.006;
  constexpr double kTransducer_s = 0.010;
  const auto law = [] {
    return std::make_unique<Bilinear>(Bilinear::Parameters{
        .stiffness_n_per_m = kMadeStiffness_n_per_m, .yield_force_n = 1.5e4, .hardening_ratio = 0.1});
  };
  SiteModel model = made_model();
  model.make_law = law;
  const auto moved_m = [](double t) { return made_motion_m(std::max(0.0, t - kActuator_s)); };
  const std::unique_ptr<Law> specimen = law();
  const Diagnosis diagnosis = diagnosis_of(model, made_recording(OnePole{kTransducer_s, moved_m}, [&](double t) {
                                             const double force_n = specimen->trial(moved_m(t), 0.0);
                                             specimen->commit();
                                             return force_n;
                                           }));
  ASSERT_THAT(causes_of(diagnosis), ElementsAre("delay", "lag"));
  for (const report::RankedCause& cause : diagnosis.report.ranking) {
    if (!cause.is_cause) continue;
    // The motion is sampled every 2 ms, the lag undone between the samples: a twentieth of that.
    const bool is_lag = cause.effect == "lag";
    EXPECT_NEAR(find_parameter(cause, is_lag ? "time_constant_s" : "delay_s")->value,
                is_lag ? kTransducer_s : kActuator_s, 1e-4)
        << cause.effect;
  }
}

}  // namespace
}  // namespace hybridtest
