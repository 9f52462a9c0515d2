#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "mechanics/laws/law.hpp"
#include "numerical_substructure/substructure_model.hpp"

namespace hybridtest {

/// Storeys in series, each a law of the drift between its two floors. A storey pulls its upper
/// floor back by its force and its lower floor along by as much.
class ShearBuilding final : public SubstructureModel {
 public:
  /// What the first storey stands on.
  enum class Base : std::uint8_t {
    ground,     // n storeys on n degrees of freedom, the floors above them
    first_dof,  // n storeys on n + 1 degrees of freedom, the first of which is the base
  };

  /// @param storeys   from the base up; none null.
  /// @throws ConfigError when they are none or need more than kMaxInterfaceDofs.
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
