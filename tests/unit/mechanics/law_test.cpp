#include "mechanics/laws/law.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/random.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "mechanics/laws/bouc_wen.hpp"
#include "mechanics/laws/bouc_wen_baber_noori.hpp"
#include "mechanics/laws/elastic.hpp"
#include "mechanics/laws/friction.hpp"
#include "mechanics/laws/gap_spring.hpp"
#include "mechanics/laws/giuffre_menegotto_pinto.hpp"
#include "mechanics/laws/parallel.hpp"

namespace hybridtest {
namespace {

struct LawCase {
  std::string name;
  std::function<std::unique_ptr<Law>()> make;
};

/// What every law owes its callers, whatever its equation.
class EveryLaw : public testing::TestWithParam<LawCase> {
 protected:
  /// Wanders some ten yield displacements, so that every branch is visited.
  static std::vector<double> wandering_path(int length) {
    Random random{11};
    std::vector<double> path;
    double displacement_m = 0.0;
    for (int i = 0; i < length; ++i) {
      displacement_m = 0.98 * displacement_m + 0.01 * random.normal();
      path.push_back(displacement_m);
    }
    return path;
  }

  static double impose(Law& law, double displacement_m) {
    const double force_n = law.trial(displacement_m, 0.0);
    law.commit();
    return force_n;
  }
};

TEST_P(EveryLaw, IsAtRestWhenNew) { EXPECT_EQ(GetParam().make()->trial(0.0, 0.0), 0.0); }

TEST_P(EveryLaw, StartsWithItsInitialStiffness) {
  const auto law = GetParam().make();
  constexpr double kSmall = 1e-9;
  // The curved laws leave their tangent by about kSmall over the yield displacement of 0.01 m.
  EXPECT_NEAR(law->trial(kSmall, 0.0) / kSmall, law->initial_stiffness_n_per_m(),
              1e-6 * law->initial_stiffness_n_per_m());
}

TEST_P(EveryLaw, TrialsDoNotChangeCommittedState) {
  const auto tried = GetParam().make();
  const auto straight = GetParam().make();
  Random random{5};
  for (const double displacement_m : wandering_path(2000)) {
    for (int i = 0; i < 3; ++i) static_cast<void>(tried->trial(random.uniform(-0.1, 0.1), 0.0));
    ASSERT_EQ(impose(*tried, displacement_m), impose(*straight, displacement_m));
  }
}

TEST_P(EveryLaw, SameTrialTwiceGivesSameForce) {
  const auto law = GetParam().make();
  for (const double displacement_m : wandering_path(2000)) {
    const double force_n = law->trial(displacement_m, 0.0);
    ASSERT_EQ(law->trial(displacement_m, 0.0), force_n);
    law->commit();
    // Standing still neither moves nor relaxes; 1e-9 N is rounding.
    ASSERT_NEAR(law->trial(displacement_m, 0.0), force_n, 1e-9);
  }
}

TEST_P(EveryLaw, RevertDiscardsTheTrial) {
  const auto law = GetParam().make();
  const auto other = GetParam().make();
  for (const double displacement_m : wandering_path(500)) {
    impose(*law, displacement_m);
    impose(*other, displacement_m);
  }
  static_cast<void>(law->trial(0.2, 0.0));
  law->revert();
  law->commit();  // the committed state once more
  EXPECT_EQ(impose(*law, 0.01), impose(*other, 0.01));
  EXPECT_EQ(impose(*law, -0.02), impose(*other, -0.02));
}

TEST_P(EveryLaw, ResetRestoresInitialState) {
  const auto law = GetParam().make();
  for (const double displacement_m : wandering_path(500)) impose(*law, displacement_m);
  static_cast<void>(law->trial(0.2, 0.0));
  law->reset();
  law->commit();
  const auto virgin = GetParam().make();
  for (const double displacement_m : wandering_path(100))
    ASSERT_EQ(impose(*law, displacement_m), impose(*virgin, displacement_m));
}

TEST_P(EveryLaw, IsOddInDisplacement) {
  const auto law = GetParam().make();
  const auto mirrored = GetParam().make();
  for (const double displacement_m : wandering_path(2000))
    ASSERT_EQ(impose(*law, displacement_m), -impose(*mirrored, -displacement_m));
}

TEST_P(EveryLaw, ReturnsNotANumberForNotANumber) {
  const auto law = GetParam().make();
  EXPECT_TRUE(std::isnan(law->trial(std::nan(""), 0.0)));
  law->revert();
  EXPECT_EQ(law->trial(0.0, 0.0), 0.0);
}

INSTANTIATE_TEST_SUITE_P(
    Mechanics, EveryLaw,
    testing::Values(
        LawCase{"elastic", [] { return std::make_unique<Elastic>(4.0e6); }},
        LawCase{"parallel",
                [] {
                  std::vector<std::unique_ptr<Law>> laws;
                  laws.push_back(std::make_unique<Elastic>(2.0e6));
                  laws.push_back(std::make_unique<Bilinear>(Bilinear::Parameters{
                      .stiffness_n_per_m = 2.0e6, .yield_force_n = 2.0e4, .hardening_ratio = 0.05}));
                  return std::make_unique<Parallel>(std::move(laws));
                }},
        LawCase{"bilinear",
                [] {
                  return std::make_unique<Bilinear>(Bilinear::Parameters{
                      .stiffness_n_per_m = 4.0e6, .yield_force_n = 4.0e4, .hardening_ratio = 0.05});
                }},
        LawCase{"giuffre_menegotto_pinto",
                [] {
                  return std::make_unique<GiuffreMenegottoPinto>(GiuffreMenegottoPinto::Parameters{
                      .stiffness_n_per_m = 4.0e6, .yield_force_n = 4.0e4, .hardening_ratio = 0.03, .r0 = 18.0});
                }},
        LawCase{"bouc_wen",
                [] {
                  return std::make_unique<BoucWen>(BoucWen::Parameters{
                      .stiffness_n_per_m = 4.0e6, .alpha = 0.1, .n = 1.4, .gamma_per_m = 150.0, .beta_per_m = 350.0});
                }},
        LawCase{"bouc_wen_baber_noori",
                [] {
                  return std::make_unique<BoucWenBaberNoori>(
                      BoucWenBaberNoori::Parameters{.stiffness_n_per_m = 4.0e6,
                                                    .alpha = 0.1,
                                                    .n = 1.4,
                                                    .gamma_per_m = 150.0,
                                                    .beta_per_m = 350.0,
                                                    .strength_degradation_per_j = 1.0e-5,
                                                    .stiffness_degradation_per_j = 2.0e-5,
                                                    .pinching = 0.8,
                                                    .pinching_rate_per_j = 1.0e-4,
                                                    .pinching_level = 0.1,
                                                    .pinching_width_m = 0.003});
                }},
        LawCase{"friction",
                [] {
                  return std::make_unique<Friction>(
                      Friction::Parameters{.friction_force_n = 500.0, .presliding_displacement_m = 0.01});
                }},
        LawCase{"gap",
                [] {
                  return std::make_unique<GapSpring>(GapSpring::Parameters{.stiffness_n_per_m = 4.0e6, .gap_m = 0.01});
                }}),
    [](const testing::TestParamInfo<LawCase>& law) { return law.param.name; });

}  // namespace
}  // namespace hybridtest
