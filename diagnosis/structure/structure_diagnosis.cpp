#include "diagnosis/structure/structure_diagnosis.hpp"

#include <fmt/format.h>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/assert.hpp"
#include "diagnosis/identification/coloured_noise.hpp"
#include "diagnosis/identification/search_table.hpp"
#include "diagnosis/tuning.hpp"
#include "diagnosis/verdict/causes.hpp"

namespace hybridtest {

Eigen::MatrixXd recomputed_displacement_m(const ComputedStructure& model, const StructureRecording& recording,
                                          const StructureErrors& errors) {
  HYBRIDTEST_ASSERT(recording.displacement_m.rows() == model.structure.size() &&
                    recording.restoring_force_n.cols() == recording.steps() &&
                    recording.ground_m_per_s2.cols() == recording.steps() &&
                    recording.ground_m_per_s2.rows() == model.influence.cols());
  LinearStructure structure = model.structure;
  structure.mass_kg *= 1.0 + errors.mass;
  structure.damping_n_s_per_m *= 1.0 + errors.damping;
  const auto integrator = model.make_integrator(structure, model.step_s * (1.0 + errors.step));
  const Eigen::MatrixXd load_kg = -(structure.mass_kg * model.influence);
  Eigen::MatrixXd displacement_m(recording.displacement_m.rows(), recording.steps());
  Eigen::VectorXd force_n;
  Eigen::VectorXd applied_n = Eigen::VectorXd::Zero(structure.size());
  for (Eigen::Index i = 0; i < recording.steps(); ++i) {
    force_n = recording.restoring_force_n.col(i);
    // If model and recording agree, this adds exactly zero.
    if (recording.has_numerical_forces()) {
      force_n +=
          (1.0 + errors.stiffness) * recording.modelled_numerical_force_n.col(i) - recording.numerical_force_n.col(i);
    }
    applied_n.setZero();
    // One after the other, as the coordinator adds them: the sum has the same bits.
    for (Eigen::Index k = 0; k < load_kg.cols(); ++k) applied_n += load_kg.col(k) * recording.ground_m_per_s2(k, i);
    if (recording.forces_n.cols() > 0) applied_n += recording.forces_n.col(i);
    integrator->advance(force_n, applied_n);
    displacement_m.col(i) = integrator->completed().displacement_m;
  }
  return displacement_m;
}

namespace {

const SearchRange& range_of(const FittedRatio& ratio) {
  const EffectType& type = ratio.effect->type();
  HYBRIDTEST_ASSERT(type.parameters.size() == 1);
  const SearchRange* const range = search_range(type, type.parameters.front());
  HYBRIDTEST_ASSERT(range != nullptr);
  return *range;
}

/// The recording, and the displacements recomputed with the ratios.
class RatioProblem {
 public:
  RatioProblem(const ComputedStructure& model, const StructureRecording& recording)
      : model_{model}, recording_{recording} {}

  [[nodiscard]] Eigen::VectorXd residual(const StructureFit& at) const {
    return (recomputed_displacement_m(model_, recording_, at.errors()) - recording_.displacement_m).reshaped();
  }
  [[nodiscard]] Eigen::MatrixXd slopes(const StructureFit& at, const Eigen::VectorXd& residual_m) const {
    Eigen::MatrixXd slopes(residual_m.size(), std::ssize(at.ratios));
    for (std::size_t i = 0; i < at.ratios.size(); ++i) {
      StructureFit beside = at;
      beside.ratios[i].value += tuning::kRatioDifference;
      slopes.col(static_cast<Eigen::Index>(i)) = (residual(beside) - residual_m) / tuning::kRatioDifference;
    }
    return slopes;
  }
  [[nodiscard]] double nrmse_of(const Eigen::VectorXd& residual_m) const {
    const double whole = recording_.displacement_m.norm();
    return whole > 0.0 ? residual_m.norm() / whole : 0.0;
  }

