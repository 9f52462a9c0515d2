#pragma once

#include <Eigen/Core>
#include <vector>

#include "coordinator/preflight/critical_delay.hpp"
#include "coordinator/preflight/step_stability.hpp"
#include "mechanics/structure/vibration_modes.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {

/// Stability of the coupled test at one site, linear, before the test.
struct SiteStability {
  const SubstructureScenario* site = nullptr;
  Eigen::VectorXd stiffness_share;  // of the specimen in each mode, see stiffness_share_by_mode()
  CriticalDelay critical;           // its delay NaN where the structure is above kCriticalDelaySizeMax: not known
  ForceDelay delay;                 // of the interface degree of freedom where the most remains
  /// Largest entry of `initial_stiffness_n_per_m` minus the stiffness of the simulated specimen, over the largest entry
  /// of the two; 0 where the specimen is not known. Above kStiffnessTolerance all figures use the specimen.
  double stiffness_error = 0.0;
  Eigen::MatrixXd specimen_stiffness_n_per_m;  // empty where it is not known

  /// Negative: unstable. Infinite when the test is stable with any delay.
  [[nodiscard]] double margin_s() const noexcept;
  /// A delay that is learnt during the test may be unstable at the start only, and does not count.
  [[nodiscard]] bool is_unstable() const noexcept;
};

struct TestStability {
  StepStability step;  // of an integrator that needs the initial stiffness: no limit
  /// The step is longer than 2/omega of the highest mode, which such an integrator slows down: the critical delays are
  /// those of the structure, not of the test.
  bool has_modes_beyond_step = false;
  /// With such modes, or with specimens that differ from the initial stiffness that the integrator needs: stepped
  /// through a free vibration with the stiffness of the specimens and the delays that remain, the motion grows.
  bool grows = false;
  std::vector<SiteStability> sites;  // experimental ones, in the order of the scenario

  /// Of the step, of the vibration, or of a site.
  [[nodiscard]] bool is_unstable(double step_s) const noexcept;
  /// Of a site: damping and energy error of the test would be wrong.
  [[nodiscard]] bool has_wrong_stiffness() const noexcept;
};

/// A simulated specimen that differs by more from the stiffness that the scenario gives is worth a warning.
inline constexpr double kStiffnessTolerance = 0.1;
/// By more than a factor of two the number is plainly wrong.
inline constexpr double kStiffnessErrorMax = 0.5;

/// Where a specimen is simulated and differs from `initial_stiffness_n_per_m`, the figures are those of the specimen,
/// which is what the test meets: its secant stiffness from rest to a thousandth of the displacement limit, so that a
/// friction that slides before that does not count as a stiff spring. A specimen without force there (a gap) counts
/// as not known.
/// @param modes   of the scenario's structure, for the stiffness shares.
[[nodiscard]] TestStability test_stability(const Scenario& scenario, const VibrationModes& modes);

}  // namespace hybridtest
