#include "scenario/test_stability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "coordinator/preflight/free_vibration.hpp"
#include "coordinator/preflight/site_coupling.hpp"

namespace hybridtest {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();
constexpr double kPushShare = 0.001;  // of the displacement limit

/// With the stiffness that its specimen turns out to have.
CoupledSite coupled_site(const SiteStability& stability) {
  CoupledSite site;
  site.id = stability.site->id;
  site.interface = stability.site->interface;
  site.stiffness_n_per_m = stability.stiffness_error > kStiffnessTolerance ? stability.specimen_stiffness_n_per_m
                                                                           : stability.site->initial_stiffness_n_per_m;
  return site;
}

ForceDelay largest_remaining(const std::vector<ForceDelay>& delays) {
  return std::ranges::max(delays, {}, [](const ForceDelay& delay) { return std::abs(delay.remaining_s); });
}

SiteStability site_stability(const SubstructureScenario& substructure) {
  SiteStability stability;
  stability.site = &substructure;
  stability.delay = largest_remaining(substructure.site.delays);
  if (!substructure.site.specimen_stiffness_n_per_m) return stability;
  const Eigen::MatrixXd found =
      substructure.site.specimen_stiffness_n_per_m(kPushShare * substructure.site.loop.limits.displacement_m);
  const double largest = found.cwiseAbs().maxCoeff();
  if (!(largest > 0.0 && std::isfinite(largest))) return stability;
  const Eigen::MatrixXd& given = substructure.initial_stiffness_n_per_m;
  stability.specimen_stiffness_n_per_m = found;
  stability.stiffness_error = (given - found).cwiseAbs().maxCoeff() / std::max(largest, given.cwiseAbs().maxCoeff());
  return stability;
}

/// K + sum over the sites of B^T (K_coupled - K_given) B.
LinearStructure with_specimens(const LinearStructure& given, const std::vector<SiteStability>& sites,
                               const std::vector<CoupledSite>& coupled) {
  LinearStructure structure = given;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    structure.initial_stiffness_n_per_m +=
        coupled[i].interface.on_structure(coupled[i].stiffness_n_per_m - sites[i].site->initial_stiffness_n_per_m);
  }
  return structure;
}

/// With the stiffness of the specimens and the delays that remain and are not learnt.
bool vibration_grows(const Scenario& scenario, const LinearStructure& structure,
                     const std::vector<SiteStability>& sites, const std::vector<CoupledSite>& coupled) {
  Eigen::SparseMatrix<double> prompt = structure.initial_stiffness_n_per_m;
  std::vector<DelayedForce> delayed;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const double delay_s = sites[i].delay.is_learnt ? 0.0 : sites[i].delay.remaining_s;
    if (delay_s == 0.0) continue;
    delayed.push_back(
        {coupled[i].interface.on_structure(coupled[i].stiffness_n_per_m), delay_s / scenario.time.step_s});
    prompt -= delayed.back().stiffness_n_per_m;
  }
  return free_vibration_grows(*scenario.integrator.make(scenario.structure, scenario.integrator_step_s, {}), prompt,
                              delayed);
}

}  // namespace

double SiteStability::margin_s() const noexcept { return critical.delay_s - std::abs(delay.remaining_s); }

bool SiteStability::is_unstable() const noexcept {
  // Undamped and without any delay, the motion neither grows nor fades.
  return !delay.is_learnt && delay.remaining_s != 0.0 && margin_s() <= 0.0;
}

bool TestStability::is_unstable(double step_s) const noexcept {
  if (step_s > step.step_s_max || grows) return true;
  return !has_modes_beyond_step && std::ranges::any_of(sites, &SiteStability::is_unstable);
}

bool TestStability::has_wrong_stiffness() const noexcept {
  return std::ranges::any_of(sites,
                             [](const SiteStability& site) { return site.stiffness_error > kStiffnessErrorMax; });
}

TestStability test_stability(const Scenario& scenario, const VibrationModes& modes) {
  TestStability test;
  std::vector<CoupledSite> coupled;
  for (const SubstructureScenario& substructure : scenario.substructures) {
    if (substructure.role != Role::experimental_site) continue;
    test.sites.push_back(site_stability(substructure));
    coupled.push_back(coupled_site(test.sites.back()));
  }
  const bool is_as_given = std::ranges::none_of(
      test.sites, [](const SiteStability& site) { return site.stiffness_error > kStiffnessTolerance; });
  const LinearStructure structure =
      is_as_given ? scenario.structure : with_specimens(scenario.structure, test.sites, coupled);
  const VibrationModes modes_met = is_as_given ? modes : vibration_modes(structure);
  test.step = step_stability(modes_met);
  if (scenario.integrator.needs.initial_stiffness) {
    test.has_modes_beyond_step = scenario.integrator_step_s > std::exchange(test.step.step_s_max, kNoLimit);
    test.grows =
        (test.has_modes_beyond_step || !is_as_given) && vibration_grows(scenario, structure, test.sites, coupled);
  }
  for (std::size_t i = 0; i < test.sites.size(); ++i) {
    test.sites[i].stiffness_share = stiffness_share_by_mode(structure, modes_met, coupled[i]);
    test.sites[i].critical = structure.size() <= kCriticalDelaySizeMax
                                 ? critical_delay(structure, coupled, i)
                                 : CriticalDelay{.delay_s = std::numeric_limits<double>::quiet_NaN()};
  }
  return test;
}

}  // namespace hybridtest
