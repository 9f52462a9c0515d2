#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/integrators/initial_ramp.hpp"
#include "core/config/section.hpp"
#include "core/messages.hpp"
#include "mechanics/structure/interface_map.hpp"
#include "mechanics/structure/linear_structure.hpp"
#include "scenario/catalogue/integrators.hpp"
#include "scenario/dof_table.hpp"

namespace hybridtest {

/// Of the test: its steps are 0 to last_step.
struct TestSteps {
  double step_s = 0.0;
  Step last_step = 0;
};

/// A free vibration from given displacements and velocities.
struct FreeVibration {
  InitialMotion initial;
  std::vector<Eigen::Index> given;  // degrees of freedom with a displacement in the scenario
  bool others_follow = false;       // at rest, with the initial stiffness; else they are at zero
  InitialRampSteps steps;           // before the release
};

/// Reads `excitation.free_vibration`, where displacements that are not given are still zero; reports what is wrong at
/// its key.
[[nodiscard]] FreeVibration read_free_vibration(config::Section section, const DofTable& dofs, const TestSteps& test);

/// The displacements that follow the given ones.
/// @throws ConfigError when the stiffness does not hold them.
void let_others_follow(FreeVibration& start, const Eigen::SparseMatrix<double>& initial_stiffness_n_per_m);

/// Reports initial displacements beyond what the site may command, and a ramp to them that is too fast for it.
/// @param limit_m, limit_m_per_s   of the site; @param time_scale   its time over model time.
void check_initial_ramp(config::Section excitation, const FreeVibration& start, const TestSteps& test,
                        const std::string& site, const InterfaceMap& interface, double limit_m, double limit_m_per_s,
                        double time_scale);

/// The integrator of the test: with a free vibration, it begins there.
[[nodiscard]] std::unique_ptr<Integrator> begun_integrator(const IntegratorReading& integrator,
                                                           const std::optional<FreeVibration>& start,
                                                           const LinearStructure& structure, double step_s);

}  // namespace hybridtest
