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
  // Column by column: no buffer, and contiguous memory.
  force_n.setZero();
  for (Eigen::Index k = 0; k < displacement_m.size(); ++k) force_n += displacement_m[k] * stiffness_n_per_m_.col(k);
}

}  // namespace hybridtest
