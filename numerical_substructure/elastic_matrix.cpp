#include "numerical_substructure/elastic_matrix.hpp"

#include "core/assert.hpp"
#include "mechanics/structure/stiffness_matrix.hpp"

namespace hybridtest {

ElasticMatrix::ElasticMatrix(const Eigen::MatrixXd& stiffness_n_per_m)
    : stiffness_n_per_m_{checked_stiffness(stiffness_n_per_m)} {}

void ElasticMatrix::trial(const InterfaceVector& displacement_m, const InterfaceVector& /*velocity_m_per_s*/,
                          InterfaceVector& force_n) noexcept {
  HYBRIDTEST_ASSERT(displacement_m.size() == interface_dofs());
  HYBRIDTEST_ASSERT(force_n.size() == interface_dofs());
  // lazyProduct() allocates no buffer.
  force_n.noalias() = stiffness_n_per_m_.lazyProduct(displacement_m);
}

}  // namespace hybridtest
