#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "mechanics/laws/law.hpp"
#include "numerical_substructure/substructure_model.hpp"

namespace hybridtest {

/// A law of an elongation, which is a weighted sum of displacements of the interface.
struct Spring {
  struct End {
    Eigen::Index dof = 0;  // of the interface
    double factor = 1.0;   // elongation per unit of its displacement; for a brace the cosine of its angle
  };
  std::vector<End> ends;
  std::unique_ptr<Law> law;
};

/// Springs between degrees of freedom of the interface, and between them and the ground, also several side by side:
///
///     e_s = c_s^T u,   r = sum over s of c_s F_s(e_s, c_s^T v),   K = sum over s of c_s k_s c_s^T
///
/// with the factors c_s of the ends of spring s. Forces are added in the order of the springs.
class SpringNetwork final : public SubstructureModel {
 public:
  /// @param springs   each with an end and a law.
  /// @throws ConfigError for a degree of freedom without a spring, and for a factor that is zero or not finite.
  SpringNetwork(int interface_dofs, std::vector<Spring> springs);

  [[nodiscard]] int interface_dofs() const noexcept override { return interface_dofs_; }
  void trial(const InterfaceVector& displacement_m, const InterfaceVector& velocity_m_per_s,
             InterfaceVector& force_n) noexcept override;
  void commit() noexcept override;
  void revert() noexcept override;
  void reset() noexcept override;
  [[nodiscard]] InterfaceMatrix initial_stiffness_n_per_m() const override;

 private:
  int interface_dofs_;
  std::vector<Spring> springs_;
};

/// Base of the first storey of a shear building.
enum class StoreyBase : std::uint8_t {
  ground,     // n storeys on n degrees of freedom, the floors above them
  first_dof,  // n storeys on n + 1 degrees of freedom, the first of which is the base
};

/// One spring to the ground for each law, on one degree of freedom after the other.
/// @throws ConfigError without a law.
[[nodiscard]] SpringNetwork springs_to_ground(std::vector<std::unique_ptr<Law>> laws);

/// Storeys in series from the base up, each a law of the drift between its two floors.
/// @throws ConfigError without a storey.
[[nodiscard]] SpringNetwork shear_building(std::vector<std::unique_ptr<Law>> storeys, StoreyBase base);

}  // namespace hybridtest
