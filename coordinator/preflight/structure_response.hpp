#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "coordinator/preflight/integrator_response.hpp"
#include "mechanics/structure/interface_map.hpp"
#include "mechanics/structure/linear_structure.hpp"
#include "mechanics/structure/vibration_modes.hpp"

namespace hybridtest {

/// The integrated structure as the sites see it: from forces at their interfaces, beyond the initial stiffness, to the
/// commands. The P interface degrees of freedom of all sites are stacked.
///
/// The coordinates are the modes, each with an integrator of its own; coupled by the damping they share one. Where the
/// modes are not all of them, others stand for the rest: the static deflection under each interface force (residual
/// flexibility; Craig, Structural Dynamics, 1981, section 19.4), so that the interface is as flexible as it is, and
/// Lanczos vectors of the accelerations there, so that what happens soon after a force is right too.
class StructureResponse {
 public:
  /// @param modes   of the structure, all of them or the lowest.
  /// @param step_s  between commands. @param commands_per_step   of the method.
  StructureResponse(const LinearStructure& structure, const VibrationModes& modes,
                    const std::vector<InterfaceMap>& interfaces, const MakeIntegrator& make, double step_s,
                    int commands_per_step);

  [[nodiscard]] Eigen::Index interface_size() const noexcept { return interface_size_; }
  [[nodiscard]] int commands_per_step() const noexcept { return commands_per_step_; }
  [[nodiscard]] double step_s() const noexcept { return step_s_; }
  /// Coordinates beyond the modes, for those left out.
  [[nodiscard]] Eigen::Index residual_coordinates() const noexcept { return residual_coordinates_; }

  /// Over one step of the method.
  [[nodiscard]] std::vector<std::complex<double>> poles() const;
  /// Rows (command i, channel, interface), columns (command j, interface), as IntegratorResponse::at().
  [[nodiscard]] Eigen::MatrixXcd at(std::complex<double> z) const;

 private:
  struct Block {
    Eigen::MatrixXd shape;  // interface by coordinate
    IntegratorResponse response;
  };

  Eigen::Index interface_size_ = 0;
  int commands_per_step_;
  double step_s_;
  Eigen::Index residual_coordinates_ = 0;
  std::vector<Block> blocks_;
};

}  // namespace hybridtest
