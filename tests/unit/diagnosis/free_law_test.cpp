#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "diagnosis/diagnose.hpp"
#include "diagnosis/page/wording.hpp"
#include "mechanics/laws/presliding_element.hpp"
#include "tests/unit/diagnosis/answers.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

// A friction or a hysteretic element that the user's model has is free, down to none and up: what the user believes of
// it does not change what is found.
namespace hybridtest {
namespace {

using testing::AnyOf;
using testing::HasSubstr;

constexpr double kForce_n = 4000.0;  // of a friction or a hysteretic element, beside 56 kN of the spring
constexpr double kPresliding_m = 2e-4;
constexpr double kStaticExcess = 0.5;
constexpr double kStribeckVelocity_m_per_s = 0.05;  // of 0.23 m/s
constexpr double kYieldDisplacement_m = 4e-3;
constexpr double kShortYieldDisplacement_m = 4e-4;  // a seventieth of the motion, as dry friction
constexpr double kNoise_n = 20.0;

/// A force over kForce_n at the times of the samples, in their order.
using Share = std::function<double(double)>;

Share friction() {
  return [element = PreslidingElement{kPresliding_m}](double time_s) mutable {
    return element.share(made_motion_m(time_s));
  };
}

Share falling_friction() {
  return [element = PreslidingElement{kPresliding_m}](double time_s) mutable {
    constexpr double kShort_s = 1e-5;
    const double speed = (made_motion_m(time_s + kShort_s) - made_motion_m(time_s - kShort_s)) / (2.0 * kShort_s);
    const double ratio = speed / kStribeckVelocity_m_per_s;
    return element.share(made_motion_m(time_s), 1.0 + kStaticExcess * std::exp(-ratio * ratio));
  };
}

/// Bouc-Wen with n = 1 and beta = gamma: towards its largest force z follows 1 - |z|, back from it the initial slope.
Share loop(double yield_displacement_m) {
  return [yield_displacement_m, z = 0.0, last_m = 0.0](double time_s) mutable {
    constexpr int kSteps = 100;
    const double place_m = made_motion_m(time_s);
    const double way = (place_m - last_m) / yield_displacement_m / kSteps;
    for (int i = 0; i < kSteps; ++i) z += way * (z * way > 0.0 ? 1.0 - std::abs(z) : 1.0);
    last_m = place_m;
    return z;
  };
}

Share hysteresis() { return loop(kYieldDisplacement_m); }
Share short_hysteresis() { return loop(kShortYieldDisplacement_m); }

/// An element beside a spring, and the effect that a model has of it.
struct Element {
  std::string_view effect;
  Share (*share)() = nullptr;
  std::vector<double> values;  // of the effect; the first is the force
  std::size_t shape = 0;       // which of them is the displacement at which it slides or yields

