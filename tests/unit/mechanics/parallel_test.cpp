#include "mechanics/laws/parallel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "core/config_error.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "mechanics/laws/elastic.hpp"
#include "mechanics/laws/friction.hpp"
#include "mechanics/laws/giuffre_menegotto_pinto.hpp"
#include "mechanics/laws/viscous.hpp"
#include "tests/support/malloc_count.hpp"

namespace hybridtest {
namespace {

template <class... Laws>
Parallel beside(Laws... laws) {
  std::vector<std::unique_ptr<Law>> all;
  (all.push_back(std::make_unique<Laws>(laws)), ...);
  return Parallel{std::move(all)};
}

const Friction kFriction{{.friction_force_n = 500.0, .presliding_displacement_m = 1.0e-3}};

TEST(Parallel, TellsEachLawWhichReversalsAreNoise) {
  const GiuffreMenegottoPinto steel{{.stiffness_n_per_m = 4.0e6, .yield_force_n = 4.0e4, .hardening_ratio = 0.03}};
  const auto pull = [&](double noise_m, const std::vector<double>& path_m) {
    Parallel law = beside(Elastic{1.0e5}, steel);
    law.ignore_reversals_within(noise_m);
    double force_n = 0.0;
    for (const double x_m : path_m) {
      force_n = law.trial(x_m, 0.0);
      law.commit();
    }
    return force_n;
  };
  const double along_n = pull(0.0, {-0.04, -0.01, 0.0});
  EXPECT_EQ(pull(3e-4, {-0.04, -0.01, -0.0102, 0.0}), along_n);
  EXPECT_NE(pull(0.0, {-0.04, -0.01, -0.0102, 0.0}), along_n);  // control
}

TEST(Parallel, AddsSpringAndDashpot) {
  Parallel law = beside(Elastic{4.0e6}, Viscous{{.damping_n_s_per_m = 2.0e4}});
  EXPECT_EQ(law.initial_stiffness_n_per_m(), 4.0e6);
  for (int i = 0; i < 100; ++i) {
    const double t_s = 0.01 * i;
    const double x_m = 0.02 * std::sin(5.0 * t_s);
    const double v_m_per_s = 0.1 * std::cos(5.0 * t_s);
    EXPECT_DOUBLE_EQ(law.trial(x_m, v_m_per_s), 4.0e6 * x_m + 2.0e4 * v_m_per_s);
    law.commit();
  }
}

TEST(Parallel, AddsSpringAndFrictionOverACycle) {
  Parallel law = beside(Elastic{1.0e5}, kFriction);
  EXPECT_DOUBLE_EQ(law.initial_stiffness_n_per_m(), 1.0e5 + 5.0e5);
  const auto force_at = [&](double x_m) {
    const double force_n = law.trial(x_m, 0.0);
    law.commit();
    return force_n;
  };
  EXPECT_DOUBLE_EQ(force_at(0.0005), 50.0 + 250.0);  // sticks
  EXPECT_DOUBLE_EQ(force_at(0.010), 1000.0 + 500.0);
  EXPECT_NEAR(force_at(0.009), 900.0, 1e-9);  // half of the reversal: the friction is zero but for rounding
  EXPECT_DOUBLE_EQ(force_at(-0.010), -1000.0 - 500.0);
}

TEST(Parallel, RevertAndResetReachEveryLaw) {
  const Bilinear bilinear{{.stiffness_n_per_m = 1.0e6, .yield_force_n = 1.0e3, .hardening_ratio = 0.1}};
  Parallel law = beside(bilinear, kFriction);
  const double virgin_n = law.trial(0.0004, 0.0);
  static_cast<void>(law.trial(0.05, 0.0));
  law.revert();
  EXPECT_EQ(law.trial(0.0004, 0.0), virgin_n);
  static_cast<void>(law.trial(0.05, 0.0));
  law.commit();
  EXPECT_NE(law.trial(0.0004, 0.0), virgin_n);
  law.reset();
  EXPECT_EQ(law.trial(0.0004, 0.0), virgin_n);
}

TEST(Parallel, AllocatesNothingAfterConstruction) {
  if (!counts_mallocs()) GTEST_SKIP() << "a sanitizer owns the allocator";
  Parallel law = beside(Elastic{4.0e6}, kFriction);
  const std::size_t before = malloc_count();
  for (int i = 0; i < 100; ++i) {
    static_cast<void>(law.trial(0.001 * i, 0.0));
    i % 2 == 0 ? law.commit() : law.revert();
  }
  law.reset();
  EXPECT_EQ(malloc_count(), before);
}

TEST(Parallel, RefusesNoLaws) { EXPECT_THROW(Parallel{std::vector<std::unique_ptr<Law>>{}}, ConfigError); }

}  // namespace
}  // namespace hybridtest
