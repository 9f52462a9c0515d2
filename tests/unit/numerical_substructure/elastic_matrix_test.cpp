#include "numerical_substructure/elastic_matrix.hpp"

#include <gtest/gtest.h>

#include "core/config_error.hpp"
#include "core/random.hpp"

namespace hybridtest {
namespace {

TEST(ElasticMatrix, ForceIsStiffnessTimesDisplacement) {
  ElasticMatrix model{Eigen::MatrixXd{{2.0, -1.0}, {-1.0, 3.0}}};
  ASSERT_EQ(model.interface_dofs(), 2);
  InterfaceVector force_n = InterfaceVector::Zero(2);
  model.trial(InterfaceVector{{0.5, -2.0}}, InterfaceVector::Zero(2), force_n);
  EXPECT_EQ(force_n, (InterfaceVector{{3.0, -6.5}}));
  EXPECT_EQ(model.initial_stiffness_n_per_m(), (InterfaceMatrix{{2.0, -1.0}, {-1.0, 3.0}}));
}

TEST(ElasticMatrix, AcceptsLargestInterface) {
  Random random{4};
  Eigen::MatrixXd half(kMaxInterfaceDofs, 2);
  for (double& entry : half.reshaped()) entry = random.normal();
  const Eigen::MatrixXd stiffness = half * half.transpose();
  ElasticMatrix model{stiffness};
  InterfaceVector force_n = InterfaceVector::Zero(kMaxInterfaceDofs);
  for (int dof = 0; dof < kMaxInterfaceDofs; dof += 89) {
    model.trial(InterfaceVector::Unit(kMaxInterfaceDofs, dof), InterfaceVector::Zero(kMaxInterfaceDofs), force_n);
    EXPECT_LT((force_n - stiffness.col(dof)).norm(), 1e-13 * stiffness.col(dof).norm()) << dof;
  }
}

TEST(ElasticMatrix, RejectsInvalidStiffness) {
  EXPECT_THROW((ElasticMatrix{Eigen::MatrixXd{{1.0, 2.0}, {0.0, 1.0}}}), ConfigError);
  EXPECT_THROW((ElasticMatrix{Eigen::MatrixXd::Ones(2, 3)}), ConfigError);
}

}  // namespace
}  // namespace hybridtest
