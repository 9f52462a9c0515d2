#pragma once

#include "core/interface_vector.hpp"

namespace hybridtest {

/// Restoring force of a numerical substructure at its interface, with history.
class SubstructureModel {
 public:
  virtual ~SubstructureModel() = default;

  [[nodiscard]] virtual int interface_dofs() const noexcept = 0;
  /// Restoring force [N] at the displacement [m] reached from the committed state.
  /// @param force_n   sized interface_dofs() by the caller.
  virtual void trial(const InterfaceVector& displacement_m, const InterfaceVector& velocity_m_per_s,
                     InterfaceVector& force_n) noexcept = 0;
  virtual void commit() noexcept = 0;
  virtual void revert() noexcept = 0;
  virtual void reset() noexcept = 0;
  /// interface_dofs() square, symmetric [N/m].
  [[nodiscard]] virtual InterfaceMatrix initial_stiffness_n_per_m() const = 0;
};

}  // namespace hybridtest
