#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "mechanics/laws/law.hpp"
#include "numerical_substructure/substructure_model.hpp"

namespace hybridtest {

/// Storeys in series, each a law of the drift between its two floors. The force of a storey acts
/// against the drift on its upper floor and in the opposite direction on its lower floor.
class ShearBuilding final : public SubstructureModel {
 public:
  /// Base of the first storey.
  enum class Base : std::uint8_t {
    ground,     // n storeys on n degrees of freedom, the floors above them
    first_dof,  // n storeys on n + 1 degrees of freedom, the first of which is the base
  };

  /// @param storeys   from the base up; none null.
  /// @throws ConfigError for no storey, and when they need more than kMaxInterfaceDofs.
  ShearBuilding(std::vector<std::unique_ptr<Law>> storeys, Base base);

  [[nodiscard]] int interface_dofs() const noexcept override;
  void trial(const InterfaceVector& displacement_m, const InterfaceVector& velocity_m_per_s,
             InterfaceVector& force_n) noexcept override;
  void commit() noexcept override;
  void revert() noexcept override;
  void reset() noexcept override;
  [[nodiscard]] InterfaceMatrix initial_stiffness_n_per_m() const override;

 private:
  std::vector<std::unique_ptr<Law>> storeys_;
  Base base_;
};

}  // namespace hybridtest
