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
  void impose(const InterfaceVector& displacement_m, const InterfaceVector& velocity_m_per_s,
              InterfaceVector& force_n) noexcept override;
  void reset() noexcept override {}

 private:
  InterfaceMatrix stiffness_n_per_m_;
};

}  // namespace hybridtest
