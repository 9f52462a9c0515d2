#include "scenario/test_stability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "coordinator/preflight/site_coupling.hpp"
#include "scenario/site_answer.hpp"

namespace hybridtest {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();
constexpr double kPushShare = 0.001;  // of the displacement limit

double push_m(const SubstructureScenario& substructure) {
  return kPushShare * substructure.site.loop.limits.displacement_m;
}

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
  const Eigen::MatrixXd found = substructure.site.specimen_stiffness_n_per_m(push_m(substructure));
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

/// As far as a delay is searched, in periods of the lowest mode: by then the force has turned round twice.
constexpr double kPeriodsSearched = 2.0;
/// And at least, in steps.
constexpr double kStepsSearched = 200.0;

double longest_delay_s(const VibrationModes& modes, double step_s) {
  for (Eigen::Index mode = 0; mode < modes.count(); ++mode) {
    if (modes.frequency_rad_per_s[mode] * step_s < 1e-6) continue;  // a motion without stiffness
    return std::max(kPeriodsSearched * modes.period_s(mode), kStepsSearched * step_s);
  }
  return kStepsSearched * step_s;
}

/// The loops of a test, one after the other with the same structure.
class StabilityAnalysis {
 public:
  StabilityAnalysis(const Scenario& scenario, const VibrationModes& modes, TestStability& test)
      : scenario_{scenario}, test_{test}, delay_s_max_{longest_delay_s(modes, scenario.time.step_s)} {
    std::vector<InterfaceMap> interfaces;
    for (const SiteStability& site : test.sites) {
      interfaces.push_back(site.site->interface);
      prompt_.push_back(prompt_answer(site.site->initial_stiffness_n_per_m));
      answers_.push_back(answer(site, LearntDelay::initial));
    }
    // The step of the integrator may be wrong on purpose; the steps of the test are not.
    const double step_ratio = scenario.integrator_step_s / scenario.time.step_s;
    const MakeIntegrator make = [&, step_ratio](const LinearStructure& structure, double step_s,
                                                const InitialMotion& initial) {
      return scenario.integrator.make(structure, step_ratio * step_s, initial);
    };
    StructureResponse structure{
        scenario.structure, modes, interfaces, make, scenario.time.step_s, scenario.integrator.needs.commands_per_step};
    test.residual_coordinates = structure.residual_coordinates();
    loop_.emplace(std::move(structure), answers_);
  }

  void run(StabilityFigures figures) {
    for (std::size_t i = 0; i < test_.sites.size(); ++i) test_.sites[i].grows = grows_with(i, answers_[i]);
    std::vector<SiteAnswer> together = answers_;
    for (std::size_t i = 0; i < together.size(); ++i) {
      if (test_.sites[i].delay.is_learnt && test_.sites[i].grows) together[i] = prompt_[i];
    }
    loop_->set_answers(together);
    test_.grows = grows();
    if (figures == StabilityFigures::verdict) return;
    const std::vector<bool> all(together.size(), true);
    test_.further = in_site_time(critical(all));
    for (std::size_t i = 0; i < together.size(); ++i) {
      SiteStability& site = test_.sites[i];
      std::vector<bool> late(together.size(), false);
      late[i] = true;
      site.further = in_site_time(critical(late));
      double could_s = std::numeric_limits<double>::infinity();
      for (const ForceDelay& delay : site.site->site.delays) could_s = std::min(could_s, delay.further_s);
      if (site.further.delay_s > 0.0) site.further.delay_s += could_s;
    }
    noise();
    for (std::size_t i = 0; i < test_.sites.size(); ++i) judge_alone(i);
  }

 private:
  [[nodiscard]] SiteAnswer answer(const SiteStability& site, LearntDelay learnt) const {
    return site_answer(scenario_, *site.site, learnt, push_m(*site.site));
  }
  [[nodiscard]] bool grows() { return loop_->growing_motions(std::vector<double>(prompt_.size(), 0.0)) > 0; }
  /// The other sites in time.
  void place_alone(std::size_t i, SiteAnswer answer) {
    std::vector<SiteAnswer> answers = prompt_;
    answers[i] = std::move(answer);
    loop_->set_answers(std::move(answers));
  }
  [[nodiscard]] bool grows_with(std::size_t i, SiteAnswer answer) {
    place_alone(i, std::move(answer));
    return grows();
  }
  [[nodiscard]] CriticalDelay critical(const std::vector<bool>& late) {
    return loop_->critical_delay(late, delay_s_max_);
  }
  [[nodiscard]] CriticalDelay in_site_time(CriticalDelay critical) const {
    critical.delay_s *= scenario_.time.time_scale;
    return critical;
  }

  void judge_alone(std::size_t i) {
    SiteStability& site = test_.sites[i];
    std::vector<bool> late(prompt_.size(), false);
    late[i] = true;
    place_alone(i, bare_answer(scenario_, *site.site, coupled_site(site).stiffness_n_per_m));
    site.critical = in_site_time(critical(late));
    if (!site.site->site.has_estimator) return;
    site.grows_at_smallest_estimate = grows_with(i, answer(site, LearntDelay::smallest));
    site.grows_at_largest_estimate = grows_with(i, answer(site, LearntDelay::largest));
  }

  void noise() {
    Eigen::Index row = 0;
    for (SiteStability& site : test_.sites) {
      const Eigen::Index size = site.site->interface.size();
      for (Eigen::Index k = 0; k < size && !test_.grows; ++k) {
        const double each = loop_->noise_m_per_n(row + k).segment(row, size).maxCoeff();
        site.command_noise_m_per_n = std::max(site.command_noise_m_per_n, each);
      }
      row += size;
    }
  }

  const Scenario& scenario_;
  TestStability& test_;
  double delay_s_max_;
  std::vector<SiteAnswer> prompt_;
  std::vector<SiteAnswer> answers_;
  std::optional<CoupledLoop> loop_;
};

}  // namespace

double SiteStability::margin_s() const noexcept {
  return grows ? std::min(critical.delay_s - std::abs(delay.remaining_s), 0.0) : further.delay_s;
}

bool TestStability::is_unstable(double step_s) const noexcept {
  return step_s > step.step_s_max || grows || std::ranges::any_of(sites, &SiteStability::is_unstable);
}

bool TestStability::has_wrong_stiffness() const noexcept {
  return std::ranges::any_of(sites,
                             [](const SiteStability& site) { return site.stiffness_error > kStiffnessErrorMax; });
}

TestStability test_stability(const Scenario& scenario, const VibrationModes& modes, StabilityFigures figures) {
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
  }
  for (std::size_t i = 0; i < test.sites.size(); ++i) {
    test.sites[i].stiffness_share = stiffness_share_by_mode(structure, modes_met, coupled[i]);
  }
  if (!test.sites.empty()) StabilityAnalysis{scenario, modes, test}.run(figures);
  return test;
}

}  // namespace hybridtest
