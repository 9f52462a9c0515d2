#pragma once

#include "core/interface_vector.hpp"

namespace hybridtest {

/// A simulated test piece: displacements imposed, forces answered. Unlike a numerical model it
/// cannot be tried: what was imposed has happened.
class Specimen {
 public:
  virtual ~Specimen() = default;

  /// Actuators that move it.
  [[nodiscard]] virtual int dofs() const noexcept = 0;
  /// Moves it on, once per control sample.
  /// @param displacement_m, velocity_m_per_s   dofs() entries, at the end of the sample.
  /// @param force_n                            sized dofs() by the caller; positive when it
  ///                                           resists a positive displacement.
  virtual void impose(const SiteVector& displacement_m, const SiteVector& velocity_m_per_s,
                      SiteVector& force_n) noexcept = 0;
  /// As new.
  virtual void reset() noexcept = 0;
};

}  // namespace hybridtest
