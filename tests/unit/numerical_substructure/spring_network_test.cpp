#include "numerical_substructure/spring_network.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/config_error.hpp"
#include "core/random.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "mechanics/laws/elastic.hpp"
#include "mechanics/laws/viscous.hpp"

namespace hybridtest {
namespace {

std::vector<std::unique_ptr<Law>> elastic_laws(const std::vector<double>& stiffness_n_per_m) {
  std::vector<std::unique_ptr<Law>> laws;
  for (const double stiffness : stiffness_n_per_m) laws.push_back(std::make_unique<Elastic>(stiffness));
  return laws;
}

std::unique_ptr<Law> yielding(double hardening_ratio) {
  return std::make_unique<Bilinear>(
      Bilinear::Parameters{.stiffness_n_per_m = 4.0e6, .yield_force_n = 4.0e4, .hardening_ratio = hardening_ratio});
}

Spring spring(std::vector<Spring::End> ends, std::unique_ptr<Law> law) {
  return {.ends = std::move(ends), .law = std::move(law)};
}

SpringNetwork network(int dofs, Spring one) {
  std::vector<Spring> springs;
  springs.push_back(std::move(one));
  return {dofs, std::move(springs)};
}

/// Force at a displacement, at rest.
InterfaceVector force_at(SpringNetwork& model, const InterfaceVector& displacement_m) {
  InterfaceVector force_n = InterfaceVector::Zero(model.interface_dofs());
  model.trial(displacement_m, InterfaceVector::Zero(model.interface_dofs()), force_n);
  return force_n;
}

TEST(SpringNetwork, BraceActsAlongItsAxis) {
  SpringNetwork brace =
      network(2, spring({{.dof = 1, .factor = 0.8}, {.dof = 0, .factor = -0.6}}, std::make_unique<Elastic>(100.0)));
  const InterfaceVector force_n = force_at(brace, InterfaceVector{{0.1, 0.2}});  // elongation 0.1 m
  EXPECT_NEAR(force_n[0], -6.0, 1e-12);
  EXPECT_NEAR(force_n[1], 8.0, 1e-12);
  const InterfaceMatrix stiffness = brace.initial_stiffness_n_per_m();
  EXPECT_TRUE(stiffness.isApprox(InterfaceMatrix{{36.0, -48.0}, {-48.0, 64.0}}, 1e-14)) << stiffness;
}

TEST(SpringNetwork, SpringsSideBySideAddUp) {
  std::vector<Spring> springs;
  springs.push_back(spring({{.dof = 0}}, std::make_unique<Elastic>(100.0)));
  springs.push_back(spring({{.dof = 0}}, std::make_unique<Viscous>(Viscous::Parameters{.damping_n_s_per_m = 20.0})));
  springs.push_back(spring({{.dof = 0}, {.dof = 1, .factor = -1.0}}, std::make_unique<Elastic>(10.0)));
  SpringNetwork model{2, std::move(springs)};
  InterfaceVector force_n = InterfaceVector::Zero(2);
  model.trial(InterfaceVector{{0.1, 0.3}}, InterfaceVector{{0.5, 7.0}}, force_n);
  EXPECT_NEAR(force_n[0], 10.0 + 10.0 - 2.0, 1e-12);
  EXPECT_NEAR(force_n[1], 2.0, 1e-12);
}

TEST(SpringNetwork, LawGetsTheVelocityOfItsElongation) {
  SpringNetwork damper = network(2, spring({{.dof = 0, .factor = 0.5}, {.dof = 1, .factor = -0.5}},
                                           std::make_unique<Viscous>(Viscous::Parameters{.damping_n_s_per_m = 20.0})));
  InterfaceVector force_n = InterfaceVector::Zero(2);
  damper.trial(InterfaceVector{{5.0, -3.0}}, InterfaceVector{{0.4, -0.2}}, force_n);
  EXPECT_NEAR(force_n[0], 0.5 * 20.0 * 0.3, 1e-12);
  EXPECT_NEAR(force_n[1], -0.5 * 20.0 * 0.3, 1e-12);
  EXPECT_EQ(damper.initial_stiffness_n_per_m(), InterfaceMatrix::Zero(2, 2));
}

TEST(SpringNetwork, ElasticForceIsStiffnessTimesDisplacement) {
  Random random{2};
  constexpr int kDofs = 200;  // more than a site has
  std::vector<Spring> springs;
  for (int s = 0; s < 3 * kDofs; ++s) {
    std::vector<Spring::End> ends{{.dof = s % kDofs, .factor = random.uniform(0.2, 1.0)}};
    if (s % 3 != 0) ends.push_back({.dof = (s + 3) % kDofs, .factor = random.uniform(-1.0, -0.2)});
    springs.push_back(spring(std::move(ends), std::make_unique<Elastic>(random.uniform(1.0, 9.0))));
  }
  SpringNetwork model{kDofs, std::move(springs)};
  InterfaceVector displacement_m = InterfaceVector::Zero(kDofs);
  for (double& displacement : displacement_m) displacement = random.normal();
  const InterfaceVector expected = model.initial_stiffness_n_per_m() * displacement_m;
  EXPECT_LT((force_at(model, displacement_m) - expected).norm(), 1e-13 * expected.norm());
}

TEST(SpringNetwork, CommitRevertAndResetReachEveryLaw) {
  std::vector<std::unique_ptr<Law>> laws = elastic_laws({3.0e6});
  laws.push_back(yielding(0.05));
  SpringNetwork springs = springs_to_ground(std::move(laws));
  const InterfaceVector at_rest = InterfaceVector::Zero(2);
  const InterfaceVector yielded{{0.01, -0.03}};
  InterfaceVector force_n = force_at(springs, yielded);
  EXPECT_DOUBLE_EQ(force_n[0], 3.0e4);
  EXPECT_DOUBLE_EQ(force_n[1], -4.4e4);
  EXPECT_EQ(springs.initial_stiffness_n_per_m(), (InterfaceMatrix{{3.0e6, 0.0}, {0.0, 4.0e6}}));
  springs.revert();
  EXPECT_EQ(force_at(springs, at_rest), at_rest);
  force_n = force_at(springs, yielded);
  springs.commit();
  EXPECT_NEAR(force_at(springs, at_rest)[1], -(4.4e4 - 8.0e4 - 0.05 * 4.0e6 * 0.01), 1e-9);
  springs.reset();
  EXPECT_EQ(force_at(springs, at_rest), at_rest);
}

TEST(SpringNetwork, RejectsFreeDofAndUselessFactor) {
  const auto with_factor = [](double factor) {
    return network(1, spring({{.dof = 0, .factor = factor}}, std::make_unique<Elastic>(1.0)));
  };
  EXPECT_NO_THROW(with_factor(-0.5));
  EXPECT_THROW(with_factor(0.0), ConfigError);
  EXPECT_THROW(with_factor(std::numeric_limits<double>::infinity()), ConfigError);
  EXPECT_THAT(
      [] {
        network(3, spring({{.dof = 0}, {.dof = 2, .factor = -1.0}}, std::make_unique<Elastic>(1.0)));
      },
      testing::ThrowsMessage<ConfigError>(testing::HasSubstr("no spring acts on degree of freedom 2")));
  EXPECT_THROW(springs_to_ground({}), ConfigError);
  EXPECT_THROW(shear_building({}, StoreyBase::ground), ConfigError);
  EXPECT_THROW(shear_building({}, StoreyBase::first_dof), ConfigError);
}

TEST(ShearBuilding, FixedBuildingHasTextbookStiffness) {
  const SpringNetwork building = shear_building(elastic_laws({4.0, 3.0, 2.0}), StoreyBase::ground);
  const InterfaceMatrix expected{{7.0, -3.0, 0.0}, {-3.0, 5.0, -2.0}, {0.0, -2.0, 2.0}};
  ASSERT_EQ(building.interface_dofs(), 3);
  EXPECT_EQ(building.initial_stiffness_n_per_m(), expected);
}

TEST(ShearBuilding, UnfixedBuildingAllowsRigidBodyMotion) {
  SpringNetwork building = shear_building(elastic_laws({4.0, 3.0}), StoreyBase::first_dof);
  const InterfaceMatrix expected{{4.0, -4.0, 0.0}, {-4.0, 7.0, -3.0}, {0.0, -3.0, 3.0}};
  ASSERT_EQ(building.interface_dofs(), 3);
  EXPECT_EQ(building.initial_stiffness_n_per_m(), expected);
  EXPECT_EQ(force_at(building, InterfaceVector::Constant(3, 0.7)), InterfaceVector::Zero(3));
}

TEST(ShearBuilding, StoreyYieldsByDriftAndKeepsHistory) {
  std::vector<std::unique_ptr<Law>> storeys = elastic_laws({4.0e6});
  storeys.push_back(yielding(0.0));
  SpringNetwork building = shear_building(std::move(storeys), StoreyBase::ground);
  const InterfaceVector force_n = force_at(building, InterfaceVector{{0.1, 0.13}});  // three times the yield drift
  EXPECT_NEAR(force_n[0], 4.0e5 - 4.0e4, 1e-9);
  EXPECT_NEAR(force_n[1], 4.0e4, 1e-9);
  building.commit();
  EXPECT_NEAR(force_at(building, InterfaceVector{{0.1, 0.12}})[1], 0.0, 1e-8);  // elastic back to nothing
}

}  // namespace
}  // namespace hybridtest