  [[nodiscard]] const EffectType& type() const { return *find_effect(EffectInterface::specimen, effect); }
};

const Element kFriction{"coulomb_friction", friction, {kForce_n, 0.0, kPresliding_m, 0.0}, 2};
const Element kFallingFriction{
    "stribeck_friction", falling_friction, {kForce_n, kStaticExcess, kStribeckVelocity_m_per_s, kPresliding_m, 0.0}, 3};
const Element kHysteresis{"bouc_wen_hysteresis", hysteresis, {kForce_n, kYieldDisplacement_m, 1.0, 0.5}, 1};

const Element kShortHysteresis{
    "bouc_wen_hysteresis", short_hysteresis, {kForce_n, kShortYieldDisplacement_m, 1.0, 0.5}, 1};

/// What the user believes of a specimen, over what it is.
struct Belief {
  double force = 1.0;      // of the element, over kForce_n; 0: the model has none
  double stiffness = 1.0;  // of the spring
  double shape = 1.0;      // displacement at which the element slides or yields
};

/// @param real   force of the real element over kForce_n.
Recording recording_of(const Element& element, double real, std::uint64_t seed = 3) {
  const auto force_n = [share = element.share(), real](double time_s) mutable {
    return kMadeStiffness_n_per_m * made_motion_m(time_s) + real * kForce_n * share(time_s);
  };
  return made_recording(made_motion_m, force_n, kNoise_n, seed);
}

EffectSetting believed(const Element& element, const Belief& belief) {
  EffectSetting effect{&element.type(), element.values};
  effect.values.front() *= belief.force;
  effect.values[element.shape] *= belief.shape;
  return effect;
}

SiteModel believed_model(const Element& element, const Belief& belief) {
  SiteModel model = made_model();
  model.make_law = [belief] { return std::make_unique<Elastic>(belief.stiffness * kMadeStiffness_n_per_m); };
  if (belief.force > 0.0) model.effects.push_back(believed(element, belief));
  return model;
}

/// Of a completed model.
struct Completed {
  double force_n = 0.0;  // of the elements of the type in question
  double shape_m = 0.0;  // displacement at which the last one slides or yields
  double stiffness_n_per_m = 0.0;
  int others = 0;  // effects that the specimen does not have
};

Completed completed(SiteModel model, const Element& element, const Diagnosis& diagnosis) {
  for (const EffectSetting& cause : diagnosis.causes) add_effect(model, cause);
  Completed specimen;
  specimen.stiffness_n_per_m = model.make_law()->initial_stiffness_n_per_m();
  for (const EffectSetting& effect : model.effects) {
    if (effect.type == &element.type()) {
      specimen.force_n += effect.values.front();
      specimen.shape_m = effect.values[element.shape];
    } else if (effect.type == find_effect(EffectInterface::specimen, "stiffness_error")) {
      specimen.stiffness_n_per_m += effect.values[1];
    } else {
      ++specimen.others;
    }
  }
  return specimen;
}

double root_mean_square(const std::vector<double>& values) {
  double squares = 0.0;
  for (const double value : values) squares += value * value;
  return std::sqrt(squares / static_cast<double>(values.size()));
}

struct Case {
  std::string name;
  const Element& element;
  double real = 1.0;  // force of the real element over kForce_n
  Belief belief;

