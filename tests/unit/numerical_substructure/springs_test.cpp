#include "numerical_substructure/springs.hpp"

#include <gtest/gtest.h>

#include "core/config_error.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "mechanics/laws/elastic.hpp"

namespace hybridtest {
namespace {

Springs elastic_and_bilinear() {
  std::vector<std::unique_ptr<Law>> laws;
  laws.push_back(std::make_unique<Elastic>(3.0e6));
  laws.push_back(std::make_unique<Bilinear>(
      Bilinear::Parameters{.stiffness_n_per_m = 4.0e6, .yield_force_n = 4.0e4, .hardening_ratio = 0.05}));
  return Springs{std::move(laws)};
}

TEST(Springs, EachActsOnItsOwnDegreeOfFreedom) {
  Springs springs = elastic_and_bilinear();
  ASSERT_EQ(springs.interface_dofs(), 2);
  InterfaceVector force_n = InterfaceVector::Zero(2);
  springs.trial(InterfaceVector{{0.01, -0.03}}, InterfaceVector::Zero(2), force_n);
  EXPECT_DOUBLE_EQ(force_n[0], 3.0e4);
  EXPECT_DOUBLE_EQ(force_n[1], -4.4e4);
  EXPECT_EQ(springs.initial_stiffness_n_per_m(), (InterfaceMatrix{{3.0e6, 0.0}, {0.0, 4.0e6}}));
}

TEST(Springs, CommitRevertAndResetReachEveryLaw) {
  Springs springs = elastic_and_bilinear();
  const InterfaceVector at_rest = InterfaceVector::Zero(2);
  InterfaceVector force_n = at_rest;
  springs.trial(InterfaceVector{{0.0, 0.03}}, at_rest, force_n);
  springs.revert();
  springs.trial(at_rest, at_rest, force_n);
  EXPECT_EQ(force_n[1], 0.0);
  springs.trial(InterfaceVector{{0.0, 0.03}}, at_rest, force_n);
  springs.commit();
  springs.trial(at_rest, at_rest, force_n);
  EXPECT_NEAR(force_n[1], 4.4e4 - 8.0e4 - 0.05 * 4.0e6 * 0.01, 1e-9);
  springs.reset();
  springs.trial(at_rest, at_rest, force_n);
  EXPECT_EQ(force_n[1], 0.0);
}

TEST(Springs, RejectsNoSpringAndTooMany) {
  const auto make = [](int count) {
    std::vector<std::unique_ptr<Law>> laws;
    for (int i = 0; i < count; ++i) laws.push_back(std::make_unique<Elastic>(1.0));
    return Springs{std::move(laws)};
  };
  EXPECT_THROW(make(0), ConfigError);
  EXPECT_NO_THROW(make(kMaxInterfaceDofs));
  EXPECT_THROW(make(kMaxInterfaceDofs + 1), ConfigError);
}

}  // namespace
}  // namespace hybridtest
