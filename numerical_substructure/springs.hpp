#pragma once

#include <memory>
#include <vector>

#include "mechanics/laws/law.hpp"
#include "numerical_substructure/substructure_model.hpp"

namespace hybridtest {

/// One spring per interface degree of freedom, without coupling.
class Springs final : public SubstructureModel {
 public:
  /// @param laws   1 to kMaxInterfaceDofs, in the order of the interface; none null.
  /// @throws ConfigError for another number.
  explicit Springs(std::vector<std::unique_ptr<Law>> laws);

  [[nodiscard]] int interface_dofs() const noexcept override { return static_cast<int>(laws_.size()); }
  void trial(const InterfaceVector& displacement_m, const InterfaceVector& velocity_m_per_s,
             InterfaceVector& force_n) noexcept override;
  void commit() noexcept override;
  void revert() noexcept override;
  void reset() noexcept override;
  [[nodiscard]] InterfaceMatrix initial_stiffness_n_per_m() const override;

 private:
  std::vector<std::unique_ptr<Law>> laws_;
};

}  // namespace hybridtest
