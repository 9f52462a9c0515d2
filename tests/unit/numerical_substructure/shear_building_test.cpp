#include "numerical_substructure/shear_building.hpp"

#include <gtest/gtest.h>

#include "core/config_error.hpp"
#include "core/random.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "mechanics/laws/elastic.hpp"

namespace hybridtest {
namespace {

std::vector<std::unique_ptr<Law>> elastic_storeys(const std::vector<double>& stiffness_n_per_m) {
  std::vector<std::unique_ptr<Law>> storeys;
  for (const double stiffness : stiffness_n_per_m) storeys.push_back(std::make_unique<Elastic>(stiffness));
  return storeys;
}

TEST(ShearBuilding, FixedBuildingHasTextbookStiffness) {
  ShearBuilding building{elastic_storeys({4.0, 3.0, 2.0}), ShearBuilding::Base::ground};
  const InterfaceMatrix expected{{7.0, -3.0, 0.0}, {-3.0, 5.0, -2.0}, {0.0, -2.0, 2.0}};
  ASSERT_EQ(building.interface_dofs(), 3);
  EXPECT_EQ(building.initial_stiffness_n_per_m(), expected);
}

TEST(ShearBuilding, UnfixedBuildingAllowsRigidBodyMotion) {
  ShearBuilding building{elastic_storeys({4.0, 3.0}), ShearBuilding::Base::first_dof};
  const InterfaceMatrix expected{{4.0, -4.0, 0.0}, {-4.0, 7.0, -3.0}, {0.0, -3.0, 3.0}};
  ASSERT_EQ(building.interface_dofs(), 3);
  EXPECT_EQ(building.initial_stiffness_n_per_m(), expected);
  InterfaceVector force_n = InterfaceVector::Zero(3);
  building.trial(InterfaceVector::Constant(3, 0.7), InterfaceVector::Zero(3), force_n);
  EXPECT_EQ(force_n, InterfaceVector::Zero(3));
}

TEST(ShearBuilding, ElasticForceIsStiffnessTimesDisplacement) {
  Random random{2};
  for (const auto base : {ShearBuilding::Base::ground, ShearBuilding::Base::first_dof}) {
    ShearBuilding building{elastic_storeys({4.0, 3.0, 2.5, 0.5}), base};
    InterfaceVector displacement_m = InterfaceVector::Zero(building.interface_dofs());
    for (double& displacement : displacement_m) displacement = random.normal();
    InterfaceVector force_n = displacement_m;
    building.trial(displacement_m, InterfaceVector::Zero(building.interface_dofs()), force_n);
    const InterfaceVector expected = building.initial_stiffness_n_per_m() * displacement_m;
    EXPECT_LT((force_n - expected).norm(), 1e-14 * 30.0);  // rounding
  }
}

TEST(ShearBuilding, StoreyYieldsByDriftAndKeepsHistory) {
  std::vector<std::unique_ptr<Law>> storeys = elastic_storeys({4.0e6});
  storeys.push_back(std::make_unique<Bilinear>(
      Bilinear::Parameters{.stiffness_n_per_m = 4.0e6, .yield_force_n = 4.0e4, .hardening_ratio = 0.0}));
  ShearBuilding building{std::move(storeys), ShearBuilding::Base::ground};
  const InterfaceVector at_rest = InterfaceVector::Zero(2);
  InterfaceVector force_n = at_rest;
  building.trial(InterfaceVector{{0.1, 0.13}}, at_rest, force_n);  // drift 0.03 m, three times the yield
  EXPECT_NEAR(force_n[0], 4.0e5 - 4.0e4, 1e-9);
  EXPECT_NEAR(force_n[1], 4.0e4, 1e-9);
  building.revert();
  building.trial(at_rest, at_rest, force_n);
  EXPECT_EQ(force_n, at_rest);
  building.trial(InterfaceVector{{0.1, 0.13}}, at_rest, force_n);
  building.commit();
  building.trial(InterfaceVector{{0.1, 0.12}}, at_rest, force_n);  // elastic back to nothing
  EXPECT_NEAR(force_n[1], 0.0, 1e-8);
  building.reset();
  building.trial(at_rest, at_rest, force_n);
  EXPECT_EQ(force_n, at_rest);
}

TEST(ShearBuilding, RejectsNoStoreyAndTooMany) {
  const auto make = [](std::size_t count, ShearBuilding::Base base) {
    return ShearBuilding{elastic_storeys(std::vector<double>(count, 1.0)), base};
  };
  EXPECT_THROW(make(0, ShearBuilding::Base::ground), ConfigError);
  EXPECT_NO_THROW(make(12, ShearBuilding::Base::ground));
  EXPECT_THROW(make(13, ShearBuilding::Base::ground), ConfigError);
  EXPECT_NO_THROW(make(11, ShearBuilding::Base::first_dof));
  EXPECT_THROW(make(12, ShearBuilding::Base::first_dof), ConfigError);
}

}  // namespace
}  // namespace hybridtest