  friend void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }
};

class FreeLaw : public testing::TestWithParam<Case> {};

TEST_P(FreeLaw, CompletedSpecimenIsTheRealOne) {
  const Element& element = GetParam().element;
  const Recording recording = recording_of(element, GetParam().real);
  const SiteModel model = believed_model(element, GetParam().belief);
  const Diagnosis diagnosis = diagnosis_of(model, recording);
  // These recordings may not separate it from another cause; then it is the first of the set.
  EXPECT_THAT(diagnosis.report.verdict, AnyOf(report::Verdict::named, report::Verdict::set));
  const Completed specimen = completed(model, element, diagnosis);
  EXPECT_EQ(specimen.others, 0) << report::verdict_sentence(diagnosis.report);
  EXPECT_NEAR(specimen.force_n, GetParam().real * kForce_n, 0.01 * kForce_n);
  if (GetParam().real > 0.0) {
    const double shape_m = element.values[element.shape];
    EXPECT_NEAR(specimen.shape_m, shape_m, 0.01 * shape_m);
  }
  EXPECT_NEAR(specimen.stiffness_n_per_m, kMadeStiffness_n_per_m, 0.01 * kMadeStiffness_n_per_m);
  const double output_n = root_mean_square(recording.dofs[0].of(Channel::measured_force));
  // The corners of a friction lie between samples.
  EXPECT_NEAR(diagnosis.report.interface_shrink->nrmse_after * output_n, kNoise_n, 0.1 * kNoise_n);
}

const std::vector<Case> kCases{
    {"FrictionBelievedAbsent", kFriction, 1.0, {.force = 0.0}},
    {"FrictionBelievedATenth", kFriction, 1.0, {.force = 0.1}},
    {"FrictionBelievedTwice", kFriction, 1.0, {.force = 2.0}},
    {"FrictionBelievedTenTimes", kFriction, 1.0, {.force = 10.0}},
    {"FrictionBesideASpringOfTenTimes", kFriction, 1.0, {.force = 0.5, .stiffness = 10.0}},
    {"FrictionBelievedToSlideLater", kFriction, 1.0, {.force = 2.0, .shape = 5.0}},
    {"FrictionBelievedToSlideEarlier", kFriction, 1.0, {.force = 0.5, .shape = 0.2}},
    {"FrictionThatSlidesEarlier", kFriction, 1.0, {.shape = 5.0}},
    {"NoFrictionBelievedATenth", kFriction, 0.0, {.force = 0.1}},
    {"NoFrictionBelievedTenTimes", kFriction, 0.0, {.force = 10.0}},
    {"NoFrictionBesideASpringOfATenth", kFriction, 0.0, {.force = 2.0, .stiffness = 0.1}},
    {"FallingFrictionBelievedAbsent", kFallingFriction, 1.0, {.force = 0.0}},
    {"FallingFrictionBelievedHalf", kFallingFriction, 1.0, {.force = 0.5}},
    {"FallingFrictionBelievedTwice", kFallingFriction, 1.0, {.force = 2.0}},
    {"NoFallingFrictionBelievedTwice", kFallingFriction, 0.0, {.force = 2.0}},
    {"HysteresisBelievedAbsent", kHysteresis, 1.0, {.force = 0.0}},
    {"HysteresisBelievedATenth", kHysteresis, 1.0, {.force = 0.1}},
    {"HysteresisBelievedTwice", kHysteresis, 1.0, {.force = 2.0}},
    {"HysteresisBelievedTenTimes", kHysteresis, 1.0, {.force = 10.0}},
    {"HysteresisBesideASpringOfTenTimes", kHysteresis, 1.0, {.force = 0.5, .stiffness = 10.0}},
    {"HysteresisBelievedToYieldLater", kHysteresis, 1.0, {.force = 2.0, .shape = 2.0}},
    {"HysteresisThatYieldsLater", kHysteresis, 1.0, {.shape = 0.5}},
    {"ShortHysteresisBelievedHalf", kShortHysteresis, 1.0, {.force = 0.5}},
    {"ShortHysteresisBelievedTwice", kShortHysteresis, 1.0, {.force = 2.0}},
    {"NoHysteresisBelievedATenth", kHysteresis, 0.0, {.force = 0.1}},
    {"NoHysteresisBelievedTenTimes", kHysteresis, 0.0, {.force = 10.0}},
    {"NoHysteresisBesideASpringOfATenth", kHysteresis, 0.0, {.force = 2.0, .stiffness = 0.1}},
};

INSTANTIATE_TEST_SUITE_P(Believed, FreeLaw, testing::ValuesIn(kCases), [](const auto& one) { return one.param.name; });

TEST(FreeLawOfRightModel, IsNotCorrected) {
  for (const Element* element : {&kFriction, &kFallingFriction, &kHysteresis}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const Diagnosis diagnosis = diagnosis_of(believed_model(*element, {}), recording_of(*element, 1.0, seed));
      EXPECT_EQ(diagnosis.report.verdict, report::Verdict::none) << element->effect << ", seed " << seed;
      EXPECT_TRUE(diagnosis.causes.empty()) << element->effect << ", seed " << seed;
    }
  }
}

// The control of the tests above: of two frictions in the model one is free, and the other one is too large.
TEST(FreeLawOfTwoFrictions, IsNotTheRealSpecimen) {
  SiteModel model = believed_model(kFriction, {.force = 2.0});
  model.effects.push_back(believed(kFriction, {.force = 1.0}));
  const Completed specimen = completed(model, kFriction, diagnosis_of(model, recording_of(kFriction, 1.0)));
  EXPECT_GT(specimen.others, 0);
  EXPECT_GT(specimen.force_n, 1.01 * kForce_n);
}

TEST(FreeLawInWords, SaysWhatStandsInPlaceOfWhat) {
  const Diagnosis diagnosis = diagnosis_of(believed_model(kFriction, {.force = 2.0}), recording_of(kFriction, 1.0));
  EXPECT_THAT(report::verdict_sentence(diagnosis.report), HasSubstr("coulomb friction (friction force 4.00"));
  EXPECT_THAT(report::verdict_sentence(diagnosis.report), HasSubstr("instead of 8.00"));
}

}  // namespace
}  // namespace hybridtest
