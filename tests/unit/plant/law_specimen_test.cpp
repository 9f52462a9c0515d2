#include "plant/specimens/law_specimen.hpp"

#include <gtest/gtest.h>

#include "core/config_error.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "mechanics/laws/elastic.hpp"

namespace hybridtest {
namespace {

TEST(LawSpecimen, KeepsImposedDisplacement) {
  std::vector<std::unique_ptr<Law>> laws;
  laws.push_back(std::make_unique<Elastic>(2.0e6));
  laws.push_back(std::make_unique<Bilinear>(
      Bilinear::Parameters{.stiffness_n_per_m = 4.0e6, .yield_force_n = 4.0e4, .hardening_ratio = 0.0}));
  LawSpecimen specimen{std::move(laws)};
  ASSERT_EQ(specimen.dofs(), 2);
  const SiteVector at_rest = SiteVector::Zero(2);
  SiteVector force_n = at_rest;
  specimen.impose(SiteVector{{0.01, 0.03}}, at_rest, force_n);
  EXPECT_DOUBLE_EQ(force_n[0], 2.0e4);
  EXPECT_DOUBLE_EQ(force_n[1], 4.0e4);
  specimen.impose(SiteVector{{0.0, 0.02}}, at_rest, force_n);  // elastic back to nothing
  EXPECT_EQ(force_n[0], 0.0);
  EXPECT_NEAR(force_n[1], 0.0, 1e-9);
  specimen.reset();
  specimen.impose(SiteVector{{0.0, 0.005}}, at_rest, force_n);
  EXPECT_DOUBLE_EQ(force_n[1], 2.0e4);
}

TEST(LawSpecimen, RejectsNoLawAndTooMany) {
  const auto make = [](int count) {
    std::vector<std::unique_ptr<Law>> laws;
    for (int i = 0; i < count; ++i) laws.push_back(std::make_unique<Elastic>(1.0));
    return LawSpecimen{std::move(laws)};
  };
  EXPECT_THROW(make(0), ConfigError);
  EXPECT_NO_THROW(make(kMaxSiteDofs));
  EXPECT_THROW(make(kMaxSiteDofs + 1), ConfigError);
}

}  // namespace
}  // namespace hybridtest
