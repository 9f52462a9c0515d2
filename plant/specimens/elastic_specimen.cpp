#include "plant/specimens/elastic_specimen.hpp"

#include "mechanics/structure/stiffness_matrix.hpp"

namespace hybridtest {

ElasticSpecimen::ElasticSpecimen(const Eigen::MatrixXd& stiffness_n_per_m)
    : stiffness_n_per_m_{checked_stiffness(stiffness_n_per_m)} {}

void ElasticSpecimen::impose(const SiteVector& displacement_m, const SiteVector& /*velocity_m_per_s*/,
                             SiteVector& force_n) noexcept {
  // lazyProduct: coefficient by coefficient, with no buffer to allocate.
  force_n.noalias() = stiffness_n_per_m_.lazyProduct(displacement_m);
}

}  // namespace hybridtest
