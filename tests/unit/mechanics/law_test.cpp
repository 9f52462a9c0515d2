#include "mechanics/laws/law.hpp"

#include <gtest/gtest.h>

#include <algorithm>
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
#include "mechanics/laws/elastomer.hpp"
#include "mechanics/laws/friction.hpp"
#include "mechanics/laws/friction_pendulum.hpp"
#include "mechanics/laws/gap_spring.hpp"
#include "mechanics/laws/giuffre_menegotto_pinto.hpp"
#include "mechanics/laws/lead_rubber.hpp"
#include "mechanics/laws/mr_damper.hpp"
#include "mechanics/laws/parallel.hpp"
#include "mechanics/laws/peak_oriented.hpp"
#include "mechanics/laws/pinched_reloading.hpp"
#include "mechanics/laws/ramberg_osgood.hpp"
#include "mechanics/laws/self_centring.hpp"
#include "mechanics/laws/takeda.hpp"

namespace hybridtest {
namespace {

/// Factors on all forces and all displacements of a law.
struct Scale {
  double force = 1.0;
  double displacement = 1.0;
  [[nodiscard]] double n(double force_n) const { return force * force_n; }
  [[nodiscard]] double m(double displacement_m) const { return displacement * displacement_m; }
  [[nodiscard]] double n_per_m(double stiffness_n_per_m) const { return force / displacement * stiffness_n_per_m; }
  [[nodiscard]] double per_j(double rate_per_j) const { return rate_per_j / (force * displacement); }
};

struct LawCase {
  std::string name;
  std::function<std::unique_ptr<Law>(const Scale&)> make_scaled;
  [[nodiscard]] std::unique_ptr<Law> make() const { return make_scaled({}); }
};

/// Wanders some ten yield displacements, so that every branch is visited.
std::vector<double> wandering_path(int length) {
  Random random{11};
  std::vector<double> path;
  double displacement_m = 0.0;
  for (int i = 0; i < length; ++i) {
    displacement_m = 0.98 * displacement_m + 0.01 * random.normal();
    path.push_back(displacement_m);
  }
  return path;
}

double impose(Law& law, double displacement_m) {
  const double force_n = law.trial(displacement_m, 0.0);
  law.commit();
  return force_n;
}

/// The trapezoidal rule over a corner of the law within a step of h leaves k h^2 / 8: 4e6 N/m, steps up to 4e-4 m, and
/// some ten corners of the same sign.
constexpr double kCornerWork_j = 1.0;

/// The least that the work done on a virgin law comes to along a path.
double least_work_j(Law& law, const std::vector<double>& path) {
  double displacement_m = 0.0;
  double force_n = 0.0;
  double work_j = 0.0;
  double least_j = 0.0;
  constexpr int kSteps = 100;
  for (const double towards_m : path) {
    const double step_m = (towards_m - displacement_m) / kSteps;
    for (int i = 0; i < kSteps; ++i) {
      displacement_m += step_m;
      const double next_n = impose(law, displacement_m);
      work_j += 0.5 * (force_n + next_n) * step_m;
      least_j = std::min(least_j, work_j);
      force_n = next_n;
    }
  }
  return least_j;
}

/// What every law owes its callers, whatever its equation.
class EveryLaw : public testing::TestWithParam<LawCase> {};

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

TEST_P(EveryLaw, GivesBackNoMoreThanTheWorkDoneOnIt) {
  const auto law = GetParam().make();
  EXPECT_GE(least_work_j(*law, wandering_path(400)), -kCornerWork_j);
}

TEST(EveryLawControl, ALawThatPushesGivesMoreWorkThanItTook) {
  class Pushing final : public Law {
   public:
    double trial(double displacement_m, double /*velocity_m_per_s*/) noexcept override {
      trial_m_ = displacement_m;
      return displacement_m < committed_m_ ? 100.0 : -100.0;
    }
    void commit() noexcept override { committed_m_ = trial_m_; }
    void revert() noexcept override {}
    void reset() noexcept override {}
    [[nodiscard]] double initial_stiffness_n_per_m() const noexcept override { return 0.0; }

   private:
    double committed_m_ = 0.0;
    double trial_m_ = 0.0;
  };
  Pushing pushing;
  EXPECT_LT(least_work_j(pushing, wandering_path(400)), -kCornerWork_j);
}

TEST_P(EveryLaw, ForcesScaleTogether) {
  const auto law = GetParam().make();
  const auto scaled = GetParam().make_scaled({.force = 3.0});
  for (const double displacement_m : wandering_path(2000))
    // Where a corner lies within rounding of the path, one is before it and the other behind.
    ASSERT_NEAR(impose(*scaled, displacement_m), 3.0 * impose(*law, displacement_m), 1e-5);
}

TEST_P(EveryLaw, DisplacementsScaleTogether) {
  const auto law = GetParam().make();
  const auto scaled = GetParam().make_scaled({.displacement = 3.0});
  for (const double displacement_m : wandering_path(2000))
    ASSERT_NEAR(impose(*scaled, 3.0 * displacement_m), impose(*law, displacement_m), 1e-5);
}

INSTANTIATE_TEST_SUITE_P(
    Mechanics, EveryLaw,
    testing::Values(
        LawCase{"elastic", [](const Scale& by) { return std::make_unique<Elastic>(by.n_per_m(4.0e6)); }},
        LawCase{"parallel",
                [](const Scale& by) {
                  std::vector<std::unique_ptr<Law>> laws;
                  laws.push_back(std::make_unique<Elastic>(by.n_per_m(2.0e6)));
                  laws.push_back(std::make_unique<Bilinear>(Bilinear::Parameters{
                      .stiffness_n_per_m = by.n_per_m(2.0e6), .yield_force_n = by.n(2.0e4), .hardening_ratio = 0.05}));
                  return std::make_unique<Parallel>(std::move(laws));
                }},
        LawCase{"bilinear",
                [](const Scale& by) {
                  return std::make_unique<Bilinear>(Bilinear::Parameters{
                      .stiffness_n_per_m = by.n_per_m(4.0e6), .yield_force_n = by.n(4.0e4), .hardening_ratio = 0.05});
                }},
        LawCase{"giuffre_menegotto_pinto",
                [](const Scale& by) {
                  return std::make_unique<GiuffreMenegottoPinto>(
                      GiuffreMenegottoPinto::Parameters{.stiffness_n_per_m = by.n_per_m(4.0e6),
                                                        .yield_force_n = by.n(4.0e4),
                                                        .hardening_ratio = 0.03,
                                                        .r0 = 18.0});
                }},
        LawCase{"bouc_wen",
                [](const Scale& by) {
                  return std::make_unique<BoucWen>(
                      BoucWen::Parameters{.stiffness_n_per_m = by.n_per_m(4.0e6),
                                          .alpha = 0.1,
                                          .n = 1.4,
                                          .gamma_per_m = 150.0 / std::pow(by.displacement, 1.4),
                                          .beta_per_m = 350.0 / std::pow(by.displacement, 1.4)});
                }},
        LawCase{"bouc_wen_baber_noori",
                [](const Scale& by) {
                  return std::make_unique<BoucWenBaberNoori>(
                      BoucWenBaberNoori::Parameters{.stiffness_n_per_m = by.n_per_m(4.0e6),
                                                    .alpha = 0.1,
                                                    .n = 1.4,
                                                    .gamma_per_m = 150.0 / std::pow(by.displacement, 1.4),
                                                    .beta_per_m = 350.0 / std::pow(by.displacement, 1.4),
                                                    .strength_degradation_per_j = by.per_j(1.0e-5),
                                                    .stiffness_degradation_per_j = by.per_j(2.0e-5),
                                                    .pinching = 0.8,
                                                    .pinching_rate_per_j = by.per_j(1.0e-4),
                                                    .pinching_level = 0.1,
                                                    .pinching_width_m = by.m(0.003)});
                }},
        LawCase{"peak_oriented",
                [](const Scale& by) {
                  return std::make_unique<PeakOriented>(PeakOriented::Parameters{
                      .stiffness_n_per_m = by.n_per_m(4.0e6), .yield_force_n = by.n(4.0e4), .hardening_ratio = 0.05});
                }},
        LawCase{"peak_oriented_deteriorating",
                [](const Scale& by) {
                  return std::make_unique<PeakOriented>(
                      PeakOriented::Parameters{.stiffness_n_per_m = by.n_per_m(4.0e6),
                                               .yield_force_n = by.n(4.0e4),
                                               .hardening_ratio = 0.05,
                                               .capping_displacement_m = by.m(0.03),
                                               .post_capping_displacement_m = by.m(0.1),
                                               .residual_ratio = 0.1,
                                               .strength_capacity_m = by.m(9.0),
                                               .capping_capacity_m = by.m(15.0),
                                               .unloading_capacity_m = by.m(20.0),
                                               .reloading_capacity_m = by.m(12.0),
                                               .deterioration_exponent = 0.9});
                }},
        LawCase{"pinching",
                [](const Scale& by) {
                  PinchedReloading::Parameters parameters;
                  parameters.stiffness_n_per_m = by.n_per_m(4.0e6);
                  parameters.yield_force_n = by.n(4.0e4);
                  parameters.hardening_ratio = 0.05;
                  parameters.strength_capacity_m = by.m(9.0);
                  parameters.pinching_force_ratio = 0.3;
                  parameters.pinching_displacement_ratio = 0.4;
                  return std::make_unique<PinchedReloading>(parameters);
                }},
        LawCase{"takeda",
                [](const Scale& by) {
                  return std::make_unique<Takeda>(Takeda::Parameters{.stiffness_n_per_m = by.n_per_m(8.0e6),
                                                                     .yield_force_n = by.n(4.0e4),
                                                                     .hardening_ratio = 0.03,
                                                                     .cracking_force_n = by.n(1.5e4),
                                                                     .cracked_ratio = 0.4,
                                                                     .unloading_exponent = 0.5});
                }},
        LawCase{"self_centring",
                [](const Scale& by) {
                  return std::make_unique<SelfCentring>(SelfCentring::Parameters{.stiffness_n_per_m = by.n_per_m(4.0e6),
                                                                                 .activation_force_n = by.n(4.0e4),
                                                                                 .hardening_ratio = 0.1,
                                                                                 .flag_ratio = 0.8});
                }},
        LawCase{"ramberg_osgood",
                [](const Scale& by) {
                  return std::make_unique<RambergOsgood>(RambergOsgood::Parameters{
                      .stiffness_n_per_m = by.n_per_m(4.0e6), .yield_force_n = by.n(4.0e4), .exponent = 7.0});
                }},
        LawCase{"giuffre_menegotto_pinto_isotropic",
                [](const Scale& by) {
                  return std::make_unique<GiuffreMenegottoPinto>(
                      GiuffreMenegottoPinto::Parameters{.stiffness_n_per_m = by.n_per_m(4.0e6),
                                                        .yield_force_n = by.n(4.0e4),
                                                        .hardening_ratio = 0.03,
                                                        .a1 = 0.04,
                                                        .a2 = 2.0,
                                                        .a3 = 0.04,
                                                        .a4 = 2.0});
                }},
        LawCase{"friction_pendulum",
                [](const Scale& by) {
                  return std::make_unique<FrictionPendulum>(
                      FrictionPendulum::Parameters{.weight_n = by.n(4.0e5),
                                                   .radius_m = by.m(2.0),
                                                   .friction_coefficient = 0.08,
                                                   .slow_friction_ratio = 0.5,
                                                   .friction_rate_s_per_m = 50.0,
                                                   .presliding_displacement_m = by.m(0.001)});
                }},
        LawCase{"lead_rubber",
                [](const Scale& by) {
                  return std::make_unique<LeadRubber>(
                      LeadRubber::Parameters{.rubber_stiffness_n_per_m = by.n_per_m(4.0e5),
                                             .lead_strength_n = by.n(4.0e4),
                                             .yield_displacement_m = by.m(0.01),
                                             .heating_path_m = by.m(3.0)});
                }},
        LawCase{"mr_damper",
                [](const Scale& by) {
                  return std::make_unique<MrDamper>(
                      MrDamper::Parameters{.damping_n_s_per_m = 1.0e4 * by.force / by.displacement,
                                           .stiffness_n_per_m = by.n_per_m(1.0e4),
                                           .hysteretic_force_n = by.n(2.0e3),
                                           .hysteretic_displacement_m = by.m(0.01)});
                }},
        LawCase{"elastomer",
                [](const Scale& by) {
                  return std::make_unique<Elastomer>(Elastomer::Parameters{
                      .stiffness_n_per_m = by.n_per_m(4.0e5),
                      .stiffening_n_per_m3 = by.n_per_m(4.0e7) / (by.displacement * by.displacement),
                      .mullins_softening = 0.4,
                      .mullins_displacement_m = by.m(0.03),
                      .payne_force_n = by.n(4.0e3),
                      .payne_displacement_m = by.m(0.01)});
                }},
        LawCase{"friction",
                [](const Scale& by) {
                  return std::make_unique<Friction>(
                      Friction::Parameters{.friction_force_n = by.n(500.0), .presliding_displacement_m = by.m(0.01)});
                }},
        LawCase{"gap",
                [](const Scale& by) {
                  return std::make_unique<GapSpring>(
                      GapSpring::Parameters{.stiffness_n_per_m = by.n_per_m(4.0e6), .gap_m = by.m(0.01)});
                }}),
    [](const testing::TestParamInfo<LawCase>& law) { return law.param.name; });

}  // namespace
}  // namespace hybridtest
