#pragma once

#include <Eigen/Core>

#include "numerical_substructure/substructure_model.hpp"

namespace hybridtest {

/// Linear substructure condensed to its interface: force = stiffness * displacement.
class ElasticMatrix final : public SubstructureModel {
 public:
  /// @param stiffness_n_per_m   full and symmetric; read_matrix_market() reads one from a file.
  /// @throws ConfigError as checked_stiffness().
  explicit ElasticMatrix(const Eigen::MatrixXd& stiffness_n_per_m);

  [[nodiscard]] int interface_dofs() const noexcept override { return static_cast<int>(stiffness_n_per_m_.rows()); }
  void trial(const InterfaceVector& displacement_m, const InterfaceVector& velocity_m_per_s,
             InterfaceVector& force_n) noexcept override;
  void commit() noexcept override {}
  void revert() noexcept override {}
  void reset() noexcept override {}
  [[nodiscard]] InterfaceMatrix initial_stiffness_n_per_m() const override { return stiffness_n_per_m_; }

 private:
  InterfaceMatrix stiffness_n_per_m_;
};

}  // namespace hybridtest
