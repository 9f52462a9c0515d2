#pragma once

#include <Eigen/Core>

#include "plant/specimens/specimen.hpp"

namespace hybridtest {

/// Elastic test piece that couples its actuators: force = stiffness * displacement.
class ElasticSpecimen final : public Specimen {
 public:
  /// @throws ConfigError as checked_stiffness().
  explicit ElasticSpecimen(const Eigen::MatrixXd& stiffness_n_per_m);

  [[nodiscard]] int dofs() const noexcept override { return static_cast<int>(stiffness_n_per_m_.rows()); }
  void impose(const SiteVector& displacement_m, const SiteVector& velocity_m_per_s,
              SiteVector& force_n) noexcept override;
  void reset() noexcept override {}

 private:
  SiteMatrix stiffness_n_per_m_;
};

}  // namespace hybridtest
