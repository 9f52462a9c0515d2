#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "coordinator/preflight/coupled_loop.hpp"
#include "coordinator/preflight/step_stability.hpp"
#include "mechanics/structure/vibration_modes.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {

/// Stability of the coupled test at one site, linear, before the test. Delays are site time.
struct SiteStability {
  const SubstructureScenario* site = nullptr;
  Eigen::VectorXd stiffness_share;  // of the specimen in each mode, see stiffness_share_by_mode()
  /// Delay of the force at which the test turns unstable with a rig that is exact otherwise and without compensators,
  /// the other sites in time.
  CriticalDelay critical;
  ForceDelay delay;  // of the interface degree of freedom where the most remains
  /// With its compensators and transfer systems as they are, the other sites in time, a motion grows.
  bool grows = false;
  /// How much later the site may be, everything as it is: from there on a motion grows. 0 where one grows already.
  CriticalDelay further;
  /// With an estimated delay: as `grows`, the estimate at that bound. Empty without one.
  std::optional<bool> grows_at_smallest_estimate;
  std::optional<bool> grows_at_largest_estimate;
  /// Command of the site [m], standard deviation at the interface degree of freedom where it is largest, for a force
  /// noise of a standard deviation of 1 N.
  double command_noise_m_per_n = 0.0;
  /// Largest entry of `initial_stiffness_n_per_m` minus the stiffness of the simulated specimen, over the largest entry
  /// of the two; 0 where the specimen is not known. Above kStiffnessTolerance all figures use the specimen.
  double stiffness_error = 0.0;
  Eigen::MatrixXd specimen_stiffness_n_per_m;  // empty where it is not known

  /// Further delay until the test turns unstable. Negative: unstable. Infinite when it is stable with any delay.
  [[nodiscard]] double margin_s() const noexcept;
  /// A delay that is learnt during the test may be unstable at the start only, and does not count.
  [[nodiscard]] bool is_unstable() const noexcept { return grows && !delay.is_learnt; }
};

struct TestStability {
  StepStability step;  // of an integrator that needs the initial stiffness: no limit
  /// The step is longer than 2/omega of the highest mode, which such an integrator slows down.
  bool has_modes_beyond_step = false;
  /// With all sites as they are, those whose delay is learnt in time, a motion grows.
  bool grows = false;
  /// How much later all sites may be at once, as SiteStability::further.
  CriticalDelay further;
  Eigen::Index residual_coordinates = 0;  // see StructureResponse
  std::vector<SiteStability> sites;       // experimental ones, in the order of the scenario

  /// Of the step, of all sites together, or of a site.
  [[nodiscard]] bool is_unstable(double step_s) const noexcept;
  /// Of a site: damping and energy error of the test would be wrong.
  [[nodiscard]] bool has_wrong_stiffness() const noexcept;
};

/// A simulated specimen that differs by more from the stiffness that the scenario gives is worth a warning.
inline constexpr double kStiffnessTolerance = 0.1;
/// By more than a factor of two the number is plainly wrong.
inline constexpr double kStiffnessErrorMax = 0.5;

/// Before a test its verdict alone is needed, which takes a tenth of the time.
enum class StabilityFigures { verdict, all };

/// The test is taken as a discrete linear system (CoupledLoop): the integrator at its step, the control loop of each
/// site as it is (site_answer()), linear specimens. A simulated specimen has its secant stiffness from rest to a
/// thousandth of the displacement limit, so that a friction that slides before that does not count as a stiff spring.
/// One without force there (a gap) counts as not known and has `initial_stiffness_n_per_m`, as one elsewhere has.
/// @param modes   of the scenario's structure; those that are not there are left out of the figures.
[[nodiscard]] TestStability test_stability(const Scenario& scenario, const VibrationModes& modes,
                                           StabilityFigures figures = StabilityFigures::all);

}  // namespace hybridtest