 private:
  const ComputedStructure& model_;
  const StructureRecording& recording_;
};

StructureFit moved(const StructureFit& from, const Eigen::VectorXd& change) {
  StructureFit fit = from;
  for (std::size_t i = 0; i < fit.ratios.size(); ++i) {
    const SearchRange& range = range_of(fit.ratios[i]);
    const double wanted = fit.ratios[i].value + change[static_cast<Eigen::Index>(i)];
    fit.ratios[i].value = std::clamp(wanted, range.low, range.high);
    fit.ratios[i].at_bound = fit.ratios[i].value != wanted;
  }
  return fit;
}

}  // namespace

StructureErrors StructureFit::errors() const {
  StructureErrors errors;
  for (const FittedRatio& ratio : ratios) errors.*(ratio.effect->ratio) = ratio.value;
  return errors;
}

StructureFit fit_structure(const ComputedStructure& model, const StructureRecording& recording,
                           std::vector<FittedRatio> start) {
  const RatioProblem problem{model, recording};
  StructureFit fit{std::move(start), 0.0};
  Eigen::VectorXd residual_m = problem.residual(fit);
  Eigen::MatrixXd slopes;
  for (int i = 0; i < tuning::kRatioIterations && !fit.ratios.empty(); ++i) {
    slopes = problem.slopes(fit, residual_m);
    Eigen::VectorXd change = -slopes.colPivHouseholderQr().solve(residual_m);
    bool descends = false;
    for (int halving = 0; halving < tuning::kRatioHalvings && !descends; ++halving, change *= 0.5) {
      const StructureFit next = moved(fit, change);
      const Eigen::VectorXd left_m = problem.residual(next);
      descends = left_m.squaredNorm() < residual_m.squaredNorm();
      if (!descends) continue;
      fit = next;
      residual_m = left_m;
    }
    if (!descends || change.cwiseAbs().maxCoeff() < tuning::kRatioSettled) break;
  }
  fit.nrmse = problem.nrmse_of(residual_m);
  if (fit.ratios.empty()) return fit;
  const Eigen::MatrixXd normal = slopes.transpose() * slopes;
  const double variance = residual_m.squaredNorm() / independent_samples(residual_m);
  const Eigen::MatrixXd covariance = variance * normal.completeOrthogonalDecomposition().pseudoInverse();
  for (std::size_t i = 0; i < fit.ratios.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    fit.ratios[i].standard_error = std::sqrt(std::max(0.0, covariance(at, at)));
  }
  return fit;
}

namespace {

using report::Verdict;

double rounding_floor(Eigen::Index steps) {
  return 0.5 * std::numeric_limits<double>::epsilon() * std::pow(static_cast<double>(steps), 1.5);
}

/// Those that change what is computed: a stiffness without recorded forces of the numerical substructures does
/// not, nor a damping where there is none.
std::vector<const StructureEffect*> effects_that_matter(const ComputedStructure& model,
                                                        const StructureRecording& recording) {
  std::vector<const StructureEffect*> effects;
  for (const StructureEffect& effect : kStructureEffects) {
    const bool is_stiffness = effect.ratio == &StructureErrors::stiffness;
    const bool is_damping = effect.ratio == &StructureErrors::damping;
    if (is_stiffness &&
        (!recording.has_numerical_forces() || recording.modelled_numerical_force_n.squaredNorm() == 0.0)) {
      continue;
    }
    if (is_damping && model.structure.damping_n_s_per_m.squaredNorm() == 0.0) continue;
    effects.push_back(&effect);
  }
  return effects;
}

/// The best fit with one more effect.
StructureFit with_another(const ComputedStructure& model, const StructureRecording& recording, const StructureFit& fit,
                          const std::vector<const StructureEffect*>& effects) {
  StructureFit best = fit;
  for (const StructureEffect* effect : effects) {
    if (std::ranges::find(fit.ratios, effect, &FittedRatio::effect) != fit.ratios.end()) continue;
    std::vector<FittedRatio> start = fit.ratios;
    start.push_back({.effect = effect});
    StructureFit longer = fit_structure(model, recording, std::move(start));
    if (longer.nrmse < best.nrmse) best = std::move(longer);
  }
  return best;
}

/// The gap added when each cause is removed alone.
std::vector<double> shares_of(const ComputedStructure& model, const StructureRecording& recording,
                              const StructureFit& fit) {
  std::vector<double> shares;
  double sum = 0.0;
  for (const FittedRatio& ratio : fit.ratios) {
    StructureErrors without = fit.errors();
    without.*(ratio.effect->ratio) = 0.0;
    const Eigen::MatrixXd left_m = recomputed_displacement_m(model, recording, without) - recording.displacement_m;
    shares.push_back(left_m.squaredNorm());
    sum += shares.back();
  }
  for (double& share : shares) share /= sum;
  return shares;
}

Verdict together(Verdict site, Verdict structure) {
  if (structure == Verdict::none) return site;
  if (site == Verdict::none || site == Verdict::not_excited) return structure;
  if (site == Verdict::unknown && structure == Verdict::unknown) return Verdict::unknown;
  if (site == Verdict::set && structure == Verdict::named) return Verdict::set;
  return site == Verdict::named && structure == Verdict::named ? Verdict::named : Verdict::partial;
}

double excess(double nrmse, double floor) { return std::max(0.0, nrmse * nrmse - floor * floor); }

/// Its share of the whole gap; the other shares are reduced accordingly.
double add_where(const StructureDiagnosis& structure, report::DiagnosisReport& report) {
  // Replaces the entry that says it is not judged.
  std::erase_if(report.where, [](const report::InterfaceGap& other) {
    return other.interface == name_of(EffectInterface::numerical_substructure);
  });
  double others = 0.0;
  for (const report::InterfaceGap& gap : report.where) others += excess(gap.nrmse, gap.floor_nrmse);
  report::InterfaceGap gap;
  gap.interface = name_of(EffectInterface::numerical_substructure);
  gap.is_judged = true;
  gap.nrmse = structure.nrmse;
  gap.floor_nrmse = structure.floor_nrmse;
  gap.is_at_fault = structure.verdict != Verdict::none;
  const double own = gap.is_at_fault ? excess(gap.nrmse, gap.floor_nrmse) : 0.0;
  gap.share = own > 0.0 ? own / (own + others) : 0.0;
  gap.share_ci95 = {gap.share, gap.share};
  scale_shares(report.where, 1.0 - gap.share);
  const double share = gap.share;
  report.where.push_back(std::move(gap));
  std::ranges::stable_sort(report.where, [](const report::InterfaceGap& a, const report::InterfaceGap& b) {
    return a.is_judged && (!b.is_judged || a.share > b.share);
  });
  return share;
}

EffectSetting setting_of(const FittedRatio& ratio) { return {&ratio.effect->type(), {ratio.value}}; }

void add_causes(const StructureDiagnosis& structure, double share_of_gap, std::vector<report::RankedCause>& ranking) {
  for (std::size_t i = 0; i < structure.fit.ratios.size(); ++i) {
    const FittedRatio& ratio = structure.fit.ratios[i];
    report::RankedCause cause = ranked(setting_of(ratio),
                                       {{.value = ratio.value,
                                         .standard_error = ratio.standard_error,
                                         .at_bound = ratio.at_bound,
                                         .beside_wrong_numbers = ratio.standard_error}},
                                       {});
    cause.probability = 1.0 - structure.gap_left;
    cause.share = share_of_gap * structure.shares[i];
    cause.is_cause = true;
    ranking.insert(ranking.begin() + static_cast<std::ptrdiff_t>(i), std::move(cause));
  }
  put_causes_first(ranking);
}

report::Shrink shrink_of(const StructureDiagnosis& structure) {
  const double before = structure.nrmse * structure.nrmse;
  const double after = structure.fit.nrmse * structure.fit.nrmse;
  report::Shrink shrink{.nrmse_before = structure.nrmse,
                        .nrmse_after = structure.fit.nrmse,
                        .floor_nrmse = structure.floor_nrmse,
                        .variance_removed = 1.0 - after / before};
  shrink.explainable_fraction = 1.0 - structure.gap_left;
  shrink.unknown_share = excess(structure.fit.nrmse, structure.floor_nrmse) / before;
  return shrink;
}

}  // namespace

StructureDiagnosis diagnose_structure(const ComputedStructure& model, const StructureRecording& recording) {
  StructureDiagnosis structure;
  const StructureFit as_given = fit_structure(model, recording, {});
  structure.nrmse = as_given.nrmse;
  structure.floor_nrmse = rounding_floor(recording.steps());
  if (structure.nrmse <= tuning::kFaultOverFloor * structure.floor_nrmse + tuning::kModelAllowance) return structure;

  const std::vector<const StructureEffect*> effects = effects_that_matter(model, recording);
  StructureFit fit = as_given;
  while (fit.ratios.size() < effects.size() && fit.nrmse > tuning::kFaultOverFloor * structure.floor_nrmse) {
    StructureFit longer = with_another(model, recording, fit, effects);
    const double left = longer.nrmse * longer.nrmse;
    if (left > tuning::kAnotherEffectLeaves * fit.nrmse * fit.nrmse) break;
    fit = std::move(longer);
  }
  structure.gap_left = excess(fit.nrmse, structure.floor_nrmse) / excess(structure.nrmse, structure.floor_nrmse);
  if (structure.gap_left > tuning::kComputedLeaves) {
    structure.verdict = Verdict::unknown;
    return structure;
  }
  structure.verdict = Verdict::named;
  structure.shares = shares_of(model, recording, fit);
  structure.fit = std::move(fit);
  return structure;
}

void add_structure(const StructureDiagnosis& structure, Diagnosis& diagnosis) {
  report::DiagnosisReport& report = diagnosis.report;
  const double share = add_where(structure, report);
  const bool agrees = structure.verdict == Verdict::none;
  report.notes.push_back(
      structure.nrmse == 0.0
          ? "The coordinator's displacements, recomputed with the scenario from the forces it received, agree bit for "
            "bit."
          : fmt::format("The coordinator's displacements, recomputed with the scenario from the forces it received, "
                        "agree to within {:.2g} of their root mean square{}.",
                        structure.nrmse,
                        agrees ? "" : "; because recorded forces drive the computation, an error grows with time"));
  if (agrees) return;
  const Verdict site = report.verdict;
  report.verdict = together(site, structure.verdict);
  if (site == Verdict::none || site == Verdict::not_excited) {
    report.next_experiment.clear();
    report.ranking.clear();  // the candidates of the site do not compete with these causes
  }
  if (structure.verdict == Verdict::unknown) {
    report.notes.emplace_back(
        "No single factor on mass, damping, numerical stiffness or step reproduces the recorded commands: compare the "
        "structure of the scenario with the tested one at each degree of freedom.");
    return;
  }
  if (report.verdict == Verdict::partial && site == Verdict::unknown) {
    report.notes.emplace_back("The causes are at the numerical substructure; the gap at the site remains unexplained.");
  }
  for (report::RankedCause& cause : report.ranking) cause.share *= 1.0 - share;
  add_causes(structure, share, report.ranking);
  if (!report.interface_shrink) report.interface_shrink = shrink_of(structure);
}

std::vector<EffectSetting> causes_of(const StructureDiagnosis& structure) {
  std::vector<EffectSetting> causes;
  for (const FittedRatio& ratio : structure.fit.ratios) causes.push_back(setting_of(ratio));
  return causes;
}

}  // namespace hybridtest
